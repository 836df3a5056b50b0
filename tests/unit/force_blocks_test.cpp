// Each force block against its own definition. What all blocks promise is in tests/contract.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "fullsim/forces/membrane.hpp"
#include "fullsim/forces/registry.hpp"
#include "lib/models/cylinder_drag.hpp"
#include "tests/support/difference.hpp"
#include "tests/support/small_parachute.hpp"

namespace twinchute::fullsim {
namespace {

using test::clear_forces;
using test::coarse_c9;
using test::shake;
using test::state_of;
using test::stretch_open;
using test::total;

double power(const fullsim::NodeForces& forces, const State& state) {
    double sum = 0.0;
    for (std::size_t i = 0; i < forces.size(); ++i)
        sum += to_vec3(forces[i].value).dot(to_vec3(state.node[i].v));
    return sum;
}

// --- the membrane's law -------------------------------------------------------------------------

const MembraneLaw law = membrane_law({"fabric", 533.0, 4.3e8, 0.3, 1e-4}, 0.06);

TEST(MembraneLaw, IsZeroAtRestAndHookeanWhenTaut) {
    EXPECT_EQ(membrane_stress(law, {0.0, 0.0, 0.0}).xx, 0.0);
    // Equal biaxial strain e: E t e/(1 - nu) in every direction.
    const PlaneTensor n = membrane_stress(law, {0.01, 0.01, 0.0});
    EXPECT_NEAR(n.xx, 43000.0 * 0.01 / 0.7, 1e-9);
    EXPECT_NEAR(n.yy, n.xx, 1e-9);
    EXPECT_EQ(n.xy, 0.0);
}

TEST(MembraneLaw, WrinklesIntoUniaxialTension) {
    FabricState state;
    // Stretched along 30 degrees, shortened across: a tension field E t E_1 along that direction.
    const double c = std::cos(pi / 6), s = std::sin(pi / 6), first = 0.02, second = -0.1;
    const PlaneTensor e{first * c * c + second * s * s, first * s * s + second * c * c,
                        (first - second) * c * s};
    const PlaneTensor n = membrane_stress(law, e, &state);
    EXPECT_EQ(state, FabricState::wrinkled);
    EXPECT_NEAR(n.xx, 43000.0 * first * c * c, 1e-9);
    EXPECT_NEAR(n.yy, 43000.0 * first * s * s, 1e-9);
    EXPECT_NEAR(n.xy, 43000.0 * first * c * s, 1e-9);
    EXPECT_EQ(membrane_stress(law, {-0.1, -0.2, 0.02}, &state).xx, 0.0);
    EXPECT_EQ(state, FabricState::slack);
}

TEST(MembraneLaw, StressIsTheDerivativeOfEnergyInEveryState) {
    std::mt19937 generator(7);
    std::uniform_real_distribution<double> strain(-0.1, 0.1);
    int seen[3] = {0, 0, 0};
    for (int trial = 0; trial < 300; ++trial) {
        const PlaneTensor e{strain(generator), strain(generator), strain(generator)};
        FabricState state;
        const PlaneTensor n = membrane_stress(law, e, &state);
        ++seen[static_cast<int>(state)];
        const auto energy = [&](double xx, double yy, double xy) {
            return membrane_energy(law, {e.xx + xx, e.yy + yy, e.xy + xy});
        };
        const double h = 1e-6;  // truncation E t h^2 ~ 1e-7, round-off 200 eps/h ~ 1e-7
        EXPECT_NEAR(n.xx, test::central_difference([&](double d) { return energy(d, 0, 0); }, 0.0, h), 2e-3);
        EXPECT_NEAR(n.yy, test::central_difference([&](double d) { return energy(0, d, 0); }, 0.0, h), 2e-3);
        EXPECT_NEAR(2.0 * n.xy, test::central_difference([&](double d) { return energy(0, 0, d); }, 0.0, h),
                    2e-3);
    }
    for (const int count : seen)
        EXPECT_GT(count, 20);  // all three states were met
}

// --- cable and loads --------------------------------------------------------------------------------

TEST(Cable, IsHookeanInTensionAndNothingInCompression) {
    Mesh mesh;
    mesh.position = {Vec3(0, 0, 0), Vec3(0, 0, 1.02)};
    mesh.cords.fill({"cord", 462.0, 9.7e8, 4e-3});
    mesh.cables = {{{0, 1}, 1.0, 3.0, CableKind::line}};
    mesh.mass = {1.0, 1.0};
    const auto block = make_cable(mesh, 0.0);
    State state;
    state.node.assign(3, {splat(0.0), splat(0.0)});
    state.force.clear(3);
    state.node[1].x = Lanes{0, 0, 1.02, 0};
    block->add_forces(state);
    const double stiffness = 3.0 * 9.7e8 * 0.25 * pi * 16e-6;      // three strands
    EXPECT_NEAR(state.force[0].value[2], 0.02 * stiffness, 1e-3);  // the 1e-9 m of regularisation
    state.node[1].x = Lanes{0, 0, 0.98, 0};
    state.force.clear(3);
    block->add_forces(state);
    EXPECT_EQ(state.force[0].value[2], 0.0);
    EXPECT_EQ(block->energy(state), 0.0);
    // Packed to nothing there is no direction, and no 0/0 either.
    state.node[1].x = state.node[0].x;
    block->add_forces(state);
    EXPECT_EQ(state.force[0].value[2], 0.0);
}

TEST(CanopyPressure, GivesThePrescribedDragWhateverTheShape) {
    const Mesh mesh = coarse_c9(2, 5);
    const auto block = make_canopy_pressure(mesh, 0.05);
    for (const double opening : {1e-3, 0.5, 3.0, 7.0})
        for (const double phi : {0.0, 0.8})
            for (unsigned seed = 0; seed < 3; ++seed) {
                State state = state_of(mesh);
                stretch_open(state, opening, 1.0);
                shake(state, 0.02 * opening, seed);
                state.air.direction = Vec3(0.1, -0.2, 1.0).normalized();
                state.air.radial_pressure = phi;
                block->add_forces(state);
                const double drag = state.air.dynamic_pressure * state.air.drag_area;
                EXPECT_NEAR(total(state.aero).dot(state.air.direction), drag, 1e-11 * drag);
            }
}

TEST(CanopyPressure, IsCappedWhereTheCanopyIsATube) {
    const Mesh mesh = coarse_c9(2, 5);
    const auto block = make_canopy_pressure(mesh, 0.05);
    State state = state_of(mesh);
    stretch_open(state, 1e-3, 1.0);
    block->add_forces(state);
    EXPECT_TRUE(state.air.pressure_capped);
    EXPECT_DOUBLE_EQ(state.air.pressure, 3.0 * state.air.dynamic_pressure);
    State open = state_of(mesh);
    stretch_open(open, 5.0, 1.0);
    block->add_forces(open);
    EXPECT_FALSE(open.air.pressure_capped);
    EXPECT_NEAR(open.air.pressure * open.air.projected_area, open.air.dynamic_pressure * open.air.drag_area,
                1e-9);
}

TEST(CanopyPressure, WithFullRadialPressureIsThePressureOnEveryFacingElement) {
    // phi = 1 and all elements facing the wind: p A on each, whose sum is p times the vector area,
    // and the vector area of a sheet depends on its border alone.
    const Mesh mesh = coarse_c9(2, 4);
    const auto block = make_canopy_pressure(mesh, 0.05);
    State state = state_of(mesh);
    stretch_open(state, 4.0, 1.0);
    state.air.radial_pressure = 1.0;
    block->add_forces(state);
    ASSERT_NEAR(state.air.signed_area, state.air.projected_area, 1e-12);
    Vec3 expected = Vec3::Zero();
    for (const auto& [seams, sign] :
         {std::pair{mesh.seam_rings.front(), -0.5}, std::pair{mesh.seam_rings.back(), 0.5}}) {
        const int first = seams[0], ring = 28 * (seams[1] - seams[0]);
        for (int i = 0; i < ring; ++i)
            expected +=
                sign * to_vec3(state.node[first + i].x).cross(to_vec3(state.node[first + (i + 1) % ring].x));
    }
    EXPECT_LT((total(state.aero) - state.air.pressure * expected).norm(), 1e-9 * total(state.aero).norm());
}

TEST(LineDrag, IsThatOfACylinderAcrossTheWind) {
    // The whole rig moves sideways: every line element is a cylinder of 4 mm across (almost) all of
    // the wind, so the sum is 1/2 rho d L C_d V^2 with L the length of all lines and the sine of
    // their inclination squared left out, which the expected value puts back.
    const Mesh mesh = coarse_c9(1, 2);
    const auto block = make_line_drag(mesh);
    const Vec3 velocity(15.0, 0.0, 0.0);
    State state = state_of(mesh, velocity);
    block->add_forces(state);
    Vec3 expected = Vec3::Zero();
    for (const Cable& c : mesh.cables) {
        if (c.kind != CableKind::line) continue;
        const Vec3 d = mesh.position[c.node[1]] - mesh.position[c.node[0]];
        const Vec3 across = -velocity + velocity.dot(d.normalized()) * d.normalized();
        const double cd = cylinder_drag_coefficient(1.225 * 4e-3 * across.norm() / 1.79e-5);
        expected += 0.5 * 1.225 * 4e-3 * d.norm() * cd * across.norm() * across;
    }
    EXPECT_LT((total(state.aero) - expected).norm(), 2e-3 * expected.norm());  // the table's tolerance
    EXPECT_LT(expected.x(), -10.0);
}

TEST(LineDrag, VanishesAlongTheLines) {
    Mesh mesh;
    mesh.position = {Vec3(0, 0, 0), Vec3(0, 0, 1)};
    mesh.cords.fill({"cord", 462.0, 9.7e8, 4e-3});
    mesh.cables = {{{0, 1}, 1.0, 1.0, CableKind::line}};
    const auto block = make_line_drag(mesh);
    State state;
    state.node.assign(3, {splat(0.0), splat(0.0)});  // the last one pads
    state.node[0].v = state.node[1].v = Lanes{0, 0, -20, 0};
    state.node[1].x = Lanes{0, 0, 1, 0};
    state.aero.clear(3);
    state.air.density = 1.225;
    state.air.viscosity = 1.79e-5;
    block->add_forces(state);
    EXPECT_LT(total(state.aero).norm(), 1e-12);
}

TEST(BreathingDamping, HasNoNetForceAndDissipates) {
    const Mesh mesh = coarse_c9();
    const auto block = make_breathing_damping(mesh, 0.5);
    State state = state_of(mesh, Vec3(0, 0, -20));
    block->add_forces(state);
    EXPECT_LT(total(state.force).norm(), 1e-10);  // all move alike: no force at all
    EXPECT_NEAR(state.damping_power, 0.0, 1e-20);
    shake(state, 0.5, 1);
    update_sums(state, node_constants(mesh, 0.0));
    clear_forces(state);
    block->add_forces(state);
    EXPECT_LT(total(state.force).norm(), 1e-10);
    EXPECT_GT(state.damping_power, 0.0);
    EXPECT_NEAR(power(state.force, state), -state.damping_power, 1e-9 * state.damping_power);
}

TEST(MassDamping, LeavesTheFallAlone) {
    const Mesh mesh = coarse_c9();
    const auto block = make_mass_damping(mesh, 2.0);
    State state = state_of(mesh, Vec3(3, 0, -20));
    block->add_forces(state);
    EXPECT_LT(total(state.force).norm(), 1e-9);
    shake(state, 0.5, 1);
    update_sums(state, node_constants(mesh, 0.0));
    clear_forces(state);
    block->add_forces(state);
    EXPECT_LT(total(state.force).norm(), 1e-9 * 152.4);
    EXPECT_NEAR(power(state.force, state), -state.damping_power, 1e-9 * state.damping_power);
    // f_i = -alpha m_i (v_i - v_mean), on one node by hand.
    const Vec3 relative = to_vec3(state.node[5].v) - state.sums.system_velocity;
    EXPECT_LT((to_vec3(state.force[5].value) + 2.0 * mesh.mass[5] * relative).norm(), 1e-12);
}

TEST(PayloadDrag, OpposesTheMotion) {
    const Mesh mesh = coarse_c9();
    const auto block = make_payload_drag(mesh, 0.4);
    State state = state_of(mesh, Vec3(6, 0, -8));
    block->add_forces(state);
    const Vec3 expected = -0.5 * 1.225 * 0.4 * 10.0 * Vec3(6, 0, -8);
    EXPECT_LT((to_vec3(state.aero[mesh.payload()].value) - expected).norm(), 1e-12);
    EXPECT_LT((total(state.aero) - expected).norm(), 1e-12);
}

TEST(Registry, BuildsOnlyWhatTheSceneHas) {
    Scene scene = test::c9_scene();
    const Mesh mesh = coarse_c9();
    EXPECT_EQ(make_structure(scene, mesh).size(), 3u);
    EXPECT_EQ(make_loads(scene, mesh).size(), 3u);  // pressure, line drag, breathing
    scene.aerodynamics.line_drag.reset();
    scene.aerodynamics.breathing_damping.reset();
    EXPECT_EQ(make_loads(scene, mesh).size(), 1u);
    scene.payload.drag_area = 0.4;
    scene.full.alpha = 1.0;
    EXPECT_EQ(make_loads(scene, mesh).size(), 3u);
}

}  // namespace
}  // namespace twinchute::fullsim
