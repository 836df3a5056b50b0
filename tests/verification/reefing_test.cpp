// A reefed opening at both fidelities: the reefing line is a ring of cables in one and a law in the other.
#include <gtest/gtest.h>

#include <cmath>

#include "fullsim/fidelity.hpp"
#include "fullsim/simulation.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/scene/read_scene.hpp"
#include "rom/fidelity.hpp"
#include "tests/support/runs.hpp"

namespace twinchute {
namespace {

Scene reefed(const std::string& delay = "4 s") {
    const std::string until = "{ at = \"line-stretch\", delay = \"" + delay + "\" }";
    return read_scene(TWINCHUTE_SOURCE_DIR "/data/scenes/c9-reefed.toml",
                      {"parachute.reefing=[{ drag_area_ratio = 0.1, until = " + until + " }]"});
}

/// [N] of the force over [from, to], trapezoidal.
double mean_force(const RunRecord& record, double from, double to) {
    const auto &time = record.find_channel("time")->values, &force = record.find_channel("force")->values;
    double sum = 0.0, span = 0.0;
    for (std::size_t i = 1; i < time.size(); ++i) {
        if (time[i - 1] < from || time[i] > to) continue;
        sum += 0.5 * (force[i] + force[i - 1]) * (time[i] - time[i - 1]);
        span += time[i] - time[i - 1];
    }
    return sum / span;
}

TEST(Reefing, BothFidelitiesPullAlikeInEachStage) {
    // The drag area is the same in both, and so is what it does to the payload once the reefed canopy is
    // full. Where that filling ends, at 0.56 s, the full model's force overshoots and the other's does not:
    // found 7 % above, in the peak of this stage, which is only held to be no lower. The second stage opens
    // as an unreefed canopy does, whose peaks are 3.5 % apart between 10 and 45 m/s at most.
    const Scene scene = reefed();
    const RunRecord full = test::run_full(scene), rom = test::run_rom(scene);
    ASSERT_EQ(full.status.code, StatusCode::completed) << full.status.detail;
    const double steady = mean_force(rom, 1.0, 3.9);
    EXPECT_NEAR(mean_force(full, 1.0, 3.9), steady, 0.01 * steady);
    EXPECT_GE(*full.metric("stage_1_peak_force_N"), *rom.metric("stage_1_peak_force_N"));
    EXPECT_NEAR(*full.metric("stage_2_peak_force_N"), *rom.metric("stage_2_peak_force_N"),
                0.05 * *rom.metric("stage_2_peak_force_N"));
    EXPECT_EQ(full.find_event("disreef")->time, 4.0);  // exactly, by a step that ends there
    EXPECT_NEAR(*full.metric("stage_1_filling_time_s"), *rom.metric("stage_1_filling_time_s"), 1e-6);
    // The energy that the line held goes with it and is booked; an unreefed run has 1e-4 at most.
    EXPECT_LT(std::abs(full.energy->residual_fraction), 1e-3);
}

TEST(Reefing, TheLineHoldsTheMouth) {
    // At the end of the reefed stage the mouth's polygon of seams is no longer than the line, but for its
    // strain.
    Scene scene = reefed("100 s");
    scene.stop = {Trigger::Kind::time, 2.0, 0.0};
    fullsim::Simulation simulation(scene);
    const auto mouth = [&] {
        const auto& ring = simulation.mesh().seam_rings.back();
        double round = 0.0;
        for (std::size_t i = 0; i < ring.size(); ++i)
            round += (fullsim::to_vec3(simulation.synchronised_state().node[ring[(i + 1) % ring.size()]].x) -
                      fullsim::to_vec3(simulation.synchronised_state().node[ring[i]].x))
                         .norm();
        return round;
    };
    for (const double end : {simulation.inflation().initial_time, simulation.inflation().filling_time, 2.0}) {
        while (simulation.system().time < end) {
            simulation.evaluate_forces();
            simulation.step_to(end);
        }
        simulation.begin(end == simulation.inflation().initial_time ? Phase::filling : Phase::open);
    }
    const double line = reefing_line_length(scene.parachutes.front(), 0);
    EXPECT_NEAR(line, pi * 0.65 * 8.53 * std::sqrt(0.1), 0.01 * line);
    EXPECT_GT(mouth(), 0.95 * line);  // taut
    EXPECT_LT(mouth(), 1.05 * line);  // nylon at a small share of its strength
}

TEST(Reefing, EachStageHasALineOfItsOwnAndACutOneNeverComesTaut) {
    // Round a mouth that opens to the root of the stage's share of the drag area; cut, longer than the whole
    // circumference.
    const Scene scene = read_scene(
        TWINCHUTE_SOURCE_DIR "/data/scenes/c9-inflation.toml",
        {"parachute.reefing=[{ drag_area_ratio = 0.1, until = { at = \"line-stretch\", delay = 1 } },"
         " { drag_area_ratio = 0.3, until = { at = \"line-stretch\", delay = 2 } }]"});
    fullsim::Simulation simulation(scene);
    const auto line = [&] {
        double length = 0.0;
        for (const std::size_t c : simulation.mesh().reefing_line)
            length += simulation.mesh().cables[c].rest_length;
        return length;
    };
    const double mouth = pi * 0.65 * 8.53;
    EXPECT_NEAR(line(), mouth * std::sqrt(0.1), 1e-9);
    simulation.disreef(simulation.inflation(), 1);
    EXPECT_NEAR(line(), mouth * std::sqrt(0.3), 1e-9);
    simulation.disreef(simulation.inflation(), 2);
    EXPECT_GT(line(), pi * 8.53);
}

}  // namespace
}  // namespace twinchute
