// Waves in cables, and the order of the time integrator on a taut membrane.
#include <gtest/gtest.h>

#include <cmath>

#include "fullsim/forces/membrane.hpp"
#include "tests/support/structure.hpp"

namespace twinchute {
namespace {

using fullsim::CableKind;
using fullsim::Mesh;
using fullsim::NodeIndex;
using test::Structure;

constexpr double stiffness = 1e4, density = 0.01;  // EA [N], mu [kg/m]: c = sqrt(EA/mu) = 1000 m/s

/// A straight chain along x, unstretched length 1 m, stretched by `strain`.
Mesh straight_chain(int elements, double strain) {
    Mesh mesh;
    mesh.cords.fill(test::cord_of(stiffness, density));
    for (int i = 0; i <= elements; ++i)
        mesh.position.emplace_back((1.0 + strain) * i / elements, 0.0, 0.0);
    for (int i = 0; i < elements; ++i)
        mesh.cables.push_back({{i, i + 1}, 1.0 / elements, 1.0, CableKind::line});
    return mesh;
}

TEST(StructuralWaves, VelocityStepRunsThroughABar) {
    // An end pulled with v meets rho A c v = v sqrt(EA mu), until the wave is back; it reaches the other,
    // held end after l0/c (unstretched length: the material is linear in it) and doubles there. The
    // pre-tension is twice the step, so that nothing goes slack. Steps of half the stable one and the
    // default bulk viscosity leave a front of a few elements and ripples behind it: the force is
    // compared in the mean over the middle of the transit, the arrival where half the step is reached.
    const int elements = 200;
    const double v = 1.0, c = std::sqrt(stiffness / density), step = v * std::sqrt(stiffness * density);
    const double tension = 2.0 * step;
    Structure bar(straight_chain(elements, tension / stiffness), 0.06);
    bar.hold(0);
    bar.hold(elements);
    bar.set_velocity(elements, Vec3(v, 0.0, 0.0));
    const double dt = 0.5 / (elements * c);
    double force = 0.0, doubled = 0.0, arrival = 0.0;
    int count = 0, late = 0;
    for (int n = 0; n < 4 * elements; ++n) {
        bar.step(dt);
        const double t = bar.state.time - dt;  // of the forces
        const double pulled = bar.reaction(elements).x() - tension, held = -bar.reaction(0).x() - tension;
        if (t * c > 0.2 && t * c < 1.8) force += pulled, ++count;
        if (t * c > 1.2 && t * c < 1.9) doubled += held, ++late;
        // The force at a held end doubles on arrival: half of that is the step itself.
        if (arrival == 0.0 && held >= step) arrival = t;
    }
    test::report("bar: force/expected, doubled/expected, arrival c/l0", force / count / step,
                 doubled / late / (2.0 * step), arrival * c);
    EXPECT_NEAR(force / count, step, 0.002 * step);
    EXPECT_NEAR(doubled / late, 2.0 * step, 0.004 * step);
    EXPECT_NEAR(arrival * c, 1.0, 0.01);  // two elements
}

TEST(StructuralWaves, StringFrequencies) {
    // f_n = n/(2L) sqrt(T/mu), L and mu as stretched. A chain of N elements has sin(x)/x of that, x = n
    // pi/2N: 1.5e-4 too low for n = 3 and N = 160, more than steps and interpolation add.
    const int elements = 160;
    const double strain = 0.01, tension = strain * stiffness, L = 1.0 + strain;
    for (const int n : {1, 2, 3}) {
        Structure string(straight_chain(elements, strain));
        string.hold(0);
        string.hold(elements);
        // So small that the stretch of the swing, (n pi a/2L)^2, does not count against 1 %.
        for (NodeIndex i = 0; i <= elements; ++i)
            string.state.node[i].x[2] = 1e-5 * std::sin(n * pi * i / elements);
        const double expected = n / (2.0 * L) * std::sqrt(tension * L / density);
        const double dt = 0.5 / (elements * std::sqrt(stiffness / density));
        const auto swing = [&] {
            double sum = 0.0;
            for (NodeIndex i = 0; i <= elements; ++i)
                sum += string.state.node[i].x[2] * std::sin(n * pi * i / elements);
            return sum;
        };
        double before = swing(), first = 0.0, last = 0.0;
        int passes = 0;
        while (passes < 7) {
            string.step(dt);
            const double now = swing();
            if (before * now < 0.0) {
                last = string.state.time - dt * now / (now - before);
                if (passes++ == 0) first = last;
            }
            before = now;
        }
        const double found = 3.0 / (last - first);
        EXPECT_NEAR(found / expected, 1.0, 5e-4) << n;
        test::report("string n, f, error", n, found, found / expected - 1.0);
    }
}

/// A square of taut fabric, 4 x 4 panels, held at its border, under follower pressure and with bulk
/// viscosity, thrown into a smooth swing that keeps every triangle taut.
struct TautSheet {
    Structure structure;
    TautSheet() : structure(mesh(), 0.06) {
        structure.add_pressure(50.0);
        for (NodeIndex i = 0; i < structure.mesh().node_count(); ++i) {
            const Vec3 x = structure.position(i);
            structure.state.node[i].x *= splat(1.05);
            if (std::max(std::abs(x.x()), std::abs(x.y())) > 0.5 - 1e-9) structure.hold(i);
            structure.set_velocity(i,
                                   3.0 * std::cos(pi * x.x()) * std::cos(pi * x.y()) * Vec3(0.3, 0.2, 1.0));
        }
    }
    static Mesh mesh() {
        constexpr int n = 4;
        Mesh mesh;
        mesh.fabric = {"fabric", 533.0, 4.3e8, 0.3, 1e-4};
        for (int j = 0; j <= n; ++j)
            for (int i = 0; i <= n; ++i)
                mesh.position.emplace_back(static_cast<double>(i) / n - 0.5, static_cast<double>(j) / n - 0.5,
                                           0.0);
        const auto node = [](int i, int j) { return static_cast<NodeIndex>(j * (n + 1) + i); };
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) {
                test::add_triangle(mesh, {node(i, j), node(i + 1, j), node(i + 1, j + 1)});
                test::add_triangle(mesh, {node(i, j), node(i + 1, j + 1), node(i, j + 1)});
            }
        mesh.canopy_nodes = mesh.node_count();
        return mesh;
    }
    void run(int steps, double end) {
        for (int i = 0; i < steps; ++i)
            structure.step(end / steps);
    }
};

TEST(StructuralWaves, ExplicitMidpointIsOfSecondOrderOnATautSheet) {
    // Positions and velocities of all nodes, each in its own norm, against a run of 16 times as many steps
    // as the finest: its own error is a 256th. The coarsest step is 0.3
    // of the stable one; near that one the fastest modes are not resolved, and the places show 1.7. Viscous
    // forces see a velocity extrapolated over half a step; that is of second order too.
    const double end = 0.02;  // half a swing
    TautSheet fine;
    fine.run(4 * 600 * 16, end);
    double place[3], speed[3];
    for (int level = 0; level < 3; ++level) {
        TautSheet sheet;
        sheet.run(600 << level, end);
        place[level] = speed[level] = 0.0;
        for (std::size_t i = 0; i < sheet.structure.mesh().mass.size(); ++i) {
            const Lanes dx = sheet.structure.state.node[i].x - fine.structure.state.node[i].x;
            const Lanes dv = sheet.structure.state.node[i].v - fine.structure.state.node[i].v;
            place[level] += sum3(dx * dx);
            speed[level] += sum3(dv * dv);
        }
        for (const auto& t : sheet.structure.mesh().triangles) {
            const auto e =
                green_strain(t, {sheet.structure.position(t.node[0]), sheet.structure.position(t.node[1]),
                                 sheet.structure.position(t.node[2])});
            fullsim::FabricState kind;
            membrane_stress(fullsim::membrane_law(sheet.structure.mesh().fabric, 0.0), e, &kind);
            EXPECT_EQ(kind, fullsim::FabricState::taut);
        }
    }
    for (int level = 0; level < 2; ++level) {
        const double order_x = 0.5 * std::log2(place[level] / place[level + 1]);
        const double order_v = 0.5 * std::log2(speed[level] / speed[level + 1]);
        EXPECT_NEAR(order_x, 2.0, 0.1);
        EXPECT_NEAR(order_v, 2.0, 0.1);
        test::report("midpoint on a taut sheet: orders of x and v, error", order_x, order_v,
                     std::sqrt(place[level]));
    }
}

}  // namespace
}  // namespace twinchute
