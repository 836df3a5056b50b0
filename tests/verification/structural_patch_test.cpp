// The membrane patch test: an irregular mesh whose border is moved affinely has the same strain everywhere.
//
// Strains that a linear triangle must represent exactly; targets are the membrane's own law at the affine
// strain (tests/unit/force_blocks_test.cpp checks that law), to the round-off of the node positions.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "fullsim/forces/membrane.hpp"
#include "tests/support/structure.hpp"

namespace twinchute {
namespace {

using fullsim::Mesh;
using fullsim::NodeIndex;
using fullsim::PlaneTensor;

constexpr int count = 6;
constexpr double patch_side = 2.0;  // [m]

/// A square of count x count panels in the plane z = 0, its inner nodes moved by up to a third of a panel.
Mesh irregular_square() {
    Mesh mesh;
    mesh.fabric = {"fabric", 533.0, 4.3e8, 0.3, 1e-4};
    std::mt19937 generator(5);
    std::uniform_real_distribution<double> shift(-0.33 * patch_side / count, 0.33 * patch_side / count);
    const auto node = [](int i, int j) { return static_cast<NodeIndex>(j * (count + 1) + i); };
    for (int j = 0; j <= count; ++j)
        for (int i = 0; i <= count; ++i) {
            mesh.position.emplace_back(patch_side * i / count, patch_side * j / count, 0.0);
            if (i > 0 && i < count && j > 0 && j < count)
                mesh.position.back() += Vec3(shift(generator), shift(generator), 0.0);
        }
    for (int j = 0; j < count; ++j)
        for (int i = 0; i < count; ++i) {
            test::add_triangle(mesh, {node(i, j), node(i + 1, j), node(i + (i + j) % 2, j + 1)});
            if ((i + j) % 2)
                test::add_triangle(mesh, {node(i, j), node(i + 1, j + 1), node(i, j + 1)});
            else
                test::add_triangle(mesh, {node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)});
        }
    mesh.canopy_nodes = mesh.node_count();
    return mesh;
}

bool on_border(const Vec3& x) {
    return std::min(x.x(), x.y()) < 1e-9 || std::max(x.x(), x.y()) > patch_side - 1e-9;
}

/// The affine motion of a test: stretch in the plane, then a turn and a shift in space.
struct Motion {
    Eigen::Matrix3d stretch, turn;
    Vec3 operator()(const Vec3& x) const { return turn * (stretch * x) + Vec3(3.0, -2.0, 5.0); }
    PlaneTensor strain() const {
        const Eigen::Matrix3d E = 0.5 * (stretch.transpose() * stretch - Eigen::Matrix3d::Identity());
        return {E(0, 0), E(1, 1), E(0, 1)};
    }
};

Motion motion(double xx, double yy, double xy) {
    Motion m;
    m.stretch << 1.0 + xx, xy, 0.0, 0.0, 1.0 + yy, 0.0, 0.0, 0.0, 1.0;
    m.turn = Eigen::AngleAxisd(0.9, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    return m;
}

/// [N] that the border of a sheet under the uniform stress resultant `n` pulls with at x = side.
Vec3 pull_on_right_side(const Motion& m, const PlaneTensor& n) {
    return m.turn * (m.stretch * Vec3(n.xx, n.xy, 0.0)) * patch_side;
}

/// [N] that the held nodes at x = side feel.
Vec3 reaction_on_right_side(const test::Structure& sheet) {
    Vec3 sum = Vec3::Zero();
    for (NodeIndex i = 0; i < sheet.mesh().node_count(); ++i)
        if (sheet.mesh().position[i].x() > patch_side - 1e-9) sum += sheet.reaction(i);
    return sum;
}

TEST(StructuralPatch, AffineBorderGivesUniformStressWhenTaut) {
    test::Structure sheet(irregular_square());
    const Motion m = motion(0.02, 0.03, 0.01);
    std::mt19937 generator(9);
    std::uniform_real_distribution<double> shift(-0.01, 0.01);
    for (NodeIndex i = 0; i < sheet.mesh().node_count(); ++i) {
        const Vec3& x = sheet.mesh().position[i];
        // The inner nodes start in disorder, out of the plane too: they have to find their places.
        const Vec3 disorder(shift(generator), shift(generator), shift(generator));
        sheet.state.node[i].x = fullsim::to_lanes(m(x) + (on_border(x) ? Vec3(0, 0, 0) : disorder));
        if (on_border(x)) sheet.hold(i);
    }
    const auto law = fullsim::membrane_law(sheet.mesh().fabric, 0.0);
    const PlaneTensor stress = membrane_stress(law, m.strain());
    // Forces of the size of stress times panel, 300 N; their round-off comes with strains of
    // eps * 7 m (position)/0.3 m (panel): 1e-14, times E t * panel: 1e-10 N.
    const auto relaxed = sheet.relax(1e-9, 20000);
    EXPECT_LT(relaxed.residual, 1e-9);
    double worst_place = 0.0, worst_stress = 0.0;
    for (NodeIndex i = 0; i < sheet.mesh().node_count(); ++i)
        worst_place = std::max(worst_place, (sheet.position(i) - m(sheet.mesh().position[i])).norm());
    for (const auto& t : sheet.mesh().triangles) {
        // The strain in the triangle's own axes has the invariants of the affine one.
        const PlaneTensor e = green_strain(
            t, {sheet.position(t.node[0]), sheet.position(t.node[1]), sheet.position(t.node[2])});
        const PlaneTensor n = membrane_stress(law, e);
        worst_stress =
            std::max({worst_stress, std::abs(n.xx + n.yy - stress.xx - stress.yy),
                      std::abs(n.xx * n.yy - n.xy * n.xy - (stress.xx * stress.yy - stress.xy * stress.xy)) /
                          stress.xx});
    }
    test::report("patch taut: steps, place [m], stress [N/m] of", relaxed.steps, worst_place, worst_stress,
                 stress.xx);
    EXPECT_LT(worst_place, 1e-12);
    EXPECT_LT(worst_stress, 1e-8);
}

TEST(StructuralPatch, WrinklesUniformlyInUniaxialTension) {
    // The sides x = 0 and x = side are held apart, the others free: shortened across by more than Poisson's
    // ratio asks for, the sheet wrinkles. The tension field is uniaxial, so the affine places are in
    // equilibrium however much it is shortened, and it pulls with E t times the strain along it.
    const auto law = fullsim::membrane_law(irregular_square().fabric, 0.0);
    for (const double contraction : {-0.05, -0.2}) {
        test::Structure sheet(irregular_square());
        const Motion m = motion(0.02, contraction, 0.0);
        fullsim::FabricState kind;
        const PlaneTensor stress = membrane_stress(law, m.strain(), &kind);
        ASSERT_EQ(kind, fullsim::FabricState::wrinkled);
        // Uniaxial: E t times the Green strain along, nothing across.
        const double along = 0.5 * (1.02 * 1.02 - 1.0) * 43000.0;
        EXPECT_NEAR(stress.xx, along, 1e-9);
        EXPECT_NEAR(stress.yy, 0.0, 1e-9);
        for (NodeIndex i = 0; i < sheet.mesh().node_count(); ++i) {
            sheet.state.node[i].x = fullsim::to_lanes(m(sheet.mesh().position[i]));
            if (sheet.mesh().position[i].x() < 1e-9 || sheet.mesh().position[i].x() > patch_side - 1e-9)
                sheet.hold(i);
        }
        const auto relaxed = sheet.relax(1e-9, 1);
        EXPECT_LT(relaxed.residual, 1e-9) << contraction;
        const Vec3 pull = reaction_on_right_side(sheet), expected = pull_on_right_side(m, stress);
        EXPECT_LT((pull - expected).norm(), 1e-9 * expected.norm());
        test::report("patch wrinkled: residual [N], pull, expected", relaxed.residual, pull.norm(),
                     expected.norm());
    }
}

}  // namespace
}  // namespace twinchute
