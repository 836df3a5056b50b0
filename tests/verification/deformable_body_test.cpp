// Tetrahedra that give way, on their own: against homogeneous strain, closed forms of a bar and a beam, the
// eigenvalues of their own tangent, and the rigid body.
#include "fullsim/deformable_body.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "fullsim/attitude.hpp"
#include "fullsim/forces/tetrahedra.hpp"
#include "fullsim/rigid_body.hpp"
#include "fullsim/time/central_difference.hpp"
#include "tests/support/difference.hpp"

namespace twinchute::fullsim {
namespace {

constexpr NodeIndex payload = 0, first_attachment = 2;  // a dummy between

/// At rest where it is unstrained, after a payload's node at the origin and a dummy.
State state_of(const SolidMesh& solid) {
    State state;
    state.node.assign(2, {splat(0.0), splat(0.0)});
    for (const Vec3& x : solid.node)
        state.node.push_back({to_lanes(x), splat(0.0)});
    state.v_half.assign(state.node.size(), {splat(0.0)});
    clear_forces(state);
    return state;
}

void move(State& state, std::size_t place, const Vec3& x, const Vec3& v) {
    state.node[first_attachment + place] = {to_lanes(x), to_lanes(v)};
    state.v_half[first_attachment + place].value = to_lanes(v);
}

Vec3 force_on(const State& state, std::size_t place) {
    return to_vec3(state.force[first_attachment + place].value);
}

/// A box whose nodes inside are not where they were, so that no two tetrahedra are alike.
SolidMesh crooked_box() {
    SolidMesh solid = make_box({0.6, 0.5, 0.9}, {3, 3, 4});
    std::mt19937 generator(7);
    std::uniform_real_distribution<double> step(-0.03, 0.03);
    for (Vec3& x : solid.node)
        if ((x.cwiseAbs() - Vec3(0.3, 0.25, 0.45)).maxCoeff() < -1e-9)
            x += Vec3(step(generator), step(generator), step(generator));
    return solid;
}

const SolidLaw plain = solid_law({2e6, 0.3}, 500.0, 0.0, 0.0);

TEST(Tetrahedra, PassThePatchTest) {
    // A homogeneous deformation, large strain and turn: no force inside, on the faces P N A, and V W(E).
    const SolidMesh solid = crooked_box();
    const auto block = make_tetrahedra(solid, plain, first_attachment);
    Eigen::Matrix3d f;
    f << 1.1, 0.2, -0.1, -0.15, 0.9, 0.3, 0.05, 0.1, 1.2;
    f = Eigen::AngleAxisd(1.0, Vec3(1, 2, 3).normalized()) * f;
    State state = state_of(solid);
    for (std::size_t i = 0; i < solid.node.size(); ++i)
        move(state, i, f * solid.node[i] + Vec3(1, -2, 3), Vec3::Zero());
    block->add_forces(state);
    const Eigen::Matrix3d strain = 0.5 * (f.transpose() * f - Eigen::Matrix3d::Identity());
    const Eigen::Matrix3d stress =
        2.0 * plain.mu * strain + plain.lambda * strain.trace() * Eigen::Matrix3d::Identity();
    Vec3 top = Vec3::Zero();  // on the face z = 0.45, edges excluded by their own faces: sums of all three
    double largest = 0.0;
    for (std::size_t i = 0; i < solid.node.size(); ++i) {
        const Vec3 off = Vec3(0.3, 0.25, 0.45) - solid.node[i].cwiseAbs();
        if (off.minCoeff() > 1e-9) largest = std::max(largest, force_on(state, i).norm());
        if (solid.node[i].z() > 0.45 - 1e-9) top += force_on(state, i);
    }
    // Half of what its edges carry of the faces beside it cancels between opposite ones.
    const Vec3 exact = f * stress * Vec3::UnitZ() * 0.6 * 0.5;
    EXPECT_LT(largest, 1e-9 * exact.norm());
    EXPECT_LT((-top - exact).norm(), 1e-10 * exact.norm());
    const double energy = 0.27 * 0.5 * stress.cwiseProduct(strain).sum();
    EXPECT_NEAR(block->energy(state), energy, 1e-12 * energy);
}

TEST(Tetrahedra, HaveNeitherForceNorPowerWhereTheyTurn) {
    // Rigid, fast and far away: strain rates are differences of 300 m/s, forces those of rounding.
    const SolidMesh solid = crooked_box();
    const auto block = make_tetrahedra(solid, solid_law({2e6, 0.3}, 500.0, 0.06, 1e-4), first_attachment);
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(2.0, Vec3(3, -1, 2).normalized()).toRotationMatrix();
    State state = state_of(solid);
    for (std::size_t i = 0; i < solid.node.size(); ++i) {
        const Vec3 arm = turn * solid.node[i];
        move(state, i, arm + Vec3(10, 20, 30), Vec3(4, -50, 6).cross(arm) + Vec3(300, 0, 0));
    }
    block->add_forces(state);
    for (std::size_t i = 0; i < solid.node.size(); ++i)
        EXPECT_LT(force_on(state, i).norm(), 1e-5);  // E A 1e-14 and damping E beta A v/x 1e-14
    EXPECT_LT(std::abs(state.damping_power), 1e-12);
    EXPECT_LT(block->energy(state), 1e-15);
}

TEST(Tetrahedra, DampAsTheirLawSays) {
    // Homogeneous strain rates D at rest: beta C:D + b1 rho c h tr(D), h the shortest height: V S:D is lost.
    const SolidMesh solid = make_box({0.4, 0.4, 0.4}, {2, 2, 2});
    const double density = 500.0, beta = 1e-4, b1 = 0.06;
    const SolidLaw law = solid_law({2e6, 0.3}, density, b1, beta);
    const auto block = make_tetrahedra(solid, law, first_attachment);
    Eigen::Matrix3d rate;
    rate << 0.3, 0.1, -0.2, 0.1, 0.5, 0.4, -0.2, 0.4, -0.1;
    State state = state_of(solid);
    for (std::size_t i = 0; i < solid.node.size(); ++i)
        move(state, i, solid.node[i], rate * solid.node[i]);
    block->add_forces(state);
    const double c = std::sqrt((law.lambda + 2.0 * law.mu) / density), height = 0.2 / std::sqrt(2.0);
    const double elastic = 2.0 * law.mu * rate.squaredNorm() + law.lambda * rate.trace() * rate.trace();
    const double exact = 0.064 * (beta * elastic + b1 * density * c * height * rate.trace() * rate.trace());
    EXPECT_NEAR(state.damping_power, exact, 1e-12 * exact);
}

/// Modes of small motion: masses and the tangent, by differences.
struct Modes {
    Eigen::VectorXd frequency;  // [rad/s] in rising order
    Eigen::MatrixXd shape;
};
Modes modes_of(const SolidMesh& solid, const SolidLaw& law, const std::vector<double>& mass) {
    const auto block = make_tetrahedra(solid, law, first_attachment);
    const auto count = static_cast<Eigen::Index>(3 * solid.node.size());
    Eigen::MatrixXd tangent(count, count);
    const double by = 1e-6;
    for (Eigen::Index k = 0; k < count; ++k) {
        Eigen::VectorXd difference = Eigen::VectorXd::Zero(count);
        for (const double sign : {1.0, -1.0}) {
            State state = state_of(solid);
            state.node[static_cast<std::size_t>(first_attachment + k / 3)].x[k % 3] += sign * by;
            block->add_forces(state);
            for (Eigen::Index i = 0; i < count; ++i)
                difference[i] += sign * force_on(state, static_cast<std::size_t>(i / 3))[i % 3];
        }
        tangent.col(k) = -difference / (2.0 * by);
    }
    for (Eigen::Index i = 0; i < count; ++i)
        for (Eigen::Index k = 0; k < count; ++k)
            tangent(i, k) /=
                std::sqrt(mass[static_cast<std::size_t>(i / 3)] * mass[static_cast<std::size_t>(k / 3)]);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(0.5 * (tangent + tangent.transpose()));
    return {solver.eigenvalues().cwiseMax(0.0).cwiseSqrt(), solver.eigenvectors()};
}

/// A quarter of each tetrahedron to its corners.
std::vector<double> quarters(const SolidMesh& solid, double density) {
    std::vector<double> mass(solid.node.size(), 0.0);
    for (const auto& corner : solid.tetrahedron) {
        const auto x = [&](std::size_t c) { return solid.node[static_cast<std::size_t>(corner[c])]; };
        const double volume = (x(1) - x(0)).cross(x(2) - x(0)).dot(x(3) - x(0)) / 6.0;
        for (const int c : corner)
            mass[static_cast<std::size_t>(c)] += 0.25 * density * volume;
    }
    return mass;
}

TEST(Tetrahedra, VibrateAsABar) {
    // The first stretching of a free bar without lateral strain: w = pi c/L, c = sqrt(E/rho). Moving as
    // sin(pi z/L), linear elements with lumped masses have 2 c/h sin(pi h/(2 L)) to the rounding of
    // differences; of their own modes the one most like it, which bends along a little, comes within 0.5 %.
    const double length = 2.0, modulus = 3e6, density = 400.0, c = std::sqrt(modulus / density);
    for (const int cells : {2, 3}) {
        const SolidMesh bar = make_box({0.25, 0.25, length}, {cells, cells, 4 * cells});
        const std::vector<double> mass = quarters(bar, density);
        const Modes modes = modes_of(bar, solid_law({modulus, 0.0}, density, 0.0, 0.0), mass);
        for (int k = 0; k < 6; ++k)
            EXPECT_LT(modes.frequency[k], 1e-3 * pi * c / length) << "a rigid motion";
        Eigen::VectorXd like = Eigen::VectorXd::Zero(modes.shape.rows());
        for (std::size_t i = 0; i < bar.node.size(); ++i)
            like[static_cast<Eigen::Index>(3 * i + 2)] =
                std::sqrt(mass[i]) * std::sin(pi * bar.node[i].z() / length);
        like.normalize();
        const Eigen::VectorXd part = modes.shape.transpose() * like;
        const double moving = std::sqrt((part.array() * modes.frequency.array()).square().sum());
        const double h = length / (4 * cells);
        const double exact = 2.0 * c / h * std::sin(0.5 * pi * h / length);
        EXPECT_NEAR(moving, exact, 1e-6 * exact);
        Eigen::Index mode = 0;
        EXPECT_GT(part.cwiseAbs().maxCoeff(&mode), 0.95);
        RecordProperty("mode_of_" + std::to_string(cells),
                       std::to_string(modes.frequency[mode] * length / (pi * c)));
        EXPECT_NEAR(modes.frequency[mode], pi * c / length, 5e-3 * pi * c / length);
    }
}

TEST(Tetrahedra, BendAsABeamWhenTheyAreFine) {
    // First bending of a slender free beam: w = (4.73004/L)^2 sqrt(E I/(rho A)) (Euler and Bernoulli; shear
    // and rotary inertia of L/b = 10 take 3 % off). Elements of constant strain are too stiff in bending and
    // come down as they shrink.
    const double length = 1.0, side = 0.1, modulus = 3e6, density = 400.0;
    const double exact = std::pow(4.73004 / length, 2) * std::sqrt(modulus * side * side / (12.0 * density));
    double before = 1e9;
    for (const int across : {1, 2, 3}) {
        const SolidMesh beam = make_box({side, side, length}, {across, across, 6 * across});
        const Modes modes =
            modes_of(beam, solid_law({modulus, 0.0}, density, 0.0, 0.0), quarters(beam, density));
        const double ratio = modes.frequency[6] / exact;
        RecordProperty("across_" + std::to_string(across), std::to_string(ratio));
        EXPECT_GT(ratio, 0.95);
        EXPECT_LT(ratio, before);
        before = ratio;
    }
    EXPECT_LT(before, 1.3);
}

TEST(NodeMasses, HaveMassCentreAndInertiaOfTheBody) {
    // To the rounding of Newton's last step; a quarter of each tetrahedron alone is far off.
    for (const auto& shape : {PayloadBody{PayloadBody::Shape::box, {0.6, 0.4, 0.9}},
                              PayloadBody{PayloadBody::Shape::cylinder, {0.8, 1.1}}}) {
        const SolidMesh solid = make_coarse_solid(shape, 4);
        const Lumped body = lump(solid_of(make_solid(shape, 4)), 150.0);
        const std::vector<double> mass = node_masses(solid, 150.0, body);
        ASSERT_EQ(mass.size(), solid.node.size());
        double sum = 0.0;
        Vec3 centre = Vec3::Zero();
        Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
        for (std::size_t i = 0; i < mass.size(); ++i) {
            const Vec3& x = solid.node[i];
            EXPECT_GT(mass[i], 0.0);
            sum += mass[i];
            centre += mass[i] * x;
            inertia += mass[i] * (x.squaredNorm() * Eigen::Matrix3d::Identity() - x * x.transpose());
        }
        EXPECT_NEAR(sum, 150.0, 1e-9);
        EXPECT_LT(centre.norm(), 1e-9);
        EXPECT_LT((inertia - body.inertia).norm(), 1e-9 * body.inertia.norm());
    }
    // Eight corners of a box cannot: each is as far from the centre as any.
    const SolidMesh corners = make_box({0.6, 0.4, 0.9}, {1, 1, 1});
    EXPECT_TRUE(node_masses(corners, 150.0, lump(solid_of(corners), 150.0)).empty());
}

/// A box on its own, of 30 kg, that tumbles.
struct Tumbling {
    SolidMesh solid = make_box({0.6, 0.9, 0.3}, {4, 6, 2});
    BodyMesh mesh{solid, lump(solid_of(solid), 30.0), {}, true};
    SolidLaw law;
    DeformableBody body;
    std::unique_ptr<const ForceModel> block;
    ForceModels structure;
    State state = state_of(solid);
    std::vector<double> mass;
    NodeConstants constants;

    explicit Tumbling(double modulus, double beta = 0.0)
        : law(solid_law({modulus, 0.3}, 30.0 / mesh.lumped.volume, 0.0, beta)),
          body({payload, first_attachment}, node_masses(solid, 30.0, mesh.lumped), mesh, law, 0.0),
          mass(node_masses(solid, 30.0, mesh.lumped)) {
        structure.push_back(make_tetrahedra(solid, law, first_attachment));
        constants.mass = {30.0};
        constants.share = {0.0};
        constants.canopy_mass = constants.system_mass = 30.0;
        body.start(state, Eigen::Matrix3d::Identity());
        state.body->attitude = {1.0, 0.0, 0.0, 0.0};  // along the world's axes, not the principal ones
    }
    void spin(const Vec3& rate) {
        for (std::size_t i = 0; i < solid.node.size(); ++i)
            move(state, i, solid.node[i], rate.cross(solid.node[i]));
    }
    void step(double dt) {
        structure.front()->add_forces(state);
        body.pull(state);
        const double kick = 0.5 * (dt + state.dt);
        advance(state, constants, dt, 0.0);
        body.advance(state, kick, dt);
        state.time += dt;
    }
    Vec3 momentum() const {
        Vec3 sum = Vec3::Zero();
        for (std::size_t i = 0; i < mass.size(); ++i)
            sum += mass[i] * to_vec3(state.v_half[first_attachment + i].value);
        return sum;
    }
    Vec3 angular_momentum() const {
        Vec3 sum = Vec3::Zero();
        for (std::size_t i = 0; i < mass.size(); ++i)
            sum += mass[i] * to_vec3(state.node[first_attachment + i].x)
                                 .cross(to_vec3(state.v_half[first_attachment + i].value));
        return sum;
    }
    double energy() const { return body.inner_energy(state) + structure.front()->energy(state); }
};

TEST(DeformableBody, KeepsMomentaAndEnergyWhereItTumbles) {
    // Internal forces have neither sum nor moment. Energy swings with what the extrapolated velocity misses.
    Tumbling t(1e6);
    t.spin({3.0, 0.5, 1.0});
    const double dt = 0.5 * t.body.critical_step(t.state, t.structure, 0.0);
    const Vec3 angular = t.angular_momentum();
    const double energy = t.energy();
    double worst = 0.0;
    for (int k = 0; k < 20'000; ++k) {
        t.step(dt);
        worst = std::max(worst, std::abs(t.energy() / energy - 1.0));
    }
    EXPECT_LT((t.angular_momentum() - angular).norm(), 1e-11 * angular.norm());
    EXPECT_LT(t.momentum().norm(), 1e-11);
    EXPECT_LT(worst, 1e-3);
    EXPECT_EQ(t.state.damping_power, 0.0);
}

TEST(DeformableBody, TumblesAsTheRigidOneWhereItIsStiff) {
    // Equal inertia gives equal motion; the strain of spinning is rho w^2 R^2/E = 3e-6, of the attitude
    // as much in each turn.
    Tumbling t(1e8, 1e-5);
    const Vec3 rate(3.0, 0.5, 1.0);
    t.spin(rate);
    const RigidBody rigid({payload, first_attachment}, 30.0, t.mesh);
    State still = t.state;
    still.body->half_momentum = still.body->momentum = t.mesh.lumped.inertia * rate;
    const double dt = 0.8 * t.body.critical_step(t.state, t.structure, 0.0);
    while (t.state.time < 1.0) {
        t.step(dt);
        rigid.advance(still, dt, dt);
    }
    const auto turn = [](const State& s) { return turn_of(s.body->attitude); };
    EXPECT_LT(turn(t.state).angularDistance(turn(still)), 1e-4);
    EXPECT_GT(turn(t.state).angularDistance(Eigen::Quaterniond::Identity()), 1.0);
}

TEST(DeformableBody, BoundsItsStepFromBelowAndNotFarBelow) {
    // 2/w of the fastest mode of its own tangent: row sums come within a sixth.
    const Tumbling t(1e6);
    const Modes modes = modes_of(t.solid, t.law, t.mass);
    const double exact = 2.0 / modes.frequency[modes.frequency.size() - 1];
    const double bound = t.body.critical_step(t.state, t.structure, 0.0);
    RecordProperty("bound_over_exact", std::to_string(bound / exact));
    EXPECT_LE(bound, exact * (1.0 + 1e-9));
    EXPECT_GT(bound, 0.75 * exact);
}

}  // namespace
}  // namespace twinchute::fullsim
