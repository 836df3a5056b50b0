// Lines that are stiffer than fabric take steps of their own from the pack on.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fullsim/run/run_fullsim.hpp"
#include "fullsim/simulation.hpp"
#include "lib/scene/read_scene.hpp"
#include "tests/support/runs.hpp"

namespace twinchute::fullsim {
namespace {

Scene scene_of(const char* file, const std::vector<std::string>& keys = {}) {
    return read_scene(std::string(TWINCHUTE_SOURCE_DIR) + "/data/scenes/paper/" + file, keys);
}

/// A mesh whose fabric could take steps three times as long as its lines while it is drawn out.
Scene coarse_canopy() {
    return scene_of("crane-drop.toml", {"full.mesh.gore_columns=1", "full.mesh.gore_rows=6",
                                        "full.mesh.line_elements=4", "parachute.gores=4"});
}

CriticalSteps bounds_of(const Scene& scene, const Simulation& simulation) {
    State state = simulation.synchronised_state();
    const auto layout = make_reference_layout(simulation.mesh(), simulation.constants());
    const auto structure = make_structure(scene, simulation.mesh(), state.stage);
    const auto loads = make_loads(scene, simulation.mesh(), state.stage);
    layout->begin(state, structure, loads);
    return layout->critical_steps(state);
}

TEST(StiffLines, TakeStepsOfTheirOwnFromThePackOn) {
    // With the printed modulus, a hundred times that of nylon, lines take a seventh of the step that the
    // fabric could. The static line is of the same cord: in elements as short as theirs it would leave
    // nothing of that.
    const Scene scene = scene_of("crane-drop-stiff.toml");
    const Simulation simulation(scene);
    const CriticalSteps bounds = bounds_of(scene, simulation);
    EXPECT_GT(bounds.canopy, 3.0 * bounds.lines);
    EXPECT_GE(simulation.step().subcycles, 3);
    EXPECT_GT(simulation.step().dt, 2.9 * scene.full.time_step_factor * bounds.all);  // three of them
    EXPECT_LE(simulation.step().dt / simulation.step().subcycles,
              scene.full.time_step_factor * bounds.lines * (1.0 + 1e-12));
}

TEST(StiffLines, EitherTakesHalfOfItsBoundWhileItSlaps) {
    Scene scene = coarse_canopy();
    // Folded fabric does not chatter. Of four gores of one column the closed canopy is shorter by cos 45 deg.
    scene.parachutes.front().deploy.pack_ratio = 0.95 * std::sqrt(2.0);
    Simulation simulation(scene);
    ASSERT_FALSE(simulation.system().folded);
    const CriticalSteps bounds = bounds_of(scene, simulation);
    ASSERT_GT(bounds.canopy, 2.5 * bounds.lines);
    const auto [dt, subcycles] = simulation.step_with(0.0, 0.0);
    EXPECT_GT(subcycles, 1);
    EXPECT_LT(simulation.step().dt, dt);  // the first impacts are expected, see ImpactWatch
    EXPECT_NEAR(dt, 0.5 * std::min(bounds.canopy, subcycles * bounds.lines), 1e-12 * dt);
}

TEST(StiffLines, CloseTheLedgerOfADropFromThePack) {
    // To 3.6e-4 of the drag work over seeds, as without subcycles; with the fabric at 0.95 of its bound
    // to 6.5e-4.
    const RunRecord record = test::run_full(coarse_canopy());
    EXPECT_EQ(record.status.code, StatusCode::completed) << record.status.detail;
    EXPECT_LT(std::abs(record.energy->residual_fraction), 5e-4);
    EXPECT_GT(record.cost.steps, 0);
}

TEST(StiffLines, AStaticLineIsAsStrongThroughout) {
    const Scene scene = scene_of("crane-drop.toml");
    const Simulation simulation(scene);
    const StaticLine& line = simulation.mesh().static_line;
    const auto first = simulation.mesh().first_static_line_node();
    double legs = 0.0, length = 0.0, mass = 0.0;
    for (const Cable& c : line.cables) {
        if (c.node[0] < first) {
            legs += c.strands;
            continue;
        }
        EXPECT_EQ(c.strands, 7.0);  // of the 28 lines, a fourth
        length += c.rest_length;
    }
    for (const double m : line.mass)
        mass += m;
    EXPECT_NEAR(legs, 7.0, 1e-12);
    EXPECT_NEAR(length, scene.parachutes.front().deploy.static_line_length, 1e-9);
    // All but half an element at the anchor, which is held.
    const double linear = 7.0 * scene.parachutes.front().line.linear_density();
    const double leg = line.cables.front().rest_length, element = line.cables.back().rest_length;
    EXPECT_NEAR(mass, linear * (leg + length - 0.5 * element), 1e-9);
}

}  // namespace
}  // namespace twinchute::fullsim
