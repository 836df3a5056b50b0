// A clamped circular membrane blown up by a pressure that stays normal to it.
//
// Target: data/reference/pressurised_circular_membrane.csv, a shooting solution of the axisymmetric
// equations for this very material (St. Venant-Kirchhoff, plane stress, reference thickness) and a
// follower pressure, exact to its digits. Hencky's classical numbers are for a dead load.
#include <gtest/gtest.h>

#include <cmath>

#include "fullsim/forces/membrane.hpp"
#include "tests/support/reference_rows.hpp"
#include "tests/support/structure.hpp"

namespace twinchute {
namespace {

using fullsim::Mesh;
using fullsim::NodeIndex;
using test::Structure;

constexpr double tension_modulus = 1000.0;  // E t [N/m]; the problem has no scale but pa/Et

/// Half of the unit disc in the plane z = 0, y >= 0: three sectors of 60 degrees, ring k with k segments
/// in each, so that no triangle is far from equilateral.
Mesh half_disc(int rings) {
    constexpr int sectors = 3;
    Mesh mesh;
    mesh.fabric = {"membrane", 1000.0, tension_modulus / 1e-3, 0.3, 1e-3};
    const auto first = [](int ring) { return ring + sectors * ring * (ring - 1) / 2; };
    const auto node = [&](int ring, int k) { return static_cast<NodeIndex>(first(ring) + k); };
    for (int ring = 0; ring <= rings; ++ring)
        for (int k = 0; k <= sectors * ring; ++k) {
            const double angle = ring == 0 ? 0.0 : pi * k / (sectors * ring);
            mesh.position.push_back(static_cast<double>(ring) / rings *
                                    Vec3(std::cos(angle), std::sin(angle), 0.0));
        }
    for (int ring = 1; ring <= rings; ++ring)
        for (int sector = 0; sector < sectors; ++sector)
            for (int k = sector * ring; k < (sector + 1) * ring; ++k) {
                const int in = k - sector;  // the ring inside has one segment less in every sector
                test::add_triangle(mesh, {node(ring - 1, in), node(ring, k), node(ring, k + 1)});
                if (k + 1 < (sector + 1) * ring)
                    test::add_triangle(mesh, {node(ring - 1, in), node(ring, k + 1), node(ring - 1, in + 1)});
            }
    mesh.canopy_nodes = mesh.node_count();
    return mesh;
}

struct Blown {
    double height;  // of the middle over the radius
    double stress;  // second Piola-Kirchhoff in the middle over E, mean of both directions
};

/// The disc under pa/Et = load.
Blown blow_up(int rings, double load) {
    Structure disc(half_disc(rings));
    const double pressure = load * tension_modulus, least = pressure / (rings * rings);
    disc.add_pressure(pressure);
    for (NodeIndex i = 0; i < disc.mesh().node_count(); ++i) {
        const Vec3& x = disc.mesh().position[i];
        disc.hold(i, i == 0, x.y() < 1e-9, false);
        if (x.norm() > 1.0 - 1e-9) disc.hold(i);
        // A first guess: the parabola of small deflections.
        disc.state.node[i].x[2] = 0.65 * std::cbrt(load) * (1.0 - x.squaredNorm());
    }
    // A millionth of what the pressure puts on a node: four digits more than are compared.
    EXPECT_LT(disc.relax(1e-6 * least, 400000).residual, 1e-6 * least) << "not relaxed";
    const auto& t = disc.mesh().triangles.front();
    const auto strain =
        green_strain(t, {disc.position(t.node[0]), disc.position(t.node[1]), disc.position(t.node[2])});
    const auto stress = membrane_stress(fullsim::membrane_law(disc.mesh().fabric, 0.0), strain);
    return {disc.position(0).z(), 0.5 * (stress.xx + stress.yy) / tension_modulus};
}

TEST(StructuralDisc, HeightAndStressUnderFollowerPressure) {
    // 0.5 % of the height is what is asked for; 12 rings miss by 0.12 %, 24 by 0.03 %. The stress is that of
    // a triangle beside the middle, one third of a ring away from it: 1 %.
    for (const auto& row : test::reference_rows("pressurised_circular_membrane.csv")) {
        const double load = row[0];
        if (load < 1e-4) continue;  // the same scaled height, for ever slower relaxation
        const Blown found = blow_up(12, load);
        EXPECT_NEAR(found.height / row[2], 1.0, 0.005) << "pa/Et = " << load;
        EXPECT_NEAR(found.stress / row[4], 1.0, 0.01) << "pa/Et = " << load;
        test::report("disc pa/Et", load, found.height / row[2] - 1.0, found.stress / row[4] - 1.0);
    }
}

TEST(StructuralDisc, ConvergesAtSecondOrderInElementSize) {
    // The error at a point of linear elements goes as h^2 log(1/h): the order is seen to come from
    // below, 1.85 and 1.88 here.
    const double expected = 0.141385, load = 1e-2;
    double error[3];
    for (int level = 0; level < 3; ++level)
        error[level] = std::abs(blow_up(6 << level, load).height - expected) / expected;
    test::report("disc orders", std::log2(error[0] / error[1]), std::log2(error[1] / error[2]));
    EXPECT_NEAR(std::log2(error[0] / error[1]), 2.0, 0.2);
    EXPECT_NEAR(std::log2(error[1] / error[2]), 2.0, 0.2);
}

}  // namespace
}  // namespace twinchute
