// Mass added to the nodes that set the step: how much, where, and what for.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "fullsim/forces/registry.hpp"
#include "fullsim/mesh/gores.hpp"
#include "fullsim/run/run_fullsim.hpp"
#include "fullsim/simulation.hpp"
#include "fullsim/time/mass_scaling.hpp"
#include "tests/support/c9_scene.hpp"
#include "tests/support/structure.hpp"

namespace twinchute::fullsim {
namespace {

double sum(const std::vector<double>& a, NodeIndex count) {
    return std::accumulate(a.begin(), a.begin() + count, 0.0);
}

/// [s] of each canopy node, held by what a stage before flight has, unstrained: there all columns count
/// alike.
std::vector<double> bounds(const Scene& scene, const Mesh& mesh, Stage stage) {
    State still = test::state_of(mesh);
    still.stage = stage;
    still.node.assign(still.node.size(), {splat(0.0), splat(0.0)});
    GershgorinSums sums = no_rows(still, std::vector<double>(still.node.size(), 1.0));
    for (const auto& model : make_structure(scene, mesh, stage))
        model->add_row_sums(still, sums);
    std::vector<double> dt;
    for (NodeIndex i = 0; i < mesh.canopy_nodes; ++i)
        dt.push_back(critical_step({{sums.stiffness[i]}, {sums.damping[i]}}, {mesh.mass[i]}).dt);
    return dt;
}

TEST(MassScaling, AddsWhatItMayToCanopyNodesAlone) {
    const Scene scene = test::c9_scene();
    const Mesh before = Simulation(scene).mesh();
    Mesh after = before;
    const double air = 60.0;
    const MassScaling done = scale_masses(scene, 1e-3, air, after);
    const double canopy = sum(before.mass, before.canopy_nodes);
    // A bisection to the last bits of the factor: the mass follows it with a condition of about 1e4.
    EXPECT_NEAR(done.mass, 1e-3 * (canopy + air), 1e-10);
    EXPECT_NEAR(sum(after.mass, after.canopy_nodes) - canopy, done.mass, 1e-10);
    EXPECT_NEAR(done.share, 1e-3, 1e-11);
    EXPECT_GT(done.longer, 1.0);
    int heavier = 0;
    for (NodeIndex i = 0; i < before.node_count(); ++i) {
        EXPECT_GE(after.mass[i], before.mass[i]);
        if (!before.is_canopy(i)) {
            EXPECT_EQ(after.mass[i], before.mass[i]);
        }
        heavier += after.mass[i] > before.mass[i];
    }
    EXPECT_EQ(heavier, done.nodes);
}

TEST(MassScaling, MakesTheStepAsMuchLongerAsItSays) {
    // Until flight the bound is the same formula that the masses come from, so that nothing but rounding
    // differs.
    const Scene scene = test::packed_c9(DeployBy::free);
    const Mesh before = Simulation(scene).mesh();
    Mesh after = before;
    const MassScaling done = scale_masses(scene, 1e-3, 60.0, after);
    const std::vector<double> bare = bounds(scene, before, Stage::deployment),
                              scaled = bounds(scene, after, Stage::deployment);
    const double least = std::ranges::min(bare);
    EXPECT_NEAR(std::ranges::min(scaled) / least, done.longer, 1e-9);
    // Nodes heavy enough for this stage are at most heavier than another needs.
    for (std::size_t i = 0; i < bare.size(); ++i)
        if (bare[i] < done.longer * least) {
            EXPECT_GE(scaled[i], done.longer * least * (1.0 - 1e-9));
        }
}

TEST(MassScaling, LeavesGoresAlike) {
    Scene scene = test::c9_scene();
    scene.full.mass_scaling = 1e-3;
    EXPECT_TRUE(find_gores(Simulation(scene).mesh()));
}

TEST(MassScaling, IsNotThereUnlessAskedFor) {
    Scene scene = test::c9_scene();
    const Simulation without(scene);
    EXPECT_EQ(without.mass_scaling().nodes, 0);
    scene.full.mass_scaling = 5e-4;
    const Simulation with(scene);
    EXPECT_GT(with.mass_scaling().nodes, 0);
    EXPECT_NE(with.mesh().mass, without.mesh().mass);
    EXPECT_NEAR(with.mass_scaling().share, 5e-4, 1e-11);
}

TEST(MassScaling, IsInTheRecord) {
    Scene scene = test::c9_scene();
    scene.full.mesh = {2, 7, 10, 2};
    scene.stop = {Trigger::Kind::time, 0.01, 0.0};
    const auto says = [&] {
        twinchute::Run run;
        const RunRecord record = run_fullsim(scene, run);
        return std::ranges::any_of(record.left_out, [](const LeftOut& out) {
            return out.why.find("full.mass_scaling adds") != std::string::npos;
        });
    };
    EXPECT_FALSE(says());
    scene.full.mass_scaling = 1e-3;
    EXPECT_TRUE(says());
}

}  // namespace
}  // namespace twinchute::fullsim
