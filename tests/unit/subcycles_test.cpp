// Subcycles of lines within a step of the canopy, on a chain with an exact answer.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <unsupported/Eigen/MatrixFunctions>

#include "fullsim/forces/registry.hpp"
#include "fullsim/simulation.hpp"
#include "fullsim/time/critical_step.hpp"
#include "fullsim/time/energy.hpp"
#include "fullsim/time/subcycling.hpp"
#include "lib/scene/read_scene.hpp"
#include "tests/support/small_parachute.hpp"

namespace twinchute::fullsim {
namespace {

/// Canopy, skirt and a piece of line in a row along z: a tape holds the first two, a stiff line the last two,
/// and opposite forces keep both taut, one of the air and one of what hangs on the line. Cables are linear as
/// long as they are.
struct Chain {
    double pull;  // [N]
    Mesh mesh;
    std::unique_ptr<const ForceModel> tape, line;
    NodeConstants constants;
    SubcycledNodes pulled{{1, 2}};
    std::array<double, 2> stiffness{};  // EA/l0 [N/m] of tape and line

    Chain(double skirt_mass, double line_mass, double stiffer, double bulk_viscosity,
          double pulled_by = 300.0)
        : pull(pulled_by) {
        mesh.cords.fill({"cord", 462.0, 9.7e8, 4e-3});
        mesh.cables = {{{0, 1}, 1.0, 1.0, CableKind::radial}, {{1, 2}, 1.0, stiffer, CableKind::line}};
        stiffness = {mesh.cords[0].axial_stiffness(), stiffer * mesh.cords[0].axial_stiffness()};
        const double first = 1.0 + pull / stiffness[0];
        mesh.position = {Vec3(0, 0, 0), Vec3(0, 0, first), Vec3(0, 0, first + 1.0 + pull / stiffness[1])};
        mesh.mass = {1.0, skirt_mass, line_mass};
        mesh.tributary_area = {0.0, 0.0, 0.0};
        mesh.canopy_nodes = 2;
        tape = make_tapes(mesh, 0.0, 0.0);
        line = make_lines(mesh, bulk_viscosity, 0.0);
        constants.mass = mesh.mass;
        constants.share = {0.0, 0.0, 0.0};
        constants.canopy_nodes = 2;
        constants.canopy_mass = 1.0 + skirt_mass;
        constants.system_mass = constants.canopy_mass + line_mass;
    }

    /// Everything displaced [m] from its place at rest.
    State start(const std::array<double, 3>& displaced) const {
        State state = test::state_of(mesh);
        for (int i = 0; i < 3; ++i)
            state.node[i].x[2] += displaced[i];
        return state;
    }
    double displacement(const State& state, int i) const { return state.node[i].x[2] - mesh.position[i].z(); }

    double pull_line(State& state) const {
        const double others = std::exchange(state.damping_power, 0.0);
        line->add_forces(state);
        state.force[2].value[2] += pull;
        return std::exchange(state.damping_power, others);
    }
    void step(State& state, double dt, int count) {
        double damping = 0.0;
        tape->add_forces(state);
        pulled.note(state, [&] { damping = pull_line(state); });
        state.aero[0].value[2] -= pull;
        if (count > 1) {
            advance_in_subcycles(state, constants, dt, count, 0.0, pulled, damping,
                                 [this](State& s) { return pull_line(s); });
        } else {
            state.damping_power += damping;
            advance(state, constants, dt, 0.0);
        }
        state.time += dt;
    }
    /// [J] with what the load on the line has of height.
    double stored(const State& state) const {
        return tape->energy(state) + line->energy(state) - pull * state.node[2].x[2];
    }

    /// Frequencies [rad/s] and modes of the undamped chain, by mass.
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> modes() const {
        Eigen::Matrix3d k;
        const auto [s, f] = stiffness;
        k << s, -s, 0, -s, s + f, -f, 0, -f, f;
        const Eigen::Vector3d root = Eigen::Vector3d(mesh.mass[0], mesh.mass[1], mesh.mass[2]).cwiseSqrt();
        return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(
            Eigen::Matrix3d(root.cwiseInverse().asDiagonal() * k * root.cwiseInverse().asDiagonal()));
    }
    /// Displacements at a time after a start at rest, exact.
    Eigen::Vector3d exact(const std::array<double, 3>& displaced, double time) const {
        const auto solver = modes();
        const Eigen::Vector3d root = Eigen::Vector3d(mesh.mass[0], mesh.mass[1], mesh.mass[2]).cwiseSqrt();
        Eigen::Vector3d part =
            solver.eigenvectors().transpose() * root.cwiseProduct(Eigen::Vector3d(displaced.data()));
        for (int i = 0; i < 3; ++i)
            part[i] *= std::cos(std::sqrt(std::max(0.0, solver.eigenvalues()[i])) * time);
        return root.cwiseInverse().cwiseProduct(solver.eigenvectors() * part);
    }
    double fastest() const { return std::sqrt(modes().eigenvalues()[2]); }
    double slower() const { return std::sqrt(modes().eigenvalues()[1]); }
};

constexpr std::array<double, 3> displaced{2e-3, -1e-3, -2e-3};

TEST(Subcycles, AreOfSecondOrder) {
    Chain chain(0.5, 0.05, 4.0, 0.0);
    const double end = 2.3 * 2.0 * pi / chain.slower();
    const Eigen::Vector3d exact = chain.exact(displaced, end);
    double error[3];
    for (int level = 0; level < 3; ++level) {
        State state = chain.start(displaced);
        const int steps = 300 << level;
        for (int i = 0; i < steps; ++i)
            chain.step(state, end / steps, 4);
        error[level] = 0.0;
        for (int i = 0; i < 3; ++i)
            error[level] += std::abs(chain.displacement(state, i) - exact[i]);
    }
    EXPECT_NEAR(std::log2(error[0] / error[1]), 2.0, 0.1);
    EXPECT_NEAR(std::log2(error[1] / error[2]), 2.0, 0.1);
}

TEST(Subcycles, AreBetterThanNone) {
    // Their purpose: with the canopy's step as it is, the line's own error falls with its subcycles.
    Chain chain(0.5, 0.05, 4.0, 0.0);
    const double end = 2.3 * 2.0 * pi / chain.slower();
    const Eigen::Vector3d exact = chain.exact(displaced, end);
    double error[2];
    for (const int count : {1, 4}) {
        State state = chain.start(displaced);
        for (int i = 0; i < 300; ++i)
            chain.step(state, end / 300, count);
        error[count > 1] = (Eigen::Vector3d(chain.displacement(state, 0), chain.displacement(state, 1),
                                            chain.displacement(state, 2)) -
                            exact)
                               .norm();
    }
    EXPECT_LT(error[1], 0.5 * error[0]);
}

TEST(Subcycles, CloseTheLedger) {
    // Kinetic and elastic energy, the work of the pulls and what the line's dashpot takes, to second order:
    // halving the step quarters the largest residual. The number of subcycles changes on the way.
    double worst[2] = {0.0, 0.0};
    for (int level = 0; level < 2; ++level) {
        Chain chain(0.5, 0.05, 4.0, 0.06);
        const double dt = (level == 0 ? 0.4 : 0.2) / chain.fastest();
        State state = chain.start(displaced);
        state.energy.elastic_start = chain.stored(state);
        const int steps = 400 << level;
        for (int i = 0; i < steps; ++i) {
            chain.step(state, dt, i * 10 / steps % 2 ? 3 : 2);
            const EnergyLedger ledger =
                energy_ledger(state, kinetic_energy(state, chain.constants), chain.stored(state));
            worst[level] = std::max(worst[level], std::abs(residual(ledger)));
            if (i + 1 == steps) {
                EXPECT_GT(ledger.damping, 0.0);
            }
        }
        EXPECT_LT(worst[level], 0.05 * 0.5 * chain.stiffness[0] * 9e-6);  // of the first stretch
    }
    EXPECT_NEAR(std::log2(worst[0] / worst[1]), 2.0, 0.3);
}

/// Largest displacement of the line in the last tenth of 4000 steps.
double late_amplitude(Chain&& chain, double dt_over_half_period) {
    State state = chain.start({0.0, 0.0, 1e-6});
    double late = 0.0;
    for (int i = 0; i < 4000; ++i) {
        chain.step(state, dt_over_half_period * pi / chain.fastest(), 8);
        if (i >= 3600) late = std::max(late, std::abs(chain.displacement(state, 2)));
    }
    return late;
}

TEST(Subcycles, RingWhereAStepIsHalfAPeriodOfTheLine) {
    // The impulses then come in time with the line's own motion, however small the subcycles are, until it
    // goes slack, here at 6e-5 m. What keeps it quiet is a skirt that is heavy beside the line, as with the
    // air it moves, and the line's bulk viscosity. Quiet is the jerk of one impulse, some 1e-6 m.
    constexpr double pull = 3.0;
    const auto near_resonance = [&](double skirt_mass, double bulk_viscosity) {
        double largest = 0.0;  // the band is narrow, and below half a period
        for (double ratio = 0.985; ratio <= 1.0; ratio += 0.001)
            largest =
                std::max(largest, late_amplitude(Chain(skirt_mass, 0.05, 4.0, bulk_viscosity, pull), ratio));
        return largest;
    };
    EXPECT_GT(near_resonance(0.5, 0.0), 5e-5);
    EXPECT_LT(late_amplitude(Chain(0.5, 0.05, 4.0, 0.0, pull), 0.9), 2e-5);
    EXPECT_LT(near_resonance(5.0, 0.06), 2e-5);
}

/// Largest growth in a step of `dt` of a line whose one end is fixed, the other a skirt of `mass` on a spring
/// with the bound `canopy` on its step: one impulse of the spring, then the line's exact motion. By elements:
/// EA/l = 1 N/m and 1 kg; dashpots of `viscosity` times the impedance.
double growth(int elements, double mass, double viscosity, double canopy, double dt) {
    Eigen::MatrixXd rate = Eigen::MatrixXd::Zero(2 * elements, 2 * elements);
    rate.topRightCorner(elements, elements).setIdentity();
    for (int e = 0; e < elements; ++e)
        for (const int row : {e, e + 1})
            for (const int column : {e, e + 1}) {
                if (std::max(row, column) == elements) continue;
                const double pull = (row == column ? -1.0 : 1.0) / (row == 0 ? mass : 1.0);
                rate(elements + row, column) += pull;
                rate(elements + row, elements + column) += viscosity * pull;
            }
    Eigen::MatrixXd kick = Eigen::MatrixXd::Identity(2 * elements, 2 * elements);
    kick(elements, 0) = -dt * 4.0 / (canopy * canopy);
    return ((rate * dt).exp() * kick).eval().eigenvalues().cwiseAbs().maxCoeff();
}

TEST(Subcycles, DoNotRingUpToTheResonanceLimit) {
    // Against the eigenvalues of a whole step, which is the method's limit for infinitely small subcycles.
    // The canopy's own bound of 5 to 50 transit times of an element is that of stiff lines on a canopy that
    // fills or is open.
    constexpr int elements = 16;
    int rang = 0;
    for (const double mass : {0.3, 1.0, 5.0})
        for (const double viscosity : {0.06, 0.24})
            for (const double canopy : {5.0, 15.0, 50.0}) {
                const LineWaves line{1.0 / elements, viscosity, mass, 0.0};
                const double limit = resonance_limit(line, 0.0, canopy);
                for (int i = 1; i <= 20; ++i)
                    EXPECT_LT(
                        growth(elements, mass, viscosity, canopy, std::min(limit, 0.95 * canopy) * i / 20),
                        1.0 + 1e-9)
                        << mass << ' ' << viscosity << ' ' << canopy << ' ' << i;
                for (double dt = limit; dt < std::min(4.0 * limit, 0.95 * canopy); dt *= 1.01)
                    if (growth(elements, mass, viscosity, canopy, dt) > 1.0 + 1e-3) {
                        ++rang;
                        break;
                    }
            }
    EXPECT_GT(rang, 6);  // the bound is needed
    // Air on the skirt lets steps be longer, by the fifth root of its mass.
    EXPECT_NEAR(resonance_limit({1.0, 0.1, 1.0, 0.5}, 62.0, 5.0),
                2.0 * resonance_limit({1.0, 0.1, 1.0, 0.5}, 0.0, 5.0), 1e-12);
    EXPECT_EQ(resonance_limit({}, 0.0, 5.0), std::numeric_limits<double>::infinity());
}

TEST(Subcycles, RecordWhatRisersGiveThePayload) {
    // Lines a hundred times as stiff, in many subcycles: the mean force over time is the payload's momentum
    // and what gravity took of it; the force at the ends of steps is not.
    for (const char* symmetry : {"none", "sector"}) {
        const Scene scene =
            read_scene(std::string(TWINCHUTE_SOURCE_DIR) + "/data/scenes/c9-inflation.toml",
                       {"parachute.line=mil-c-5040-type-ii-printed", "parachute.deploy.by='inflated'",
                        "release.speed='7.7 m/s'", "full.line_substeps=12", "full.mesh.gore_columns=1",
                        "full.mesh.gore_rows=9", std::string("full.symmetry=") + symmetry});
        Simulation simulation(scene);
        const NodeIndex payload = simulation.mesh().payload();
        const auto fly = [&](double until, auto&& see) {
            while (simulation.system().time < until) {
                simulation.evaluate_forces();
                see(simulation.system());
                simulation.step_to(until);
            }
        };
        fly(0.1, [](const SystemState&) {});
        const double start = simulation.system().time, before = simulation.payload().v[2];
        double impulse = 0.0, of_ends = 0.0, last = start;
        fly(0.6, [&](const SystemState& s) {
            impulse += mean_riser_force(s).value.z() * (s.time - last);
            of_ends += s.riser_force.z() * (s.time - last);
            last = s.time;
        });
        const double after = simulation.payload().v[2];
        const double gained =
            simulation.constants().mass[payload] *
            (after - before + scene.environment.gravity * (simulation.system().time - start));
        EXPECT_GE(simulation.steps().most_subcycles(), 8) << symmetry;
        EXPECT_NEAR(impulse, gained, 2e-3 * gained) << symmetry;  // a step at either end
        EXPECT_GT(std::abs(of_ends - gained), 1e-2 * gained) << symmetry;
    }
}

TEST(PerronScaling, BringTheBoundOfAChainToItsLimit) {
    // A chain's matrix of norms has its own eigenvalues (turn every other node's sign), so that the best
    // weights give the limit 2/omega exactly; twelve iterations come close, from below.
    for (const double light : {0.05, 0.5, 5.0}) {
        const Chain chain(0.5, light, 4.0, 0.0);
        ForceModels structure, loads;
        structure.push_back(make_cable(chain.mesh, 0.0));
        const State state = test::state_of(chain.mesh);
        PerronScaling weights;
        weights.begin(state, chain.constants, structure, nullptr);
        const double limit = 2.0 / chain.fastest();
        const double plain = critical_step(state, chain.constants, structure, loads, {}).dt;
        const double weighed = critical_step(state, chain.constants, structure, loads, weights.by_node()).dt;
        EXPECT_LT(plain, 0.97 * limit) << light;
        EXPECT_GT(weighed, 0.985 * limit) << light;
        EXPECT_LE(weighed, limit * (1.0 + 1e-12)) << light;
    }
}

TEST(Subcycles, BoundsNameTheirNodes) {
    // By hand: canopy 1 kg and skirt 0.5 kg on the tape, skirt and 0.05 kg on the line, undamped 2
    // sqrt(m/2k).
    const Chain chain(0.5, 0.05, 4.0, 0.0);
    ForceModels structure, loads;
    structure.push_back(make_tapes(chain.mesh, 0.0, 0.0));
    structure.push_back(make_lines(chain.mesh, 0.0, 0.0));
    const auto [s, f] = chain.stiffness;
    const CriticalSteps steps =
        critical_steps(test::state_of(chain.mesh), chain.constants, structure, loads, structure[1].get(), {});
    EXPECT_NEAR(steps.canopy, 2.0 * std::sqrt(0.5 / (2.0 * s)), 1e-15);
    EXPECT_NEAR(steps.lines, 2.0 * std::sqrt(0.05 / (2.0 * f)), 1e-15);
    EXPECT_NEAR(steps.all, std::min(steps.lines, 2.0 * std::sqrt(0.5 / (2.0 * (s + f)))), 1e-15);
}

}  // namespace
}  // namespace twinchute::fullsim
