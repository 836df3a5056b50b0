// Cables against closed forms: hanging chains, and a pendulum of large amplitude.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/structure.hpp"

namespace twinchute {
namespace {

using fullsim::CableKind;
using fullsim::Mesh;
using fullsim::NodeIndex;
using test::Structure;

struct Hanging {
    double horizontal, largest, sag;  // [N], [N], [m]
};

/// A chain of `length` and `weight` between two points of equal height.
Hanging hang(double span, double length, double weight, double axial_stiffness, int elements) {
    Mesh mesh;
    mesh.cords.fill(test::cord_of(axial_stiffness, weight / standard_gravity / length));
    // Starts as the parabola of that sag.
    const double sag = std::sqrt(0.375 * span * (length - span));
    for (int i = 0; i <= elements; ++i) {
        const double s = 2.0 * i / elements - 1.0;
        mesh.position.emplace_back(0.5 * span * s, 0.0, -sag * (1.0 - s * s));
    }
    for (int i = 0; i < elements; ++i)
        mesh.cables.push_back({{i, i + 1}, length / elements, 1.0, CableKind::line});
    Structure chain(mesh, 0.0, standard_gravity);
    chain.hold(0);
    chain.hold(elements);
    EXPECT_LT(chain.relax(1e-6 * weight / elements, 200000).residual, 1e-6 * weight / elements);
    // The reaction carries the support's own half element, as the tension at the support does.
    const Vec3 reaction = chain.reaction(elements);
    double lowest = 0.0;
    for (int i = 0; i <= elements; ++i)
        lowest = std::max(lowest, -chain.position(i).z());
    return {reaction.x(), reaction.norm(), lowest};
}

TEST(StructuralCables, ElasticCatenary) {
    // Irvine's closed form: span 10 m, unstretched 10.5 m, 100 N. With nodes of lumped weight the error goes
    // with the elements' number squared; 40 are below the 0.1 % that is asked for.
    struct Row {
        double stiffness, horizontal, largest, sag;
    };
    for (const Row& row :
         {Row{1e3, 55.05476625, 74.37087660, 2.159441587}, Row{1e4, 80.11613041, 94.43830977, 1.516953833},
          Row{1e5, 86.69177725, 100.07729135, 1.406791480}}) {
        const Hanging found = hang(10.0, 10.5, 100.0, row.stiffness, 40);
        EXPECT_NEAR(found.horizontal / row.horizontal, 1.0, 0.001);
        EXPECT_NEAR(found.largest / row.largest, 1.0, 0.001);
        EXPECT_NEAR(found.sag / row.sag, 1.0, 0.001);
        test::report("catenary EA, errors of H, T, sag", row.stiffness,
                     found.horizontal / row.horizontal - 1.0, found.largest / row.largest - 1.0,
                     found.sag / row.sag - 1.0);
    }
}

TEST(StructuralCables, InextensibleCatenary) {
    // y = a cosh(x/a) with 2 a sinh(span/2a) = length; H = w a. A chain of EA = 1e4 weights is stretched by
    // 1e-4, which a tight one of length 1.05 feels as 1e-3 of its horizontal force: 0.3 % for all.
    struct Row {
        double length, horizontal, sag, largest;  // [m], per weight of a metre
    };
    for (const Row& row :
         {Row{105, 91.96396300, 13.93042066, 105.89438366}, Row{110, 65.49639476, 20.03007907, 85.52647384},
          Row{150, 30.82364697, 50.26332616, 81.08697314},
          Row{200, 22.96402151, 79.63883559, 102.60285709}}) {
        const Hanging found = hang(100.0, row.length, row.length, 1e4 * row.length, 60);
        EXPECT_NEAR(found.horizontal / row.horizontal, 1.0, 0.003) << row.length;
        EXPECT_NEAR(found.largest / row.largest, 1.0, 0.003) << row.length;
        EXPECT_NEAR(found.sag / row.sag, 1.0, 0.003) << row.length;
        test::report("inextensible catenary S, errors of H, T, sag", row.length,
                     found.horizontal / row.horizontal - 1.0, found.largest / row.largest - 1.0,
                     found.sag / row.sag - 1.0);
    }
}

/// A mass on a cord of 1 m, let go at `degrees` from the vertical; the cord stretches by 1e-5.
struct Pendulum {
    static constexpr double slack = 1e-6;  // [m]
    Structure structure;
    explicit Pendulum(double degrees) : structure(mesh(degrees * pi / 180.0), 0.0, standard_gravity) {
        structure.hold(0);
    }
    static Mesh mesh(double angle) {
        Mesh mesh;
        mesh.cords.fill(test::cord_of(1e5 * standard_gravity, 1e-9));
        // As long as it hangs under its tension at the start, so that it does not bounce.
        // Above the horizontal there is no tension, and a little slack keeps it so.
        const double length = angle > 0.5 * pi ? 1.0 - slack : 1.0 + 1e-5 * std::cos(angle);
        mesh.position = {Vec3::Zero(), length * Vec3(std::sin(angle), 0.0, -std::cos(angle))};
        mesh.cables = {{{0, 1}, 1.0, 1.0, CableKind::line}};
        mesh.mass = {1.0, 1.0};
        return mesh;
    }
};

TEST(StructuralCables, PendulumOfLargeAmplitude) {
    // T/T0 = 2 K(sin(angle/2))/pi. The stretch of the cord, 1e-5 times 1 to 3, is the tolerance's reason; the
    // time between two passes of the vertical is half a period.
    struct Row {
        double degrees, ratio;
    };
    for (const Row& row :
         {Row{10, 1.00190719}, Row{30, 1.01740880}, Row{60, 1.07318201}, Row{90, 1.18034060}}) {
        Pendulum p(row.degrees);
        const double dt = 2e-4;  // the cord's own limit is 2 sqrt(m l/EA) = 2e-3 s
        double first = 0.0, last = 0.0, before = p.structure.position(1).x();
        int passes = 0;
        while (passes < 5) {
            p.structure.step(dt);
            const double now = p.structure.position(1).x();
            if (before * now < 0.0) {
                last = p.structure.state.time - dt * now / (now - before);
                if (passes++ == 0) first = last;
            }
            before = now;
        }
        const double period = 0.5 * (last - first) / (2.0 * pi * std::sqrt(1.0 / standard_gravity));
        EXPECT_NEAR(period / row.ratio, 1.0, 5e-5) << row.degrees;
        test::report("pendulum degrees, T/T0, error", row.degrees, period, period / row.ratio - 1.0);
    }
}

TEST(StructuralCables, PendulumAboveTheHorizontalFalls) {
    // Let go at 120 degrees a rod would swing; a cord cannot push, and the mass falls straight down until
    // the cord is tight again: at the mirrored point, after sqrt(2 * 1 m/g).
    Pendulum p(120.0);
    const double end = 0.99 * std::sqrt(2.0 / standard_gravity);
    while (p.structure.state.time < end)
        p.structure.step(2e-4);
    const double t = p.structure.state.time;
    EXPECT_NEAR(p.structure.position(1).x(), std::sqrt(0.75) * (1.0 - Pendulum::slack), 1e-12);
    EXPECT_NEAR(p.structure.position(1).z(), 0.5 * (1.0 - Pendulum::slack) - 0.5 * standard_gravity * t * t,
                1e-12);
}

}  // namespace
}  // namespace twinchute
