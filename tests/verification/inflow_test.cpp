// Filling that the full model predicts: the balance of the air in its mesh, and runs.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "fullsim/forces/inflow.hpp"
#include "fullsim/simulation.hpp"
#include "lib/scene/needs.hpp"
#include "lib/solve/opening.hpp"
#include "tests/support/c9_scene.hpp"
#include "tests/support/canopy_of_type.hpp"
#include "tests/support/predicted.hpp"
#include "tests/support/runs.hpp"

namespace twinchute::fullsim {
namespace {

using test::predicted, test::run_full;

// --- the balance -----------------------------------------------------------------------------

/// An open C-9 with its axis up, in air that comes from below.
class Inflow : public testing::Test {
protected:
    explicit Inflow(const Scene& scene = test::c9_scene())
        : scene_(predicted(scene)),
          start_(make_start(scene)),
          simulation_(start_),
          balance_(InflowBalance::of(scene_, simulation_.mesh())) {
        simulation_.evaluate_forces();
        state_ = simulation_.synchronised_state();
        state_.inflow.steady_drag_area = 42.56;
    }
    /// Its shape is that of a canopy which starts open.
    static Scene make_start(Scene scene) {
        scene.parachutes.front().deploy.by = DeployBy::inflated;
        scene.release.speed = 20.0;
        return scene;
    }
    /// Solves the balance for these nodes. Returns the force of pressure and residual drag [N].
    Vec3 solve(State& state) const {
        const Mesh& mesh = simulation_.mesh();
        ElementSums sums;
        Vec3 all = Vec3::Zero();
        for (const Triangle& t : mesh.triangles) {
            const auto x = [&](int c) { return to_vec3(state.node[t.node[c]].x); };
            const Vec3 area = 0.5 * (x(1) - x(0)).cross(x(2) - x(0));
            for (const NodeIndex i : t.node)
                sums.swept += area.dot(to_vec3(state.node[i].v)) / 3.0;
            all += area;
        }
        sums.area = {all.x(), all.y(), all.z()};
        sums.positive_area = all.z();
        const Vec3 residual = balance_->set_pressure(state, sums, openings(state));
        return state.air.pressure * all + residual;
    }
    Openings openings(const State& state) const {
        return balance_->openings([&](std::size_t k) { return state.node[balance_->edges()[k]]; });
    }
    /// All nodes move with the payload, but for what `rate` [m/s] adds at a place from the mouth [m].
    template <class Rate>
    void set_velocities(State& state, Rate&& rate) const {
        Vec3 mouth = Vec3::Zero();
        const std::vector<NodeIndex>& skirt = simulation_.mesh().seam_rings.back();  // evenly around it
        for (const NodeIndex i : skirt)
            mouth += to_vec3(state.node[i].x) / static_cast<double>(skirt.size());
        for (NodeIndex i = 0; i < simulation_.mesh().node_count(); ++i)
            state.node[i].v = to_lanes(Vec3(0.0, 0.0, -20.0) + rate(to_vec3(state.node[i].x) - mouth));
        update_sums(state, simulation_.constants());
    }
    static Vec3 nothing(const Vec3&) { return Vec3::Zero(); }

    Scene scene_, start_;
    Simulation simulation_;
    std::optional<InflowBalance> balance_;
    State state_;
};

TEST_F(Inflow, VolumeGrowsByWhatTheFabricSweeps) {
    // A canopy that grows evenly about its mouth, x = r k: V'/V = 3 k, whatever its shape. The mouth of this
    // mesh is plane, so that its cap sweeps nothing.
    const NodeConstants constants = simulation_.constants();
    static constexpr double k = 0.3;
    set_velocities(state_, [](const Vec3& place) { return Vec3(k * place); });
    balance_->measure(state_, constants);
    solve(state_);
    // The vent's cap moves as well; it is what the balance leaves out, 1 % of the mouth's area here.
    EXPECT_NEAR(state_.inflow.swept, 3.0 * k * state_.inflow.volume, 0.015 * 3.0 * k * state_.inflow.volume);
    // Between a cone and half an ellipsoid on the projected area, as deep as the canopy: 0.4 of its width.
    const double area = state_.air.signed_area, depth = 0.4 * std::sqrt(4.0 * area / pi);
    EXPECT_GT(state_.inflow.volume, area * depth / 3.0);
    EXPECT_LT(state_.inflow.volume, area * depth * 2.0 / 3.0);
}

TEST_F(Inflow, OfACanopyThatKeepsItsVolumeIsItsLeak) {
    set_velocities(state_, nothing);
    balance_->measure(state_, simulation_.constants());
    state_.dt = 0.0;
    solve(state_);
    const InflowState& in = state_.inflow;
    EXPECT_NEAR(in.swept, 0.0, 1e-9);
    EXPECT_GT(in.leak, 0.0);
    // Bisection to 1e-14 of s.
    EXPECT_NEAR(in.mouth * 20.0 * in.ratio, in.leak, 1e-11 * in.mouth * 20.0);
    EXPECT_GT(state_.air.pressure, 0.0);
    // Where all else holds the fabric against it, nothing is displaced and the air around does nothing.
    EXPECT_NEAR(in.displaced, 0.0, 1e-9);
    state_.inflow.other_pull = -in.mobility * in.inside;
    solve(state_);
    EXPECT_NEAR(state_.air.pressure, in.inside, 1e-9 * in.inside);
}

TEST_F(Inflow, GivesTheOpenCanopyItsSteadyDragArea) {
    // Whatever area it settles at: pressure times area is q (C_D S)_0 by construction of the suction. One
    // that has not been full yet, and is as small as the first two, has less.
    for (const double factor : {0.75, 0.85, 1.0, 1.1, 1.3}) {
        State state = state_;
        const Vec3 middle = to_vec3(state.node[simulation_.mesh().payload()].x);
        const double growth = std::sqrt(factor * balance_->full_area() / state.air.signed_area);
        for (NodeIndex i = 0; i < simulation_.mesh().canopy_nodes; ++i)
            for (int c = 0; c < 2; ++c)
                state.node[i].x[c] = middle[c] + growth * (state.node[i].x[c] - middle[c]);
        set_velocities(state, nothing);
        balance_->measure(state, simulation_.constants());
        state.inflow.volume = 1e3;  // all of the fabric leaks
        state.dt = 0.0;
        state.air.dynamic_pressure = 0.5 * state.air.density * 400.0;
        state.inflow.has_been_full = true;
        solve(state);
        ASSERT_NEAR(state.air.signed_area, factor * balance_->full_area(), 1e-9 * balance_->full_area())
            << factor;
        // The mouth is larger than the projected area by that of the vent, 2 % and more: the inflow s that
        // the leak takes is slower by as much, K s^2 by twice that. K s^2 is 1.2 % of q (s = 0.08), of 1.8 q,
        // and goes with the square of pressure over area.
        const double growing = std::max(1.0, std::pow(factor, -3.0));
        EXPECT_NEAR(state.air.drag_area, 42.56, growing * 0.05 * 0.012 / 1.8 * 2.0 * 42.56) << factor;
        state.inflow.has_been_full = false;
        solve(state);
        if (factor < 0.9) {
            EXPECT_LT(state.air.drag_area, 0.95 * 42.56) << factor;
        }
    }
}

TEST_F(Inflow, TakesNoPowerFromNowhere) {
    // Still air can only lose what the canopy gains: dp [A_m w (1 - s) + leak] >= 0 for any rate of growth.
    for (const double k : {-3.0, -0.5, 0.0, 0.5, 2.0, 10.0, 100.0}) {
        State state = state_;
        set_velocities(state, [&](const Vec3& place) { return Vec3(k * place); });
        balance_->measure(state, simulation_.constants());
        state.dt = 1e-4;
        solve(state);
        const InflowState& in = state.inflow;
        const double speed = 20.0;
        EXPECT_GE(in.inside * (in.mouth * speed * (1.0 - in.ratio) + in.leak), 0.0) << k;
        EXPECT_LE(in.ratio, 1.0) << k;
        EXPECT_GE(in.inside, 0.0) << k;
    }
}

TEST_F(Inflow, ForceIsAlongTheAirWhateverTheShape) {
    // A canopy sheared to one side: what its pressure does across the air would carry it like a wing that has
    // lift and no drag. Rounding of sums over hundreds of triangles, of the whole force.
    for (NodeIndex i = 0; i < simulation_.mesh().canopy_nodes; ++i)
        if (state_.node[i].x[0] > 0.0) state_.node[i].x[0] *= 0.3;
    state_.air.direction = Vec3(0.3, 0.0, 1.0).normalized();
    set_velocities(state_, nothing);
    balance_->measure(state_, simulation_.constants());
    const Vec3 force = solve(state_);
    EXPECT_GT(force.norm(), 1000.0);
    EXPECT_LT(force.cross(state_.air.direction).norm(), 1e-12 * force.norm());
    EXPECT_NEAR(force.dot(state_.air.direction), state_.air.drag_area * state_.air.dynamic_pressure,
                1e-12 * force.norm());
}

TEST_F(Inflow, ACanopyThatHasTurnedOverHoldsNothing) {
    // Its mouth faces away from the air, which comes from above at 20 m/s: no pressure, no drag, and above
    // all no thrust.
    State turned = state_;
    turned.air.direction = -turned.air.direction;
    turned.air.wind = Vec3(0.0, 0.0, -40.0);
    turned.inflow.steady_drag_area = 42.56;
    EXPECT_EQ(solve(turned), Vec3::Zero());
    EXPECT_LT(turned.air.signed_area, 0.0);
    EXPECT_EQ(turned.air.pressure, 0.0);
    EXPECT_EQ(turned.air.drag_area, 0.0);
    EXPECT_GT(solve(state_).norm(), 100.0);
}

TEST_F(Inflow, FoldedFabricFillsWhicheverWayALittleOfItFaces) {
    // Air nearly across the axis of the canopy meets as much of its inside as of its outside; 60 deg further
    // it has turned over.
    for (const auto& [sine, fills] : {std::pair{0.002, true}, {0.87, false}}) {
        State folded = state_;
        folded.air.direction = Vec3(std::sqrt(1.0 - sine * sine), 0.0, -sine);
        folded.air.wind = 20.0 * folded.air.direction;
        folded.inflow.steady_drag_area = 42.56;
        set_velocities(folded, nothing);
        solve(folded);
        EXPECT_LT(folded.air.signed_area, 0.0) << sine;
        EXPECT_EQ(folded.air.pressure > 0.0, fills) << sine;
        EXPECT_EQ(folded.air.drag_area, 0.0) << sine;
    }
}

TEST(InflowFromThePack, Fills) {
    // Fabric that leaves its pack faces the air either way, for as long as a small mouth takes to fill it.
    // docs/theory/filling.md: full within 1.9 to 2.0 and 1.4 to 1.6 s.
    for (const auto& [mouth, time] : {std::pair{0.01, 1.95}, {0.02, 1.5}}) {
        const RunRecord record = test::run_full(
            read_scene(TWINCHUTE_SOURCE_DIR "/data/scenes/paper/crane-drop.toml",
                       {fmt::format("parachute.filling={{model='predicted',initial_mouth={}}}", mouth),
                        "stop.at='full-open'"}));
        ASSERT_NE(record.find_event("full-open"), nullptr) << record.status.detail;
        EXPECT_NEAR(record.find_event("full-open")->time - record.find_event("snatch")->time, time, 0.3);
    }
}

TEST_F(Inflow, PressureFallsAsTheCanopyGrowsFaster) {
    double before = HUGE_VAL;
    for (const double k : {-1.0, 0.0, 0.2, 0.5, 1.0, 2.0, 4.0}) {
        State state = state_;
        set_velocities(state, [&](const Vec3& place) { return Vec3(k * place); });
        balance_->measure(state, simulation_.constants());
        state.dt = 0.0;
        solve(state);
        EXPECT_LE(state.inflow.inside, before) << k;
        before = state.inflow.inside;
    }
}

TEST_F(Inflow, AirAroundIsHalfAPulsatingSphere) {
    // Rayleigh: p = rho (R R'' + 3/2 R'^2) outside a sphere of the radius R, whose half displaces
    // Q = 2 pi R^2 R' and Q' = 2 pi (R^2 R'' + 2 R R'^2). By its volume, R^3 is as V to the open canopy's.
    for (const double k : {-0.6, 0.2, 1.5}) {
        State state = state_;
        set_velocities(state, [&](const Vec3& place) { return Vec3(k * place); });
        balance_->measure(state, simulation_.constants());
        state.dt = 0.0;  // the rate below stays
        InflowState& in = state.inflow;
        in.other_pull = 70.0;
        solve(state);
        const double full_volume = filling_canopy(scene_.parachutes.front())
                                       .family()
                                       .at(filling_canopy(scene_.parachutes.front()).steady_radius())
                                       .volume *
                                   std::pow(scene_.parachutes.front().nominal_diameter, 3);
        const double R = std::sqrt(balance_->full_area() / pi) * std::cbrt(in.volume / full_volume);
        // The canopy moves about its mouth here and the air around sees its mean at rest: other Q, same V'.
        const double dR = R * in.swept / (3.0 * in.volume), Q = in.displaced;
        const double dQ = in.mobility * state.air.pressure + in.other_pull;
        const double I = state.air.density / (2.0 * pi * R), dI = -I * dR / R;
        EXPECT_NEAR(in.inside - state.air.pressure, I * dQ + 0.5 * dI * Q, 1e-10 * (1.0 + in.inside)) << k;
        // Of a half sphere itself both terms are Rayleigh's.
        const double ddR = 11.0, rate = 2.0 * pi * R * R * dR;
        const double growth = 2.0 * pi * (R * R * ddR + 2.0 * R * dR * dR);
        EXPECT_NEAR(I * growth + 0.5 * dI * rate, state.air.density * (R * ddR + 1.5 * dR * dR), 1e-9) << k;
    }
}

TEST_F(Inflow, AirAroundAppliesNoNetForce) {
    // It resists growth alone: whatever it does, the drag is that of the pressure inside.
    set_velocities(state_, [](const Vec3& place) { return Vec3(0.7 * place); });
    balance_->measure(state_, simulation_.constants());
    state_.dt = 0.0;
    state_.inflow.other_pull = -300.0;
    const Vec3 force = solve(state_);
    EXPECT_GT(std::abs(state_.inflow.inside - state_.air.pressure), 0.01 * state_.inflow.inside);
    EXPECT_NEAR(force.dot(state_.air.direction), state_.inflow.inside * state_.air.signed_area,
                1e-12 * force.norm());
}

/// A disk and a band, which hangs below it on radial tapes.
class InflowWithGap : public Inflow {
protected:
    InflowWithGap() : Inflow(with_gap()) {}
    static Scene with_gap() {
        Scene scene = test::c9_scene();
        scene.parachutes.front() = test::canopy_of_type("disk-gap-band");
        return scene;
    }
};

TEST_F(InflowWithGap, VolumeGrowsByWhatClosesIt) {
    // As above: V'/V = 3 k, with the same 1 % of the vent's cap. Fabric alone would miss what the gap, a
    // sixth of the band's circumference wide, sweeps.
    static constexpr double k = 0.3;
    set_velocities(state_, [](const Vec3& place) { return Vec3(k * place); });
    balance_->measure(state_, simulation_.constants());
    solve(state_);
    EXPECT_NEAR(state_.inflow.swept, 3.0 * k * state_.inflow.volume, 0.015 * 3.0 * k * state_.inflow.volume);
    const Openings open = openings(state_);
    EXPECT_GT(open.gaps_sweep - open.gaps.dot(open.velocity), 0.05 * state_.inflow.swept);
    // Fabric and gap together face the air as the mouth does, but for the vent.
    const Vec3 fabric = state_.air.signed_area * Vec3::UnitZ();
    EXPECT_NEAR((fabric + open.gaps).z(), open.mouth.z(), 0.03 * open.mouth.z());
}

TEST_F(InflowWithGap, TightFabricLeaksThroughTheGapAlone) {
    Scene tight = scene_;
    tight.parachutes.front().fabric.permeability.reset();
    tight.parachutes.front().geometric_porosity = 0.0;
    tight.parachutes.front().mesh = MeshFile{};  // the type's gap does not count: that of the mesh does
    ASSERT_EQ(gap_share(tight.parachutes.front()), 0.0);
    balance_.emplace(*InflowBalance::of(tight, simulation_.mesh()));
    set_velocities(state_, nothing);
    balance_->measure(state_, simulation_.constants());
    state_.inflow.volume = 1e3;  // the air reaches all of it
    state_.dt = 0.0;
    solve(state_);
    const InflowState& in = state_.inflow;
    // Bernoulli's jet through what the mesh leaves open, sqrt(2 dp/rho).
    const double jet = std::sqrt(2.0 * in.inside / state_.air.density);
    EXPECT_NEAR(in.leak, simulation_.mesh().gap_area() * opening_speed(in.inside, state_.air.density),
                1e-9 * in.leak);
    EXPECT_LE(opening_speed(in.inside, state_.air.density), jet);
    EXPECT_GT(in.leak, 0.3 * simulation_.mesh().gap_area() * jet);
}

TEST_F(InflowWithGap, TakesOutOfTheMotionWhatItsForcesTake) {
    // In still air the loss is minus the power of pressure and residual force, exactly, but for the mouth's
    // share over the vent: area between mouth and what closes it, times pressure and speed.
    for (const double k : {-0.5, 0.0, 0.4, 2.0}) {
        State state = state_;
        set_velocities(state, [&](const Vec3& place) { return Vec3(k * place); });
        balance_->measure(state, simulation_.constants());
        state.dt = 0.0;
        const Mesh& mesh = simulation_.mesh();
        const Vec3 force = solve(state);
        Vec3 mean = Vec3::Zero(), area = Vec3::Zero();
        double swept = 0.0;
        for (NodeIndex i = 0; i < mesh.canopy_nodes; ++i)
            mean += mesh.tributary_area[i] / mesh.fabric_area() * to_vec3(state.node[i].v);
        for (const Triangle& t : mesh.triangles) {
            const auto x = [&](int c) { return to_vec3(state.node[t.node[c]].x); };
            const Vec3 own = 0.5 * (x(1) - x(0)).cross(x(2) - x(0));
            area += own;
            for (const NodeIndex i : t.node)
                swept += own.dot(to_vec3(state.node[i].v)) / 3.0;
        }
        const double power = state.air.pressure * swept + (force - state.air.pressure * area).dot(mean);
        const Openings open = openings(state);
        const double over_vent = (open.mouth - area - open.gaps).dot(state.air.direction);
        const double speed = -open.velocity.dot(state.air.direction);
        EXPECT_NEAR(state.inflow.loss, state.inflow.inside * over_vent * speed - power,
                    1e-9 * std::abs(power))
            << k;
    }
}

// --- runs --------------------------------------------------------------------------------------

/// One sector: as axisymmetric as a mesh of gores is, so that nothing is random.
Scene symmetric() {
    Scene scene = predicted(test::c9_scene(), 0.02);
    scene.full.symmetry = Symmetry::sector;
    scene.full.contact = Contact::gores;
    scene.full.mesh = {4, 9, 34, 5};
    scene.release.altitude = 300.0;
    scene.release.speed = 21.0;
    return scene;
}

double fill_constant(const Scene& scene) {
    const RunRecord record = run_full(scene);
    EXPECT_EQ(record.status.code, StatusCode::completed) << record.status.detail;
    const Event* full = record.find_event("full-open");
    EXPECT_TRUE(full);
    return full ? full->time * scene.release.speed / scene.parachutes.front().nominal_diameter : 0.0;
}

TEST(PredictedOpening, FillConstantDoesNotHangOnTheStep) {
    // Asked for: three steps within 3 %.
    std::vector<double> n;
    for (const double factor : {0.95, 0.475, 0.2375}) {
        Scene scene = symmetric();
        scene.stop = {Trigger::Kind::time, 2.5, 0.0};
        scene.full.time_step_factor = factor;
        n.push_back(fill_constant(scene));
    }
    const auto [least, most] = std::ranges::minmax(n);
    EXPECT_LT(most / least, 1.03) << n[0] << ' ' << n[1] << ' ' << n[2];
}

TEST(PredictedOpening, FillConstantConvergesWithTheMesh) {
    // Asked for: three meshes within 3 % (found: 0.5 %). The demo's four columns are 2.7 % from eight. Odd
    // counts converge as well, to a value a sixth higher: their gores fold flat, without a crest.
    std::vector<double> n;
    for (const MeshCounts& mesh :
         {MeshCounts{6, 14, 34, 5}, MeshCounts{8, 18, 34, 5}, MeshCounts{10, 22, 34, 5}}) {
        Scene scene = symmetric();
        scene.stop = {Trigger::Kind::time, 1.5, 0.0};
        scene.full.mesh = mesh;
        n.push_back(fill_constant(scene));
    }
    const auto [least, most] = std::ranges::minmax(n);
    EXPECT_LT(most / least, 1.03) << n[0] << ' ' << n[1] << ' ' << n[2];
}

TEST(PredictedOpening, IsASlowStageAndABurst) {
    // As on film: from 15 % to 70 % of the drag area in less than half the time that the first 15 % take.
    Scene scene = symmetric();
    scene.stop = {Trigger::Kind::time, 1.5, 0.0};
    const RunRecord record = run_full(scene);
    const double slow = record.metric("time_to_15_percent_drag_area_s").value_or(0.0);
    const double late = record.metric("time_to_70_percent_drag_area_s").value_or(HUGE_VAL);
    EXPECT_LT(late - slow, 0.5 * slow);
}

TEST(PredictedOpening, ThatIsNotOverOnTheGroundIsAFailure) {
    // 8 m/s at half an inch of water is no fabric but a net: a mouth of 0.05 m^2 does not fill it in 300 m.
    Scene scene = symmetric();
    scene.parachutes.front().filling.initial_mouth = 0.002;
    scene.parachutes.front().fabric.permeability = permeability_at_half_inch(8.0);
    scene.stop = {Trigger::Kind::ground, 0.0, 0.0};
    const RunRecord record = run_full(scene);
    EXPECT_TRUE(failed_to_open(record.status.code)) << record.status.detail;
    EXPECT_FALSE(record.find_event("full-open"));
}

TEST(PredictedOpening, LongerThePorousTheFabric) {
    double before = 0.0;
    for (const double speed : {0.0, 0.2, 0.458, 1.5, 3.0}) {
        Scene scene = symmetric();
        scene.parachutes.front().fabric.permeability = permeability_at_half_inch(speed);
        scene.stop = {Trigger::Kind::time, 2.0, 0.0};
        const double n = fill_constant(scene);
        EXPECT_GT(n, before) << speed;
        before = n;
    }
}

TEST(PredictedOpening, IsTheSameForAScaledParachute) {
    // Froude's similarity, powers of two for k = 4 (froude_similarity_test.cpp); the permeability is inertia
    // alone, whose law has no speed of its own.
    constexpr double k = 4.0, root_k = 2.0;
    Scene small = symmetric();
    small.aerodynamics.line_drag.reset();
    small.full.mesh = {2, 7, 10, 2};
    small.stop = {Trigger::Kind::time, 1.6, 0.0};
    Parachute& chute = small.parachutes.front();
    chute.fabric.permeability = Permeability{0.0, 400.0};
    Scene large = small;
    Parachute& enlarged = large.parachutes.front();
    large.environment.ground *= k;
    large.payload.mass *= k * k * k;
    large.release.altitude *= k;
    large.release.speed *= root_k;
    large.stop.value *= root_k;
    for (double* length :
         {&enlarged.nominal_diameter, &enlarged.vent_diameter, &enlarged.line_length, &enlarged.riser_length})
        *length *= k;
    enlarged.drag_area *= k * k;
    enlarged.mass *= k * k * k;
    enlarged.fabric.youngs_modulus *= k;
    enlarged.fabric.thickness *= k;
    for (Cord* cord : {&enlarged.line, &enlarged.tapes.radial, &enlarged.tapes.skirt, &enlarged.tapes.vent}) {
        cord->youngs_modulus *= k;
        cord->diameter *= k;
    }
    large.full.output_rate /= root_k;
    const RunRecord a = run_full(small), b = run_full(large);
    ASSERT_TRUE(a.find_event("full-open") && b.find_event("full-open"));
    EXPECT_EQ(a.cost.steps, b.cost.steps);
    EXPECT_NEAR(b.find_event("full-open")->time / a.find_event("full-open")->time, root_k, 1e-9);
    EXPECT_NEAR(*b.metric("peak_force_raw_N") / *a.metric("peak_force_raw_N"), k * k * k, 1e-6);
}

TEST(PredictedOpening, DescendsAsThePrescribedOne) {
    // Asked for: within 1 %; D_p/D0 within 6 % of 0.68, the shape of one pressure (isotensoid).
    Scene scene = symmetric();
    scene.stop = {Trigger::Kind::steady_descent, 0.0, 0.0};
    const RunRecord by_itself = run_full(scene);
    Scene told = test::c9_scene();
    told.full = scene.full;
    told.release = scene.release;
    told.stop = scene.stop;
    const RunRecord prescribed = run_full(told);
    ASSERT_TRUE(by_itself.metric("descent_rate_m_s") && prescribed.metric("descent_rate_m_s"));
    EXPECT_NEAR(*by_itself.metric("descent_rate_m_s") / *prescribed.metric("descent_rate_m_s"), 1.0, 0.01);
    EXPECT_NEAR(*by_itself.metric("projected_diameter_ratio"), 0.68, 0.06 * 0.68);
}

TEST(PredictedOpening, TakesFromTheMotionWhatTheAirSays) {
    // The works of nodal forces and of the balance's own terms, dp [A_m w (1 - s) + leak], come by different
    // ways. The balance takes in air through the vent's area of the mouth, 1 to 3 % of it; lines have no drag
    // here. The run itself ends where its energy is off by 0.2 %.
    Scene scene = symmetric();
    scene.aerodynamics.line_drag.reset();
    const RunRecord record = run_full(scene);
    ASSERT_EQ(record.status.code, StatusCode::completed) << record.status.detail;
    ASSERT_TRUE(record.energy && record.energy->drag_work < 0.0);
    const double excess = -record.energy->air_loss / record.energy->drag_work - 1.0;
    EXPECT_GT(excess, 0.005);
    EXPECT_LT(excess, 0.03);
}

}  // namespace
}  // namespace twinchute::fullsim
