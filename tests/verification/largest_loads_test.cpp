// The largest line tension and fabric stress of a record are those of all steps, not of those that a check
// happens to look at. Expected: positions of every step, put into the laws of cable and membrane here.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "fullsim/forces/membrane.hpp"
#include "fullsim/mesh/start.hpp"
#include "fullsim/run/run_fullsim.hpp"
#include "fullsim/simulation.hpp"
#include "lib/scene/read_scene.hpp"
#include "tests/support/runs.hpp"

namespace twinchute::fullsim {
namespace {

/// A payload of 1 kg, which meets taut lines at the start: everything chatters and rings.
Scene light_payload() {
    return read_scene(std::string(TWINCHUTE_SOURCE_DIR) + "/data/scenes/c9-inflation.toml",
                      {"payload.mass='1 kg'", "full.mesh.gore_columns=2", "full.mesh.gore_rows=6",
                       "full.mesh.line_elements=4", "stop.time='0.2 s'", "full.line_substeps=1"});
}

/// T = EA (l - l0)/l0, and the larger principal value of the stress by Mohr's circle.
LargestLoads loads_of(const State& state, const Mesh& mesh) {
    const auto at = [&](NodeIndex i) { return to_vec3(state.node[i].x); };
    LargestLoads loads;
    for (const Cable& c : mesh.cables)
        if (c.kind == CableKind::line)
            loads.add_tension(mesh.cord(c.kind).axial_stiffness() * c.strands *
                              ((at(c.node[1]) - at(c.node[0])).norm() / c.rest_length - 1.0));
    const MembraneLaw law = membrane_law(mesh.fabric, 0.0);
    for (const Triangle& t : mesh.triangles) {
        const PlaneTensor n =
            membrane_stress(law, green_strain(t, {at(t.node[0]), at(t.node[1]), at(t.node[2])}));
        loads.add_stress(0.5 * (n.xx + n.yy) + std::hypot(0.5 * (n.xx - n.yy), n.xy));
    }
    return loads;
}

/// Loads of every step, and of each fiftieth, by hand.
struct ByHand {
    LargestLoads all, sampled;
};

ByHand by_hand(const Scene& scene) {
    const Scene meshed = weighed(scene);  // as a run does
    Simulation simulation(meshed);
    ByHand loads;
    const auto look = [&] {
        simulation.evaluate_forces();
        const LargestLoads now = loads_of(simulation.synchronised_state(), simulation.mesh());
        const bool checked = simulation.system().step % 50 == 0 || simulation.system().time >= 0.2;
        for (LargestLoads* some : {&loads.all, checked ? &loads.sampled : &loads.all}) {
            some->add_tension(now.line_tension);
            some->add_stress(now.fabric_stress);
        }
    };
    look();
    while (simulation.system().time < 0.2) {
        const double end = simulation.inflation().end_of(simulation.system().phase);
        if (simulation.system().time >= end)
            simulation.begin(simulation.system().phase == Phase::initial ? Phase::filling : Phase::open);
        simulation.step_to(std::min(0.2, simulation.inflation().end_of(simulation.system().phase)));
        look();
    }
    return loads;
}

TEST(LargestLoads, AreThoseOfAllSteps) {
    const Scene scene = light_payload();
    const ByHand loads = by_hand(scene);
    // 1e-9: the run's own strains are good to 2e-16, of 1e-3 or so, in a run of a thousand steps.
    const RunRecord record = test::run_full(scene);
    EXPECT_EQ(record.status.code, StatusCode::completed) << record.status.detail;
    EXPECT_NEAR(*record.metric("max_line_tension_N") / loads.all.line_tension, 1.0, 1e-9);
    EXPECT_NEAR(*record.metric("max_membrane_stress_N_m") / loads.all.fabric_stress, 1.0, 1e-9);
    // And a look at every fiftieth step would have missed a good part of it.
    EXPECT_LT(loads.sampled.line_tension, 0.98 * loads.all.line_tension);
    EXPECT_LT(loads.sampled.fabric_stress, 0.98 * loads.all.fabric_stress);
}

TEST(LargestLoads, DoNotLoseWhatIsNoNumber) {
    LargestLoads loads;
    loads.add_tension(3.0);
    loads.add_tension(std::numeric_limits<double>::quiet_NaN());
    loads.add_tension(5.0);
    EXPECT_TRUE(std::isnan(loads.line_tension));
    loads.add_stress(2.0);
    loads.add_stress(-1.0);
    EXPECT_EQ(loads.fabric_stress, 2.0);
}

}  // namespace
}  // namespace twinchute::fullsim
