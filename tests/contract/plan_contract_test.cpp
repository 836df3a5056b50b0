// Plans against the runs that they announce: block by block, event by event. Nothing here has
// a number of its own: plan and run are held to each other.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "fullsim/forces/registry.hpp"
#include "fullsim/run/parts.hpp"
#include "fullsim/run/plan.hpp"
#include "fullsim/simulation.hpp"
#include "lib/scene/read_scene.hpp"
#include "rom/plan.hpp"
#include "tests/support/c9_scene.hpp"
#include "tests/support/runs.hpp"

namespace twinchute {
namespace {

using fullsim::ForceBlock, fullsim::force_blocks;
using Names = std::set<std::string>;

struct Case {
    const char* name;
    Scene scene;
};

Scene coarse(Scene scene) {
    scene.full.mesh = {1, 6, 6, 1};
    scene.stop = {Trigger::Kind::full_open, 0.0, 0.3};
    return scene;
}

Scene demo() {
    Scene scene = coarse(test::c9_scene());
    scene.full.contact = Contact::gores;
    return scene;
}

Scene folds_apart() {
    Scene scene = demo();
    scene.full.contact = Contact::self;
    return scene;
}

/// Nothing that a scene may leave out.
Scene bare() {
    Scene scene = coarse(test::c9_scene());
    scene.aerodynamics = {};
    scene.aerodynamics.radial_pressure = 0.8;
    return scene;
}

Scene bare_from_the_pack() {
    Scene scene = bare();
    const Scene packed = test::packed_c9(DeployBy::static_line);
    scene.parachutes = packed.parachutes;
    scene.parachutes.front().deploy.drag_coefficient = 0.0;
    scene.parachutes.front().deploy.deployment_resistance = 0.0;
    scene.release = packed.release;
    scene.full.structure = Structure::fe;
    scene.aerodynamics.breathing_damping = 0.5;
    return scene;
}

/// Everything that goes with this way of deploying.
Scene rich(DeployBy by) {
    Scene scene = test::packed_c9(by);
    scene.stop = {Trigger::Kind::full_open, 0.0, 0.3};
    if (by == DeployBy::extraction) {
        scene.parachutes.front().deploy.extraction = {"", {0.0, 0.5}, {300.0, 300.0}, 0.5};
        scene.release.speed = 60.0;
        scene.environment.ground = -400.0;
    }
    scene.payload.drag_area = 0.4;
    scene.full.alpha = 2.0;
    scene.aerodynamics.added_mass->momentum = AddedMassMomentum::accreting;
    return scene;
}

Scene inflated() {
    Scene scene = coarse(test::c9_scene());
    scene.parachutes.front().deploy.by = DeployBy::inflated;
    scene.release = {40.0, 7.0, 0.5 * pi, 0.5 * pi};
    scene.stop = {Trigger::Kind::ground, 0.0, 0.0};
    scene.parachutes.front().risers = 4;
    scene.payload.body = PayloadBody{PayloadBody::Shape::box, {0.6, 0.4, 0.9}, {}, Elasticity{5e7, 0.3}};
    scene.payload.drag_area_table = AttitudeDrag("own.csv", {0.0, 0.5 * pi}, {0.4, 0.6});
    scene.payload.drag_area = 0.4;
    return scene;
}

const std::vector<Case>& cases() {
    static const std::vector<Case> all{{"bare", bare()},
                                       {"demo", demo()},
                                       {"demo, self-contact", folds_apart()},
                                       {"inflated", inflated()},
                                       {"packed, elements throughout", bare_from_the_pack()},
                                       {"static line", rich(DeployBy::static_line)},
                                       {"extraction", rich(DeployBy::extraction)}};
    return all;
}

/// The runs of the cases, each once.
const std::vector<RunRecord>& full_runs() {
    static const std::vector<RunRecord> all = [] {
        std::vector<RunRecord> records;
        for (const Case& c : cases())
            records.push_back(test::run_full(c.scene));
        return records;
    }();
    return all;
}

Names names_of(const std::vector<PlanPart>& parts, PlanPart::Kind kind, bool needed) {
    Names names;
    for (const PlanPart& part : parts)
        if (part.kind == kind && part.needed == needed) names.insert(part.name);
    return names;
}

Names events_of(const RunRecord& record) {
    Names names;
    for (const Event& event : record.events)
        names.insert(event.name);
    return names;
}

void the_runs_come_to_their_end() {
    for (std::size_t i = 0; i < cases().size(); ++i)
        EXPECT_EQ(full_runs()[i].status.code, StatusCode::completed)
            << cases()[i].name << ": " << full_runs()[i].status.detail;
}

void a_block_is_called_exactly_where_the_plan_needs_it() {
    Names ever_needed, ever_left_out;
    for (std::size_t i = 0; i < cases().size(); ++i) {
        const auto parts = fullsim::parts_of(cases()[i].scene);
        const Names needed = names_of(parts, PlanPart::Kind::block, true);
        const Names left_out = names_of(parts, PlanPart::Kind::block, false);
        Names called, said;
        for (const BlockCost& cost : full_runs()[i].cost.blocks)
            called.insert(cost.name);
        EXPECT_EQ(needed, called) << cases()[i].name;
        EXPECT_EQ(needed.size() + left_out.size(), force_blocks().size());
        ever_needed.insert(needed.begin(), needed.end());
        ever_left_out.insert(left_out.begin(), left_out.end());
        // The record leaves out what the plan does.
        const auto rows = left_out_of(parts);
        ASSERT_EQ(rows.size(), full_runs()[i].left_out.size());
        for (std::size_t k = 0; k < rows.size(); ++k) {
            EXPECT_EQ(rows[k].what, full_runs()[i].left_out[k].what);
            EXPECT_EQ(rows[k].why, full_runs()[i].left_out[k].why);
            EXPECT_FALSE(rows[k].why.empty()) << rows[k].what;
        }
    }
    // No row goes untried, with and without the piece; four no parachute is without.
    for (const ForceBlock& block : force_blocks()) {
        EXPECT_TRUE(ever_needed.contains(std::string(block.name))) << block.name;
        const bool always = block.name == "membrane" || block.name == "tapes" || block.name == "lines" ||
                            block.name == "canopy pressure";
        EXPECT_NE(ever_left_out.contains(std::string(block.name)), always) << block.name;
    }
}

void every_event_of_a_run_is_in_its_plan() {
    Names met;
    for (std::size_t i = 0; i < cases().size(); ++i) {
        const Names watched = names_of(fullsim::parts_of(cases()[i].scene), PlanPart::Kind::event, true);
        for (const std::string& name : events_of(full_runs()[i])) {
            EXPECT_TRUE(watched.contains(name)) << name << ", " << cases()[i].name;
            met.insert(name);
        }
        const RunRecord quick = test::run_rom(cases()[i].scene);
        const Names of_rom = names_of(rom::parts_of(cases()[i].scene), PlanPart::Kind::event, true);
        for (const std::string& name : events_of(quick))
            EXPECT_TRUE(of_rom.contains(name)) << name << ", rom, " << cases()[i].name;
    }
    // And the plan knows of none that never comes.
    for (const Case& c : cases())
        for (const PlanPart& part : fullsim::parts_of(c.scene))
            if (part.kind == PlanPart::Kind::event && part.needed && part.name != "canopy-filled") {
                EXPECT_TRUE(met.contains(part.name)) << part.name;
            }
}

/// One test for the three: each that stood alone would make the runs anew.
TEST(PlanContract, BlocksAndEventsOfRunsAreThoseOfTheirPlans) {
    the_runs_come_to_their_end();
    a_block_is_called_exactly_where_the_plan_needs_it();
    every_event_of_a_run_is_in_its_plan();
}

/// Bytes that a simulation holds for a block, and for elements that only some blocks use.
std::size_t bytes_for(const Scene& scene, const std::string& name) {
    const fullsim::Simulation simulation(scene);
    for (const PlanArray& array : simulation.arrays())
        if (array.name == name) return array.bytes;
    return 0;
}

TEST(PlanContract, WhatIsLeftOutHasNoBytes) {
    for (const char* name : {"edges", "static line", "extraction", "fabric springs"})
        EXPECT_EQ(bytes_for(bare(), name), 0u) << name;
    EXPECT_GT(bytes_for(rich(DeployBy::static_line), "edges"), 0u);
    EXPECT_GT(bytes_for(rich(DeployBy::static_line), "static line"), 0u);
    EXPECT_EQ(bytes_for(rich(DeployBy::static_line), "extraction"), 0u);
    EXPECT_GT(bytes_for(rich(DeployBy::extraction), "extraction"), 0u);
    EXPECT_EQ(bytes_for(rich(DeployBy::extraction), "static line"), 0u);
    Scene rigid = inflated();
    EXPECT_GT(bytes_for(rigid, "payload tetrahedra"), 0u);
    rigid.payload.body->elasticity.reset();
    EXPECT_EQ(bytes_for(rigid, "payload tetrahedra"), 0u);
}

double bytes_a_triangle(const Scene& scene) {
    const fullsim::Simulation simulation(scene);
    const auto triangles = static_cast<double>(simulation.mesh().triangles.size());
    EXPECT_NEAR(triangles, 2000.0, 200.0);
    double bytes = 0.0;
    for (const PlanArray& array : simulation.arrays())
        bytes += static_cast<double>(array.bytes);
    return bytes / triangles;
}

/// Memory of a run of a medium mesh beside its history: at most 400 B a triangle. It had been 508 B while
/// the state held forces that gore-batched have themselves, pressure and fabric drag each had an array, and
/// so had halo nodes the velocities of half steps; pairs in contact were 17 B. Lanes without a gore
/// count: eight lanes are the worst case.
TEST(PlanContract, TheDemoIsHeldInFourHundredBytesATriangle) {
    for (const Scene& scene :
         {test::c9_scene(), read_scene(TWINCHUTE_SOURCE_DIR "/data/scenes/c9-inflation.toml")}) {
        const double bytes = bytes_a_triangle(scene);
        EXPECT_LE(bytes, 400.0);
        EXPECT_GT(bytes, 200.0);  // nothing is left out of the list
    }
}

/// The reduced-order run tells the full plan its times, as the command does.
Plan plan_of(const Scene& scene) {
    const RunRecord expected = test::run_rom(scene);
    PlanBasis basis;
    basis.expected = &expected;
    basis.probe = 0.02;
    return fullsim::plan_full(scene, basis);
}

/// The wanted accuracy of a plan: seconds are the machine's affair, steps are not.
constexpr double wanted = 0.3;

void expect_foreseen(const Scene& scene) {
    const Plan plan = plan_of(scene);
    const RunRecord record = test::run_full(scene);
    const auto steps = static_cast<double>(record.cost.steps);
    ASSERT_TRUE(plan.whole);
    EXPECT_NEAR(plan.steps(), steps, wanted * steps);
    EXPECT_GT(plan.seconds(), 0.0);
}

TEST(PlanContract, ForeseesTheStepsOfTheDemo) {
    Scene scene = test::c9_scene();
    scene.full.mesh = {2, 7, 10, 2};
    scene.full.line_substeps = 4;
    scene.stop = {Trigger::Kind::steady_descent, 0.0, 0.0};
    expect_foreseen(scene);
}

TEST(PlanContract, ForeseesTheStepsOfADropFromThePack) {
    Scene scene = test::packed_c9(DeployBy::static_line);
    scene.full.line_substeps = 4;
    scene.stop = {Trigger::Kind::steady_descent, 0.0, 0.0};
    expect_foreseen(scene);
}

TEST(PlanContract, AnOpenCanopySettlesBeforeItIsReleased) {
    // For 2 D0/v; a run does for 1 to 4, and counts its elements, which here are of 8 runs or more.
    Scene scene = coarse(test::c9_scene());
    Parachute& chute = scene.parachutes.front();
    chute.deploy.by = DeployBy::inflated;
    scene.release.speed = 10.0;
    scene.stop = {Trigger::Kind::time, 0.1, 0.0};
    const Plan plan = plan_of(scene);
    ASSERT_EQ(plan.stages.size(), 2u);
    EXPECT_EQ(plan.stages[0].name, "settling");
    EXPECT_NEAR(plan.stages[0].begin, -2.0 * chute.nominal_diameter / scene.release.speed, 1e-12);
    EXPECT_EQ(plan.stages[0].end, 0.0);
    EXPECT_GT(plan.stages[0].steps, 8.0 * plan.stages[1].steps);
    const Cost cost = test::run_full(scene).cost;
    const auto triangles = static_cast<std::int64_t>(fullsim::Simulation(scene).mesh().triangles.size());
    EXPECT_GT(cost.element_steps, 8 * cost.steps * triangles);
}

TEST(PlanContract, AnEndThatNobodyKnowsIsNotInvented) {
    PlanBasis basis;
    basis.probe = 0.01;
    Scene scene = coarse(test::packed_c9(DeployBy::static_line));
    const Plan plan = fullsim::plan_full(scene, basis);
    EXPECT_FALSE(plan.whole);
    ASSERT_FALSE(plan.stages.empty());
    EXPECT_EQ(plan.stages.front().steps, 1.0);
    EXPECT_GT(plan.stages.front().step(), 0.0);
}

TEST(PlanContract, TheReducedOrderPlanIsARun) {
    for (const Case& c : cases()) {
        PlanBasis basis;
        basis.probe = 0.0;
        const Plan plan = rom::plan_rom(c.scene, basis);
        const RunRecord record = test::run_rom(c.scene);
        EXPECT_EQ(plan.steps(), static_cast<double>(record.cost.steps)) << c.name;
        EXPECT_EQ(left_out_of(plan.parts).size(), record.left_out.size()) << c.name;
    }
}

}  // namespace
}  // namespace twinchute
