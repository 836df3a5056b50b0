// Forces that a full run notes: which of them belong to which interval of the opening.
#include "fullsim/run/observer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/support/small_parachute.hpp"

namespace twinchute::fullsim {
namespace {

/// Forces that are given, in steps that end on given times, some with subcycles.
class GivenForces {
public:
    GivenForces() : mesh_(test::coarse_c9()), state_(test::state_of(mesh_)), observer(mesh_, 9.81, 200.0) {}

private:
    Mesh mesh_;
    State state_;
    std::mt19937 generator_{3};
    std::uniform_real_distribution<double> uniform_{0.0, 1.0};

public:
    Observer observer;

    /// Steps to `end` [s]; force(t) [N] is what the risers pull. Returns the largest of them.
    template <class Force>
    double step_to(double end, Force&& force) {
        double largest = 0.0;
        while (state_.time < end) {
            const double begin = state_.time;
            const double dt = std::min(end - begin, 1e-5 + 3e-4 * uniform_(generator_));
            const int subcycles = uniform_(generator_) < 0.5 ? 1 : 4;
            state_.time = begin + dt < end ? begin + dt : end;
            state_.dt = dt;
            state_.line_dt = dt / subcycles;
            state_.in_subcycles = {};
            for (int k = 1; k <= subcycles; ++k) {
                const double pull = force(k < subcycles ? begin + k * state_.line_dt : state_.time);
                largest = std::max(largest, pull);
                if (k < subcycles) state_.in_subcycles.add(Lanes{0.0, 0.0, pull, 0.0});
                state_.riser_force = {0.0, 0.0, pull};
            }
            observer.observe(state_, state_.riser_force);
            if (observer.row_is_due(state_.time)) observer.add_row(state_);
        }
        return largest;
    }
};

TEST(Observer, NeverFiltersAPeakAboveTheForcesOfItsInterval) {
    // Three stages at random times. Right before the first and the last one stands a spike ten times as large
    // as anything within them, which the second one has at its end.
    std::mt19937 generator(11);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    for (int round = 0; round < 40; ++round) {
        GivenForces run;
        const double begin[] = {0.02 + 0.02 * uniform(generator), 0.06 + 0.02 * uniform(generator),
                                0.1 + 0.02 * uniform(generator), 0.14 + 0.02 * uniform(generator)};
        double spike_at = begin[0];
        const auto force = [&](double t) {
            const double left = spike_at - t;
            return 1000.0 + 300.0 * std::sin(700.0 * t + round) +
                   (left > 0.0 && left < 1e-3 ? 1e4 * left / 1e-3 : 0.0);
        };
        run.observer.count_peak_from(begin[0]);
        run.step_to(begin[0], force);
        double largest[3], all = 0.0;
        for (int stage = 0; stage < 3; ++stage) {
            spike_at = stage == 1 ? begin[2] : 0.0;
            // The force at the very end of the step into the boundary belongs to both sides.
            const double at_begin = force(begin[stage]);
            largest[stage] = std::max(at_begin, run.step_to(begin[stage + 1], force));
            all = std::max(all, largest[stage]);
            if (stage < 2) run.observer.begin_stage(begin[stage + 1]);
        }
        run.observer.finish();
        ASSERT_EQ(run.observer.earlier_peaks().size(), 2u);
        const Observer::Peak peaks[] = {run.observer.earlier_peaks()[0], run.observer.earlier_peaks()[1],
                                        run.observer.peak()};
        for (int stage = 0; stage < 3; ++stage) {
            EXPECT_GT(peaks[stage].value, 0.0);
            EXPECT_LE(peaks[stage].value, largest[stage] * (1.0 + 1e-12)) << round << ", " << stage;
            EXPECT_LE(peaks[stage].value, run.observer.raw_peak().value * (1.0 + 1e-12));
            EXPECT_GE(peaks[stage].time, begin[stage]);
            EXPECT_LE(peaks[stage].time, begin[stage + 1]);
        }
        EXPECT_LE(run.observer.raw_peak().value, all * (1.0 + 1e-12));
    }
}

TEST(Observer, CountsAPeakThatTheEndOfTheRunCutsOff) {
    // 1000 N, and a rise to 2000 N in the last millisecond: of the last 2.5 ms the mean is 1000 + 500/2.5 N.
    GivenForces run;
    run.step_to(0.05, [](double t) { return 1000.0 + 1e6 * std::max(0.0, t - 0.049); });
    run.observer.finish();
    EXPECT_NEAR(run.observer.peak().value, 1200.0, 20.0);  // steps of 0.3 ms, means over subcycles
    EXPECT_GT(run.observer.peak().time, 0.049);
}

/// Steps of 1 ms to `end` [s] with a projected area and a force over time, rows at a rate.
struct GivenGrowth {
    static double force(double t) { return 2000.0 * (1.0 + std::sin(20.0 * t)); }
    static double impulse(double t) { return 2000.0 * t - 100.0 * std::cos(20.0 * t); }

    Mesh mesh = test::coarse_c9();
    State state = test::state_of(mesh);
    Observer observer;

    explicit GivenGrowth(double output_rate) : observer(mesh, 9.81, output_rate) {}

    template <class Area>
    void step_to(double end, Area&& area) {
        for (int k = 0; state.time < end; ++k) {
            state.air.projected_area = area(state.time);
            state.riser_force = {0.0, 0.0, force(state.time)};
            observer.observe(state, state.riser_force);
            if (observer.row_is_due(state.time)) observer.add_row(state);
            state.time += 1e-3;
        }
    }
};

TEST(Observer, ReadsAnImpulseAndATimeOfFillingOffStepsAndNotOffRows) {
    // The area comes to 10 m^2 between two rows, falls back for a while and creeps on.
    const auto area = [](double t) { return t < 0.101 ? 100.0 * t : t < 0.3 ? 9.0 : 9.0 + 5.0 * (t - 0.3); };
    for (const double rate : {20.0, 100.0, 1000.0}) {
        GivenGrowth run(rate);
        run.step_to(1.0, area);
        run.observer.finish();
        ASSERT_TRUE(run.observer.first_time_of_area(9.99));
        EXPECT_NEAR(*run.observer.first_time_of_area(9.99), 0.0999, 1e-12) << rate;
        EXPECT_NEAR(*run.observer.first_time_of_area(10.5), 0.6, 1e-12) << rate;
        EXPECT_FALSE(run.observer.first_time_of_area(13.0));
        // From the first row to half an interval after another. Trapezoids of a step and the filter of rows:
        // 1e-4. A straight force between two rows errs by its curvature times h^3 (s^3/6 - s^2/4 + s/12), s
        // within the interval: at most 1/120; without the last term, 1/24 in the middle.
        const double h = 1.0 / rate, to = 0.8 + 0.5 * h,
                     expected = GivenGrowth::impulse(to) - GivenGrowth::impulse(0.0);
        EXPECT_NEAR(run.observer.impulse(0.0, to), expected,
                    1e-4 * expected + 2000.0 * 400.0 * h * h * h / 120.0)
            << rate;
    }
}

TEST(Observer, BeginsWithTheAreaAnewInEachStage) {
    // It is wide before a stage begins, and half as wide when it does.
    GivenGrowth run(200.0);
    run.step_to(0.2, [](double) { return 10.0; });
    run.observer.begin_stage(run.state.time);
    run.step_to(0.5, [](double t) { return 5.0 + 20.0 * (t - 0.2); });
    EXPECT_NEAR(*run.observer.first_time_of_area(9.0), 0.4, 1e-9);
    EXPECT_NEAR(run.observer.largest_area(), 11.0, 0.03);  // of steps of 0.02 m^2
    // What comes after the last check is dropped with the rows where the next one finds something wrong.
    run.observer.accept();
    run.step_to(0.6, [](double) { return 30.0; });
    EXPECT_TRUE(run.observer.first_time_of_area(20.0));
    run.observer.forget();
    EXPECT_FALSE(run.observer.first_time_of_area(20.0));
    EXPECT_NEAR(*run.observer.first_time_of_area(9.0), 0.4, 1e-9);
    run.observer.count_peak_from(run.state.time);
    EXPECT_FALSE(run.observer.first_time_of_area(1.0));
}

TEST(CanopyShape, CountsHowOftenTheSkirtGoesAround) {
    // The canopy of a mesh, its angles about the axis times a whole number: the places of the skirt's nodes
    // then go around so often, in or against the order of the gores. Radii stay, and with them the mean
    // diameter.
    const Mesh mesh = test::coarse_c9();
    const State open = test::state_of(mesh);
    const CanopyShape sound = canopy_shape(open, mesh);
    EXPECT_EQ(sound.turns, 1.0);
    for (const int times : {-1, 2, 3}) {
        State wound = open;
        for (NodeRecord& node : wound.node) {
            const double radius = std::hypot(node.x[0], node.x[1]),
                         angle = times * std::atan2(node.x[1], node.x[0]);
            node.x[0] = radius * std::cos(angle), node.x[1] = radius * std::sin(angle);
        }
        const CanopyShape shape = canopy_shape(wound, mesh);
        EXPECT_EQ(shape.turns, times);
        EXPECT_NEAR(shape.seam_diameter, sound.seam_diameter, 1e-9);
    }
    // Nodes that go back make a loop, of which the tangent turns once more: a small one, of 20 deg, leaves
    // the canopy a canopy; one of 60 deg does not.
    for (const auto& [back, turns] : {std::pair{20.0, 1.0}, {60.0, 2.0}}) {
        State looped = open;
        const auto& skirt = mesh.seam_rings.back();
        const auto whole = static_cast<double>(skirt.size());
        for (std::size_t k = 0; k < skirt.size(); ++k) {
            // Forth by 180 deg, back by some, forth to the end, outward meanwhile so that the loop is open.
            const double share = static_cast<double>(k) / whole, turned = back * pi / 180.0;
            const double angle = share < 0.4   ? share / 0.4 * pi
                                 : share < 0.6 ? pi - (share - 0.4) / 0.2 * turned
                                               : pi - turned + (share - 0.6) / 0.4 * (pi + turned);
            const double radius = share > 0.35 && share < 0.6 ? 3.0 - 4.0 * (share - 0.35) : 2.5;
            looped.node[skirt[k]].x[0] = radius * std::cos(angle);
            looped.node[skirt[k]].x[1] = radius * std::sin(angle);
        }
        EXPECT_EQ(canopy_shape(looped, mesh).turns, turns) << back;
    }
    // Lines that share a node make it a corner once.
    Mesh doubled = mesh;
    auto& skirt = doubled.seam_rings.back();
    for (std::size_t k = 0; k < skirt.size(); k += 2)
        skirt.insert(skirt.begin() + static_cast<std::ptrdiff_t>(k), skirt[k]);
    EXPECT_EQ(canopy_shape(open, doubled).turns, 1.0);
}

}  // namespace
}  // namespace twinchute::fullsim
