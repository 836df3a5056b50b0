// Every layout and every instruction set gives the answer of the force blocks themselves, which are the
// reference: in states recorded on the way through whole runs.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "fullsim/mesh/gores.hpp"
#include "fullsim/simulation.hpp"
#include "fullsim/storage/gore_batched/kernels.hpp"
#include "fullsim/storage/simd/sanitized.hpp"
#include "fullsim/storage/unstructured/kernels.hpp"
#include "fullsim/storage/unstructured/quads.hpp"
#include "lib/scene/read_scene.hpp"
#include "tests/support/layout_answer.hpp"
#include "tests/support/predicted.hpp"
#include "tests/support/small_parachute.hpp"

namespace twinchute::fullsim {
namespace {

using test::Answer, test::answer_of, test::expect_same, test::expect_same_body, test::stiffest_cable;

struct NamedLayout {
    std::string name;
    std::unique_ptr<Layout> layout;
};

/// Each layout that can have this mesh with each instruction set of this machine.
std::vector<NamedLayout> layouts_of(const Scene& scene, const Mesh& mesh, const NodeConstants& constants) {
    std::vector<NamedLayout> all;
    for (const unstructured::Kernels& kernels : unstructured::all_kernels())
        all.push_back({fmt::format("unstructured, {}", kernels.instruction_set),
                       make_unstructured_layout(scene, mesh, constants, &kernels)});
    for (const GoreKernels& kernels : all_gore_kernels())
        if (auto gores = make_gore_layout(scene, mesh, constants, &kernels))
            all.push_back({fmt::format("gores, {}", kernels.instruction_set), std::move(gores)});
    return all;
}

void compare_all(const Scene& scene, const Mesh& mesh, const NodeConstants& constants, const State& state,
                 bool gores_alike) {
    const auto structure = make_structure(scene, mesh, state.stage);
    const auto loads = make_loads(scene, mesh, state.stage);
    const auto body = make_body(scene, mesh);
    const Answer reference =
        answer_of(*make_reference_layout(mesh, constants), state, constants, structure, loads, body.get());
    const std::vector<NamedLayout> all = layouts_of(scene, mesh, constants);
    EXPECT_EQ(all.size(), unstructured::all_kernels().size() + (gores_alike ? all_gore_kernels().size() : 0));
    for (const auto& [name, layout] : all) {
        SCOPED_TRACE(name + " step " + std::to_string(state.step));
        const Answer answer = answer_of(*layout, state, constants, structure, loads, body.get());
        expect_same(reference, answer, stiffest_cable(scene));
        if (!body) continue;
        const auto first = static_cast<std::size_t>(mesh.first_attachment());
        expect_same_body(reference.state, answer.state, first);
        expect_same_body(reference.in_subcycles, answer.in_subcycles, first);
    }
}

/// Looks at a hundred states of a run, evenly spaced in steps, whatever stage they are in.
void compare_along(const Scene& scene, int steps, std::size_t stages = 1) {
    Simulation simulation(scene);
    const auto looks = std::max(1, steps / (is_sanitized ? 25 : 100));
    std::vector<Stage> seen;
    for (int step = 0; step < steps; ++step) {
        simulation.evaluate_forces();
        const Stage stage = simulation.system().stage;
        if (stage == Stage::deployment && simulation.lines_are_taut()) {
            ASSERT_FALSE(simulation.snatch());
        } else if (stage == Stage::springs && simulation.mouth_is_open()) {
            simulation.begin_ramp();
        } else if (simulation.system().time >= simulation.ramp_end()) {
            simulation.end_ramp();
        }
        if (simulation.is_reefed() && step == steps / 2)  // half way its line is cut
            simulation.disreef(simulation.inflation(), scene.parachutes.front().reefing.size());
        const bool is_new = std::ranges::find(seen, simulation.system().stage) == seen.end();
        if (step % looks == 0 || is_new) {
            const State& state = simulation.synchronised_state();
            if (is_new) seen.push_back(state.stage);
            compare_all(scene, simulation.mesh(), simulation.constants(), state, true);
            if (testing::Test::HasFailure()) return;
        }
        simulation.step_to(std::min(1e9, simulation.ramp_end()));
    }
    EXPECT_EQ(seen.size(), stages) << "stages that are looked at";
}

Scene crane_drop(const std::vector<std::string>& more) {
    std::vector<std::string> overrides{"full.mesh.gore_rows=6", "full.mesh.line_elements=4",
                                       "full.mesh.riser_elements=2"};
    overrides.insert(overrides.end(), more.begin(), more.end());
    return read_scene(std::string(TWINCHUTE_SOURCE_DIR) + "/data/scenes/paper/crane-drop.toml", overrides);
}

TEST(Layouts, AgreeOnAPackedDropInEveryStage) {
    compare_along(crane_drop({"full.beta=1e-7", "parachute.deploy.length='3 m'", "full.ramp_time='0.3 s'"}),
                  120'000, 4);
}

TEST(Layouts, AgreeWhereGoresTouch) {
    // While the demo opens to the point where gores of different risers meet, lines in subcycles or not; a
    // breath of noise, so that what contacts push off on the axis is not nothing.
    for (const char* subcycles : {"1", "4"})
        compare_along(read_scene(std::string(TWINCHUTE_SOURCE_DIR) + "/data/scenes/c9-inflation.toml",
                                 {"full.contact='gores'", "full.mesh.gore_columns=3", "full.mesh.gore_rows=6",
                                  "full.mesh.line_elements=4", "full.noise.amplitude=1e-3",
                                  std::string("full.line_substeps=") + subcycles}),
                      12'000);
}

TEST(Layouts, AgreeWhereFoldsTouch) {
    // Nodes of fabric wherever they meet fabric; pleats are full triangles.
    const std::vector<std::string> all{"4", "1"};
    for (const std::string& subcycles : std::span(all).first(is_sanitized ? 1 : 2))
        compare_along(read_scene(std::string(TWINCHUTE_SOURCE_DIR) + "/data/scenes/c9-inflation.toml",
                                 {"full.contact='self'", "full.mesh.gore_columns=4", "full.mesh.gore_rows=6",
                                  "full.mesh.line_elements=4", "full.noise.amplitude=1e-3",
                                  "full.line_substeps=" + subcycles}),
                      12'000);
}

TEST(Layouts, AgreeWhereLinesTouchFabric) {
    // Which they do too seldom to wait for it: one node of a line is put on the fabric of the next gore.
    for (const char* subcycles : {"1", "4"}) {
        const Scene scene =
            read_scene(std::string(TWINCHUTE_SOURCE_DIR) + "/data/scenes/c9-inflation.toml",
                       {"full.contact='self'", "full.mesh.gore_columns=4", "full.mesh.gore_rows=6",
                        "full.mesh.line_elements=20", std::string("full.line_substeps=") + subcycles});
        Simulation simulation(scene);
        for (int step = 0; step < 200; ++step) {
            simulation.evaluate_forces();
            simulation.step_to(1e9);
        }
        const Mesh& mesh = simulation.mesh();
        State state = simulation.synchronised_state();
        const auto line = std::ranges::find_if(mesh.cables, [&](const Cable& c) {
            return c.kind == CableKind::line && !mesh.is_canopy(c.node[0]) && !mesh.is_canopy(c.node[1]);
        });
        ASSERT_NE(line, mesh.cables.end());
        const NodeIndex node = line->node[1];
        // The nearest triangle that is not folded.
        const auto corner = [&](const Triangle& t, int i) { return to_vec3(state.node[t.node[i]].x); };
        const auto area_of = [&](const Triangle& t) {
            return Vec3((corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0)));
        };
        const auto centre_of = [&](const Triangle& t) {
            return Vec3((corner(t, 0) + corner(t, 1) + corner(t, 2)) / 3.0);
        };
        const auto nearest = std::ranges::min_element(mesh.triangles, {}, [&](const Triangle& t) {
            const bool is_folded = area_of(t).norm() < 0.8 * t.a * t.c;
            return is_folded ? infinity : (centre_of(t) - to_vec3(state.node[node].x)).norm();
        });
        const Vec3 normal = area_of(*nearest).normalized();
        state.node[node].x = to_lanes(centre_of(*nearest) + 0.001 * normal);
        const ForceModels structure = make_structure(scene, mesh, state.stage);
        const ForceModel* contact = find_block(structure, Block::self_contact);
        state.contact = {};
        contact->prepare(state);
        const auto pair = std::ranges::find_if(state.contact.pairs, [&](const NearPair& p) {
            return p.node == node && p.triangle == nearest - mesh.triangles.begin();
        });
        ASSERT_NE(pair, state.contact.pairs.end());
        pair->side = 1, pair->thickness = 0.004;  // 3 mm of overlap
        state.contact.listed = false;
        const double energy = contact->energy(state);
        EXPECT_GT(energy, 1e-3);
        {
            State pushed = state;
            clear_forces(pushed);
            contact->add_forces(pushed);
            EXPECT_GT(to_vec3(pushed.force[node].value).norm(), 1.0);
        }
        compare_all(scene, mesh, simulation.constants(), state, true);
    }
}

TEST(Layouts, AgreeAboveABody) {
    // Swinging from an oblique opening, and from the pack: rigid and deformable, its attachments with it.
    const std::string elastic = "payload.body.elasticity.youngs_modulus='50 MPa'";
    const std::vector<std::string> bodies{elastic, ""};  // the first moves whatever a rigid one does
    for (const std::string& more : std::span(bodies).first(is_sanitized ? 1 : 2)) {
        std::vector<std::string> box{"payload.body.shape='box'", "payload.body.size=[0.6, 0.4, 0.9]",
                                     "parachute.risers=4"};
        if (!more.empty()) {
            box.push_back(more);
            box.emplace_back("payload.body.elasticity.poisson_ratio=0.3");
        }
        std::vector<std::string> small{"full.mesh.gore_columns=2", "full.mesh.gore_rows=6",
                                       "full.mesh.line_elements=4"};
        small.insert(small.end(), box.begin(), box.end());
        compare_along(
            read_scene(std::string(TWINCHUTE_SOURCE_DIR) + "/data/scenes/c9-inflation-oblique.toml", small),
            is_sanitized ? 2'000 : 6'000);
        box.emplace_back("parachute.deploy.length='3 m'");
        box.emplace_back("full.ramp_time='0.3 s'");
        if (!is_sanitized) compare_along(crane_drop(box), 60'000, 4);
        if (HasFailure()) return;
    }
}

TEST(Layouts, AgreeWhereFillingIsPredicted) {
    // From line stretch and from the pack, through all stages.
    compare_along(
        test::predicted(
            read_scene(std::string(TWINCHUTE_SOURCE_DIR) + "/data/scenes/c9-inflation.toml",
                       {"full.mesh.gore_columns=3", "full.mesh.gore_rows=6", "full.mesh.line_elements=4"}),
            0.02),
        12'000);
    compare_along(
        test::predicted(
            crane_drop({"full.beta=1e-7", "parachute.deploy.length='3 m'", "full.ramp_time='0.3 s'"}), 0.04),
        120'000, 4);
    // Air leaves through a gap, whose edges are nodes of all sectors.
    compare_along(
        test::predicted(crane_drop({"parachute.type='disk-gap-band'", "parachute.deploy.by='line-stretch'",
                                    "release.speed='25 m/s'", "release.path_angle='90 deg'"}),
                        0.02),
        12'000);
}

TEST(Layouts, AgreeWhereAReefedFillingIsPredicted) {
    // Behind a line that is shorter than the mouth which the filling would count, or longer; and once it is
    // cut.
    Scene scene = test::predicted(
        read_scene(std::string(TWINCHUTE_SOURCE_DIR) + "/data/scenes/c9-reefed.toml",
                   {"full.mesh.gore_columns=3", "full.mesh.gore_rows=6", "full.mesh.line_elements=4"}),
        0.02);
    for (const double line : {1.5, 5.5}) {
        scene.parachutes.front().reefing.front().line_length = line;
        compare_along(scene, 12'000);
    }
}

TEST(Layouts, AgreeOnAnExtraction) {
    // At the apex and over the canopy; damping from release on, payload drag, single columns.
    for (const bool on_apex : {true, false}) {
        Scene scene = crane_drop({"full.alpha_from='release'", "full.mesh.gore_columns=1"});
        Deployment& deploy = scene.parachutes.front().deploy;
        deploy.by = DeployBy::extraction;
        deploy.extraction = {"", {0.0, 1.0}, {300.0, 300.0}, 1.0};
        deploy.extraction_on_apex = on_apex;
        scene.payload.drag_area = 0.4;
        compare_along(scene, 2'000);
    }
}

TEST(Layouts, AgreeWhereElementsCarryThePack) {
    // Membranes and folds without springs, on the uniform mesh.
    compare_along(crane_drop({"full.structure='fe'", "full.mesh.grading='uniform'"}), 4'000);
}

TEST(Layouts, AgreeWhereGoresHaveAGap) {
    // From the pack on springs, which end at a gap as the fabric does; and elements.
    compare_along(crane_drop({"parachute.type='disk-gap-band'", "full.ramp_time='0.3 s'"}), 120'000, 4);
}

TEST(Layouts, AgreeWhereGoresFillNoBlock) {
    // Thirty and twelve gores, odd and even columns; accreting air; an oblique start and an open canopy.
    Scene scene = crane_drop({"full.mesh.gore_columns=3"});
    scene.full.contact = Contact::gores;
    scene.parachutes.front().gores = 30;
    scene.parachutes.front().risers = 3;
    scene.parachutes.front().deploy.by = DeployBy::line_stretch;
    scene.release.speed = 25.0;
    scene.release.path_angle = 1.0;
    scene.aerodynamics.added_mass->momentum = AddedMassMomentum::accreting;
    compare_along(scene, 2'000);
    scene = crane_drop({"full.mesh.gore_columns=4"});
    scene.parachutes.front().gores = 12;
    scene.parachutes.front().risers = 1;
    scene.parachutes.front().deploy.by = DeployBy::inflated;
    scene.release.speed = 8.0;
    scene.release.path_angle = 1.5;
    compare_along(scene, 2'000);
}

TEST(Layouts, ASmoothOpeningIsTheSameInAll) {
    // The line-stretch demo is smooth: differences of rounding stay what they are. 1e-6 of the raw peak, its
    // time and the payload's place after 2 s.
    Scene scene =
        read_scene(std::string(TWINCHUTE_SOURCE_DIR) + "/data/scenes/c9-inflation.toml",
                   {"full.mesh.gore_columns=1", "full.mesh.gore_rows=9", "full.mesh.line_elements=8"});
    struct Outcome {
        double peak = 0.0, peak_time = 0.0, altitude = 0.0;
    };
    const auto fly = [&](const Simulation::LayoutMaker& layout) {
        Simulation simulation(scene, layout);
        Outcome outcome;
        while (simulation.system().time < 2.0) {
            simulation.evaluate_forces();
            const SystemState& now = simulation.system();
            const double force = now.riser_force.norm();
            if (force > outcome.peak) outcome = {force, now.time, 0.0};
            if (now.time >= simulation.inflation().end_of(now.phase))
                simulation.begin(now.phase == Phase::initial ? Phase::filling : Phase::open);
            simulation.step_to(std::min(2.0, simulation.inflation().end_of(now.phase)));
        }
        outcome.altitude = simulation.payload().x[2];
        return outcome;
    };
    const Outcome reference = fly([](const Scene&, const Mesh& mesh, const NodeConstants& constants) {
        return make_reference_layout(mesh, constants);
    });
    EXPECT_GT(reference.peak, 3.0 * scene.payload.mass * 9.8);
    const auto expect_same_outcome = [&](const Simulation::LayoutMaker& layout) {
        const Outcome other = fly(layout);
        EXPECT_NEAR(other.peak, reference.peak, 1e-6 * reference.peak);
        EXPECT_NEAR(other.peak_time, reference.peak_time, 1e-6 * reference.peak_time);
        EXPECT_NEAR(other.altitude, reference.altitude, 1e-6 * reference.altitude);
    };
    for (const GoreKernels& kernels : all_gore_kernels()) {
        SCOPED_TRACE(kernels.instruction_set);
        expect_same_outcome([&](const Scene& s, const Mesh& mesh, const NodeConstants& constants) {
            return make_gore_layout(s, mesh, constants, &kernels);
        });
    }
    for (const unstructured::Kernels& kernels : unstructured::all_kernels()) {
        SCOPED_TRACE(fmt::format("unstructured, {}", kernels.instruction_set));
        expect_same_outcome([&](const Scene& s, const Mesh& mesh, const NodeConstants& constants) {
            return make_unstructured_layout(s, mesh, constants, &kernels);
        });
    }
}

/// Every element, mass and node a little different from all others: nothing of it may be taken from a
/// neighbour.
Mesh made_uneven(Mesh mesh) {
    double factor = 1.0;
    const auto next = [&] { return 1.0 + 1e-3 * (factor = 1.9 * factor - std::floor(1.9 * factor)); };
    for (Triangle& t : mesh.triangles)
        t.a *= next(), t.b *= next(), t.c *= next();
    for (Cable& c : mesh.cables)
        c.rest_length *= next();
    return mesh;
}

/// A block that no batched layout has a row for: springs from canopy nodes to where they are at the start,
/// and a breeze on all nodes.
class BlockWithoutRow final : public ForceModel {
public:
    BlockWithoutRow(const State& state, const Mesh& mesh, bool springs) : mesh_(mesh), springs_(springs) {
        for (NodeIndex i = 0; i < mesh.canopy_nodes; ++i)
            start_.push_back(state.node[i].x + Lanes{0.01, -0.02, 0.005 * (i % 7), 0.0});
    }

    Block block() const override { return Block::payload_tetrahedra; }
    void add_forces(State& state) const override {
        for (std::size_t i = 0; springs_ && i < start_.size(); ++i)
            state.force[i].value += stiffness_ * (start_[i] - state.node[i].x);
        for (NodeIndex i = 0; !springs_ && i < mesh_.payload(); ++i)
            state.aero[i].value += Lanes{0.03, 0.01 * (i % 5), 0.02, 0.0};
    }
    void add_row_sums(const State&, GershgorinSums& sums) const override {
        for (std::size_t i = 0; springs_ && i < start_.size(); ++i)
            sums.stiffness[i] += stiffness_;
    }
    double energy(const State& state) const override {
        double twice = 0.0;
        for (std::size_t i = 0; springs_ && i < start_.size(); ++i) {
            const Lanes d = start_[i] - state.node[i].x;
            twice += stiffness_ * sum3(d * d);
        }
        return 0.5 * twice;
    }

private:
    const Mesh& mesh_;
    const bool springs_;
    const double stiffness_ = 3.0;  // [N/m]
    std::vector<Lanes> start_;      // [m]
};

TEST(Layouts, ABlockWithoutARowActsByItsOwnLoop) {
    const Scene scene = read_scene(std::string(TWINCHUTE_SOURCE_DIR) + "/data/scenes/c9-inflation.toml",
                                   {"full.mesh.gore_rows=6"});
    Simulation simulation(scene);
    for (int step = 0; step < 300; ++step) {
        simulation.evaluate_forces();
        simulation.step_to(1e9);
    }
    const Mesh& mesh = simulation.mesh();
    const State& state = simulation.synchronised_state();
    auto structure = make_structure(scene, mesh, state.stage), loads = make_loads(scene, mesh, state.stage);
    structure.push_back(std::make_unique<BlockWithoutRow>(state, mesh, true));
    loads.insert(loads.begin(), std::make_unique<BlockWithoutRow>(state, mesh, false));
    const NodeConstants& constants = simulation.constants();
    const auto answer = [&](Layout& layout) {
        Answer a = answer_of(layout, state, constants, structure, loads);
        a.stable = {a.stable.all, a.stable.all, a.stable.all};  // such a block takes part in no subcycles
        return a;
    };
    const Answer reference = answer(*make_reference_layout(mesh, constants));
    const Answer without =
        answer_of(*make_reference_layout(mesh, constants), state, constants,
                  make_structure(scene, mesh, state.stage), make_loads(scene, mesh, state.stage));
    EXPECT_GT((reference.force[0] - without.force[0]).norm(), 0.01);  // it acts at all
    EXPECT_GT(reference.levels.elastic, without.levels.elastic);
    for (const auto& [name, layout] : layouts_of(scene, mesh, constants)) {
        SCOPED_TRACE(name);
        expect_same(reference, answer(*layout), stiffest_cable(scene));
    }
}

TEST(Layouts, AgreeOnAnUnevenMeshWhateverItsCounts) {
    // Elements are taken away one by one, so that none, some or all but one lane of the last group are
    // filled.
    const Scene scene = crane_drop({"full.mesh.gore_columns=1"});
    Simulation simulation(scene);
    for (int step = 0; step < 3'000; ++step) {
        simulation.evaluate_forces();
        simulation.step_to(1e9);
    }
    for (const Stage stage : {Stage::deployment, Stage::springs, Stage::ramp, Stage::flight}) {
        State state = simulation.synchronised_state();
        state.stage = stage;
        state.fe_weight = stage == Stage::ramp ? 0.3 : stage == Stage::flight ? 1.0 : 0.0;
        state.air.drag_area = 20.0;
        state.air.radial_pressure = 0.7;
        Mesh mesh = made_uneven(simulation.mesh());
        for (int fewer = 0; fewer < 17; ++fewer) {
            if (fewer > 0) {
                mesh.triangles.pop_back();
                mesh.cables.erase(std::ranges::find(mesh.cables, CableKind::line, &Cable::kind));
            }
            const NodeConstants constants = node_constants(mesh, scene.environment.gravity);
            compare_all(scene, mesh, constants, state, false);
            if (HasFailure()) return;
        }
    }
}

TEST(Layouts, ALoadThatIsNoNumberIsNotHidden) {
    // One node without a place, among elements that have one: vector maxima keep the number of a pair.
    Scene scene = crane_drop({});
    scene.parachutes.front().deploy.by = DeployBy::line_stretch;
    scene.release.speed = 25.0;
    const Simulation simulation(scene);
    const Mesh& mesh = simulation.mesh();
    const auto structure = make_structure(scene, mesh), loads = make_loads(scene, mesh);
    const auto line = std::ranges::find(mesh.cables, CableKind::line, &Cable::kind);
    auto layouts = layouts_of(scene, mesh, simulation.constants());
    layouts.push_back({"reference", make_reference_layout(mesh, simulation.constants())});
    for (const auto& [name, layout] : layouts)
        for (const NodeIndex lost : {mesh.triangles.front().node[0], (line + 1)->node[0]}) {
            SCOPED_TRACE(name);
            State state = simulation.synchronised_state();
            state.node[lost].x[1] = std::numeric_limits<double>::quiet_NaN();
            BlockClock clock;
            clock.begin(std::vector<std::string>(structure.size() + loads.size(), "any"));
            layout->begin(state, structure, loads);
            clock.begin_step(false);
            layout->evaluate(state, clock);
            const bool of_canopy = mesh.is_canopy(lost);
            EXPECT_EQ(std::isnan(state.largest.fabric_stress), of_canopy);
            EXPECT_TRUE(of_canopy || std::isnan(state.largest.line_tension));
        }
}

TEST(Layouts, SubcyclesOfLinesCountForTheLargestTension) {
    // The payload runs away at 10 m/s: lines are taut in the last subcycle of three as they were at no step.
    Scene scene = crane_drop({});
    scene.parachutes.front().deploy.by = DeployBy::line_stretch;
    scene.release.speed = 25.0;
    const Simulation simulation(scene);
    const auto structure = make_structure(scene, simulation.mesh()),
               loads = make_loads(scene, simulation.mesh());
    auto layouts = layouts_of(scene, simulation.mesh(), simulation.constants());
    layouts.push_back({"reference", make_reference_layout(simulation.mesh(), simulation.constants())});
    for (const auto& [name, layout] : layouts) {
        SCOPED_TRACE(name);
        State state = simulation.synchronised_state();
        for (NodeIndex i = simulation.constants().canopy_nodes; i < simulation.mesh().node_count(); ++i) {
            state.v_half[i].value[2] -= 10.0;
            state.node[i].v[2] -= 10.0;
        }
        BlockClock clock;
        clock.begin(std::vector<std::string>(structure.size() + loads.size(), "any"));
        layout->begin(state, structure, loads);
        clock.begin_step(false);
        layout->evaluate(state, clock);
        const double at_step = state.largest.line_tension;
        layout->advance(state, 3e-5, 3, state.added_mass);
        // By then the upper end of each line has lengthened by 10 m/s for 2e-5 s.
        const Cable& upper = *std::ranges::find(simulation.mesh().cables, CableKind::line, &Cable::kind);
        const double more = scene.parachutes.front().line.axial_stiffness() * 2e-4 / upper.rest_length;
        EXPECT_NEAR(state.largest.line_tension - at_step, more, 0.2 * more);
    }
}

TEST(Layouts, TheSameInputGivesTheSameBits) {
    const Scene packed = crane_drop({});
    Scene drawn_out = packed;
    drawn_out.parachutes.front().deploy.by = DeployBy::line_stretch;
    drawn_out.release.speed = 25.0;
    const auto end_of = [](const Scene& scene, const unstructured::Kernels& kernels) {
        Simulation simulation(scene, [&](const Scene& s, const Mesh& mesh, const NodeConstants& constants) {
            return make_unstructured_layout(s, mesh, constants, &kernels);
        });
        for (int step = 0; step < 300; ++step) {
            simulation.evaluate_forces();
            simulation.step_to(1e9);
        }
        return simulation.synchronised_state();
    };
    for (const Scene* scene : {&std::as_const(packed), &std::as_const(drawn_out)})
        for (const unstructured::Kernels& kernels : unstructured::all_kernels()) {
            SCOPED_TRACE(kernels.instruction_set);
            const State once = end_of(*scene, kernels), again = end_of(*scene, kernels);
            ASSERT_EQ(once.node.size(), again.node.size());
            for (std::size_t i = 0; i < once.node.size(); ++i)
                EXPECT_TRUE(to_vec3(once.node[i].x) == to_vec3(again.node[i].x) &&
                            to_vec3(once.node[i].v) == to_vec3(again.node[i].v));
            EXPECT_EQ(once.dt, again.dt);
        }
}

TEST(Layouts, AnyNumberOfThreadsGivesTheSameBits) {
    // From line stretch through the first filling, with subcycles, and a pack; four instruction sets' worth
    // of blocks of gores, on as many threads as there are, and more.
    // Without regard to gores four parts of the canopy, 8400 triangles.
    for (const bool packed : {false, true})
        for (const bool by_gores : {true, false}) {
            Scene scene = crane_drop({"full.mesh.gore_rows=30", "full.mesh.line_elements=31"});
            if (!by_gores) scene.full.mesh.gore_columns = 5;
            if (!packed) {
                scene.parachutes.front().deploy.by = DeployBy::line_stretch;
                scene.release.speed = 25.0;
            }
            std::vector<State> ends;
            for (const int threads : {1, 2, 3}) {
                Simulation simulation(
                    scene, [&](const Scene& s, const Mesh& mesh, const NodeConstants& constants) {
                        return by_gores
                                   ? make_gore_layout(s, mesh, constants, &all_gore_kernels().back(), threads)
                                   : make_unstructured_layout(s, mesh, constants, nullptr, threads);
                    });
                EXPECT_EQ(simulation.layout().threads(), threads);
                for (int step = 0; step < 250; ++step) {
                    simulation.evaluate_forces();
                    simulation.step_to(1e9);
                }
                ends.push_back(simulation.synchronised_state());
            }
            for (const State& end : ends) {
                EXPECT_EQ(end.time, ends.front().time);
                EXPECT_EQ(end.energy.damping, ends.front().energy.damping);
                EXPECT_EQ(end.air.projected_area, ends.front().air.projected_area);
                for (std::size_t i = 0; i < end.node.size(); ++i) {
                    ASSERT_EQ(to_vec3(end.node[i].x), to_vec3(ends.front().node[i].x)) << i;
                    ASSERT_EQ(to_vec3(end.node[i].v), to_vec3(ends.front().node[i].v)) << i;
                }
            }
        }
}

TEST(Layouts, AgreeInParts) {
    // 8400 triangles, which threads would share.
    const Scene scene = crane_drop({"full.mesh.gore_columns=5", "full.mesh.gore_rows=30",
                                    "parachute.deploy.by='line-stretch'", "release.speed='25 m/s'",
                                    "release.path_angle='90 deg'"});
    EXPECT_EQ(unstructured::Parts(Simulation(scene).mesh()).count(), 4U);
    compare_along(scene, is_sanitized ? 20 : 60);
}

TEST(Layouts, AnUnevenMeshIsNotSideBySide) {
    Scene scene = crane_drop({});
    Simulation simulation(scene);
    Mesh mesh = simulation.mesh();
    std::string why;
    ASSERT_TRUE(find_gores(mesh));
    mesh.triangles[40].a *= 1.0 + 1e-9;
    EXPECT_FALSE(find_gores(mesh, &why));
    EXPECT_NE(why.find("triangles differ"), std::string::npos) << why;
    EXPECT_FALSE(make_gore_layout(scene, mesh, simulation.constants()));
    EXPECT_EQ(make_layout(scene, mesh, simulation.constants())->name(), "unstructured");
    EXPECT_EQ(make_layout(scene, simulation.mesh(), simulation.constants())->name(), "gore-batched");
}

TEST(Layouts, GoresCoverTheMesh) {
    const Mesh mesh = Simulation(crane_drop({})).mesh();
    const Gores gores = find_gores(mesh).value();
    EXPECT_EQ(gores.triangles.size() * gores.count, mesh.triangles.size());
    EXPECT_EQ(gores.cables.size() * gores.count + gores.global_cables.size(), mesh.cables.size());
    EXPECT_EQ(gores.edges.size() * gores.count, fabric_edges(mesh).size());
    std::vector<NodeIndex> all = gores.node;
    all.insert(all.end(), gores.global.begin(), gores.global.end());
    std::ranges::sort(all);
    ASSERT_EQ(all.size(), mesh.position.size());
    for (std::size_t i = 0; i < all.size(); ++i)
        EXPECT_EQ(all[i], static_cast<NodeIndex>(i));
}

}  // namespace
}  // namespace twinchute::fullsim
