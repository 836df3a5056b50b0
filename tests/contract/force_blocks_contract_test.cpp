// Every row of the table of force blocks against what it promises.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cctype>
#include <cmath>

#include "fullsim/forces/registry.hpp"
#include "tests/support/difference.hpp"
#include "tests/support/small_parachute.hpp"

namespace twinchute::fullsim {
namespace {

using test::clear_forces;
using test::shake;
using test::state_of;
using test::stretch_open;
using test::total;

/// A scene that needs every block that goes with this way of deploying, in one stage of its run or another.
Scene full_scene(DeployBy by, Contact contact = Contact::gores) {
    Scene scene = test::c9_scene();
    Deployment& deploy = scene.parachutes.front().deploy;
    deploy.by = by;
    deploy.static_line_length = 2.0;
    deploy.extraction = {"", {0.0, 1.0}, {100.0, 100.0}, 1.0};
    deploy.drag_coefficient = 0.1;
    deploy.compressive_stiffness_ratio = 1e-5;
    deploy.deployment_resistance = 2.0;
    scene.payload.drag_area = 0.4;
    scene.payload.body = PayloadBody{PayloadBody::Shape::box, {0.6, 0.4, 0.9}, {}, Elasticity{1e5, 0.3}};
    scene.full.alpha = 2.0;
    scene.full.contact = contact;
    scene.full.contact_friction = 0.2;
    scene.aerodynamics.added_mass->momentum = AddedMassMomentum::accreting;
    return scene;
}

constexpr DeployBy all_deployments[] = {DeployBy::static_line, DeployBy::extraction};
constexpr Stage all_stages[] = {Stage::deployment, Stage::springs, Stage::ramp, Stage::flight};

/// The first of these scenes in which a block takes part.
Scene scene_with(const ForceBlock& row) {
    for (const Contact contact : {Contact::gores, Contact::self})
        for (const DeployBy by : all_deployments)
            for (const Stage stage : all_stages)
                if (const Scene scene = full_scene(by, contact); row.needed(scene, stage)) return scene;
    ADD_FAILURE() << row.name << " is never needed";
    return full_scene(DeployBy::static_line);
}

Mesh mesh_with_static_line() {
    Mesh mesh = test::coarse_c9();
    test::add_body(mesh);
    test::add_static_line(mesh);
    return mesh;
}

double power(const fullsim::NodeForces& forces, const State& state) {
    double sum = 0.0;
    for (std::size_t i = 0; i < forces.size(); ++i)
        sum += to_vec3(forces[i].value).dot(to_vec3(state.node[i].v));
    return sum;
}

double largest_force(const State& state) {
    double largest = 0.0;
    for (std::size_t i = 0; i < state.force.size(); ++i)
        largest = std::max(largest, to_vec3(state.force[i].value + state.aero[i].value).norm());
    return largest;
}

class EveryBlock : public testing::TestWithParam<std::size_t> {
protected:
    const ForceBlock& row() const { return force_blocks()[GetParam()]; }

    /// An opened, shaken parachute: elements in every state, every node with its own velocity.
    State lively(unsigned seed) const {
        State state = state_of(mesh_, Vec3(1.0, 2.0, -20.0));
        if (row().block == Block::self_contact) {  // of folds, which begin without a force
            block_->add_forces(state);
            clear_forces(state);
        } else {
            stretch_open(state, 3.0, 1.01);
        }
        shake(state, 0.05, seed);
        state.added_mass = 40.0;
        state.added_mass_rate = 30.0;
        state.air.radial_pressure = 0.8;
        state.air.extraction = Vec3(0.0, 30.0, 100.0);
        update_sums(state, node_constants(mesh_, 0.0));
        return state;
    }

    Scene scene_ = scene_with(row());
    Mesh mesh_ = mesh_with_static_line();
    std::unique_ptr<const ForceModel> block_ = row().make(scene_, mesh_);
};

TEST_P(EveryBlock, IsNeededInSomeStageAndNamedAsItsRow) {
    EXPECT_TRUE(std::ranges::any_of(all_stages, [&](Stage s) { return row().needed(scene_, s); }));
    EXPECT_EQ(block_->name(), row().name);
    EXPECT_FALSE(row().source.empty());
}

TEST_P(EveryBlock, ActsAndStaysFinite) {
    State state = lively(1);
    block_->add_forces(state);
    EXPECT_GT(largest_force(state), 1e-6);
    EXPECT_TRUE(std::isfinite(largest_force(state)));
    EXPECT_EQ(to_vec3(state.force[mesh_.dummy()].value + state.aero[mesh_.dummy()].value).norm(),
              0.0);  // the padding node
}

TEST_P(EveryBlock, IsZeroAtRestWhereItSaysSo) {
    if (!row().zero_at_rest) return;
    // Pleated all the way up; the one element a gore of a graded vent is folded.
    Mesh mesh = test::coarse_c9(2, 3, 0.0, Grading::uniform);
    test::add_body(mesh);
    test::add_static_line(mesh);
    const auto block = row().make(scene_, mesh);
    State state = state_of(mesh);
    state.air.airspeed = state.air.dynamic_pressure = 0.0;
    block->add_forces(state);
    // Unstrained to round-off: E A times 1e-15, plus the cables' regularising nanometre (1e-5 N).
    EXPECT_LT(largest_force(state), 1e-3);
    EXPECT_LT(std::abs(state.damping_power), 1e-9);
    EXPECT_LT(block->energy(state), 1e-9);
}

TEST_P(EveryBlock, HasNoNetForceWhereItSaysSo) {
    if (!row().without_net_force) return;
    State state = lively(2);
    block_->add_forces(state);
    EXPECT_LT(total(state.force).norm(), 1e-11 * largest_force(state) * mesh_.node_count());
    EXPECT_EQ(total(state.aero).norm(), 0.0);
    if (!row().structural) return;
    Vec3 moment = Vec3::Zero();
    for (std::size_t i = 0; i < state.force.size(); ++i)
        moment += to_vec3(state.node[i].x).cross(to_vec3(state.force[i].value));
    EXPECT_LT(moment.norm(), 1e-10 * largest_force(state) * mesh_.node_count());
}

TEST_P(EveryBlock, BooksWhatItDissipates) {
    for (unsigned seed = 0; seed < 10; ++seed) {
        State state = lively(seed);
        block_->add_forces(state);
        if (!row().dissipates) {
            EXPECT_EQ(state.damping_power, 0.0);
            continue;
        }
        EXPECT_GE(state.damping_power, 0.0);
        if (row().structural) {
            // The elastic part of the power is what a block without viscosity has.
            Scene inviscid = scene_;
            inviscid.full.bulk_viscosity = inviscid.full.contact_friction = 0.0;
            State elastic = lively(seed);
            row().make(inviscid, mesh_)->add_forces(elastic);
            const double lost = power(elastic.force, elastic) - power(state.force, state);
            EXPECT_NEAR(state.damping_power, lost, 1e-9 * (std::abs(power(elastic.force, elastic)) + 1.0));
        } else {
            EXPECT_NEAR(power(state.force, state), -state.damping_power, 1e-9 * state.damping_power);
        }
    }
}

TEST_P(EveryBlock, TurnsWithTheWorld) {
    if (row().fixed_in_space) return;
    // Rotate positions, velocities and the air's direction: forces rotate along, to the digits that
    // coordinates of 300 m leave. Structural blocks do not see an added spin either.
    State state = lively(9);
    block_->add_forces(state);
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    const Vec3 spin = row().structural ? Vec3(0.3, -2.0, 5.0) : Vec3::Zero();
    State turned = lively(9);
    for (auto& node : turned.node) {
        const Vec3 x = turn * to_vec3(node.x);
        node.v = to_lanes(turn * to_vec3(node.v) + spin.cross(x));
        node.x = to_lanes(x + Vec3(10, 20, 300));
    }
    turned.air.direction = turn * state.air.direction;
    update_sums(turned, node_constants(mesh_, 0.0));
    block_->add_forces(turned);
    double worst = 0.0;
    for (std::size_t i = 0; i < state.force.size(); ++i) {
        const Vec3 before = to_vec3(state.force[i].value + state.aero[i].value);
        worst =
            std::max(worst, (to_vec3(turned.force[i].value + turned.aero[i].value) - turn * before).norm());
    }
    EXPECT_LT(worst, 1e-8 * largest_force(state));
    EXPECT_NEAR(turned.damping_power, state.damping_power, 1e-8 * std::abs(state.damping_power));
}

TEST_P(EveryBlock, AddsToWhatIsThere) {
    State once = lively(4), twice = lively(4);
    block_->add_forces(once);
    block_->add_forces(twice);
    block_->add_forces(twice);
    for (std::size_t i = 0; i < once.force.size(); i += 7) {
        const Vec3 one = to_vec3(once.force[i].value + once.aero[i].value);
        EXPECT_LT((to_vec3(twice.force[i].value + twice.aero[i].value) - 2.0 * one).norm(),
                  1e-9 * (1.0 + one.norm()));
    }
}

TEST_P(EveryBlock, GivesTheSameBitsTwice) {
    State first = lively(5), second = lively(5);
    block_->add_forces(first);
    block_->add_forces(second);
    for (std::size_t i = 0; i < first.force.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            EXPECT_EQ(first.force[i].value[c], second.force[i].value[c]);
            EXPECT_EQ(first.aero[i].value[c], second.aero[i].value[c]);
        }
}

TEST_P(EveryBlock, ForceIsMinusTheDerivativeOfItsEnergyAndTheTangentIsSymmetric) {
    if (!row().structural) return;
    scene_.full.bulk_viscosity = scene_.full.contact_friction = 0.0;
    block_ = row().make(scene_, mesh_);
    State state = lively(3);
    block_->add_forces(state);
    std::mt19937 generator(11);
    const bool solid = row().name == "payload tetrahedra";
    // Of many pairs some are about to touch: there a difference is off by k h of a penalty of 1.5e4 N/m.
    const double kink = row().block == Block::self_contact ? 0.02 : 0.0;
    const auto random_node = [&] {
        const std::size_t first = solid ? static_cast<std::size_t>(mesh_.first_attachment()) : 0;
        const std::size_t count =
            solid ? mesh_.attachments.size() : static_cast<std::size_t>(mesh_.node_count());
        return first + static_cast<std::size_t>(generator()) % count;
    };
    for (int trial = 0; trial < 60; ++trial) {
        const std::size_t i = random_node();
        const int c = static_cast<int>(generator() % 3);
        const double x0 = state.node[i].x[c];
        const double slope = test::central_difference(
            [&](double x) {
                state.node[i].x[c] = x;
                return block_->energy(state);
            },
            x0, 1e-6);
        state.node[i].x[c] = x0;
        EXPECT_NEAR(state.force[i].value[c], -slope, 1e-4 * (1.0 + std::abs(slope)) + kink) << "node " << i;
    }
    // dF_i/dx_j = dF_j/dx_i for the corners of elements; the state is away from any kink of slack.
    const auto derivative = [&](std::size_t i, int ci, std::size_t j, int cj) {
        return test::central_difference(
            [&](double x) {
                State moved = state;
                clear_forces(moved);
                moved.node[j].x[cj] = x;
                block_->add_forces(moved);
                return moved.force[i].value[ci];
            },
            state.node[j].x[cj], 1e-7);
    };
    for (int trial = 0; trial < 30; ++trial) {
        const std::size_t e = static_cast<std::size_t>(generator());
        const bool sheet = row().name == "membrane" || row().name == "fabric springs";
        const auto corner = [&](std::size_t c) {
            const auto& tetrahedra = mesh_.body->solid.tetrahedron;
            if (solid) return mesh_.first_attachment() + tetrahedra[e % tetrahedra.size()][c];
            return sheet ? mesh_.triangles[e % mesh_.triangles.size()].node[c]
                         : mesh_.cables[e % mesh_.cables.size()].node[c];
        };
        const NodeIndex a = corner(0), b = corner(1);
        const int ca = static_cast<int>(generator() % 3), cb = static_cast<int>(generator() % 3);
        const double ab = derivative(a, ca, b, cb), ba = derivative(b, cb, a, ca);
        // Differences over 2e-7 m of forces that carry 1e-16 of themselves in round-off.
        EXPECT_NEAR(ab, ba, 1e-3 * (1.0 + std::abs(ab)) + 2e-9 * largest_force(state));
    }
}

INSTANTIATE_TEST_SUITE_P(Rows, EveryBlock, testing::Range(std::size_t{0}, force_blocks().size()),
                         [](const auto& row) {
                             std::string name(force_blocks()[row.param].name);
                             std::ranges::replace_if(
                                 name, [](char c) { return !std::isalnum(c); }, '_');
                             return name;
                         });

TEST(Registry, EveryStageHasItsOwnBlocks) {
    const auto names = [](const Scene& scene, Stage stage) {
        const Mesh mesh = mesh_with_static_line();
        std::vector<std::string> all;
        for (const ForceModels& models : {make_structure(scene, mesh, stage), make_loads(scene, mesh, stage)})
            for (const auto& model : models)
                all.emplace_back(model->name());
        return all;
    };
    using Names = std::vector<std::string>;
    const Scene scene = full_scene(DeployBy::static_line);
    EXPECT_EQ(names(scene, Stage::deployment),
              (Names{"fabric springs", "tapes", "lines", "static line", "payload tetrahedra", "fabric drag",
                     "deployment resistance", "line drag", "payload drag"}));
    EXPECT_EQ(
        names(scene, Stage::springs),
        (Names{"fabric springs", "tapes", "lines", "gore contact", "payload tetrahedra", "canopy pressure",
               "line drag", "breathing damping", "payload drag", "accretion", "mass damping"}));
    EXPECT_EQ(names(scene, Stage::flight),
              (Names{"membrane", "tapes", "lines", "gore contact", "payload tetrahedra", "canopy pressure",
                     "line drag", "breathing damping", "payload drag", "accretion", "mass damping"}));
    EXPECT_EQ(names(scene, Stage::ramp).size(), 12u);  // membrane beside springs
    Scene elements = full_scene(DeployBy::extraction);
    elements.full.structure = Structure::fe;
    elements.full.alpha_from_release = true;
    EXPECT_EQ(names(elements, Stage::deployment),
              (Names{"membrane", "tapes", "lines", "payload tetrahedra", "fabric drag",
                     "deployment resistance", "extraction", "line drag", "payload drag", "mass damping"}));
}

}  // namespace
}  // namespace twinchute::fullsim
