// The full model's equations in time, by its own steps and by integrators that know nothing of it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "fullsim/simulation.hpp"
#include "lib/solve/sundials.hpp"

namespace twinchute::test {

/// Where a run has come to.
struct Marched {
    std::vector<double> unknowns;     ///< as Simulation::unknowns; empty where the integrator gave up
    double force = 0.0;               ///< [N] what the risers pull on the payload
    std::int64_t evaluations = 0;     ///< of all forces
    std::int64_t line_subcycles = 0;  ///< of lines alone, beyond those
    std::string failure = {};
};

/// How a Runge-Kutta pair is led: by its tolerance, or in steps of one length [s] where that is given.
struct Leading {
    double rtol = 1e-6;
    double dt = 0.0;
};

/// Looks at a march after each step, with the forces of that instant evaluated. May be empty.
using Watch = std::function<void(fullsim::Simulation&)>;

/// Ends of the phases before `end` [s], and `end`: where the right-hand side bends.
inline std::vector<double> bends_of(const fullsim::Simulation& simulation, double end) {
    std::vector<double> bends;
    for (const Phase phase : {Phase::initial, Phase::filling})
        if (const double at = simulation.inflation().end_of(phase);
            simulation.system().phase <= phase && at > simulation.system().time && at < end)
            bends.push_back(at);
    bends.push_back(end);
    return bends;
}
inline void begin_next_phase(fullsim::Simulation& simulation) {
    simulation.begin(simulation.system().phase == Phase::initial ? Phase::filling : Phase::open);
}

/// From the scene's release to `end` [s] by the model's own steps, at most `longest` [s] each.
inline Marched by_own_steps(const Scene& scene, double end, double longest = INFINITY,
                            const Watch& watch = {}) {
    fullsim::Simulation simulation(scene);
    Marched result;
    const auto evaluate = [&] {
        simulation.evaluate_forces();
        ++result.evaluations;
        if (watch) watch(simulation);
    };
    for (const double bend : bends_of(simulation, end)) {
        const double begin = simulation.system().time;
        // Even steps where the caller says how long.
        const auto even = std::isinf(longest) ? 1.0 : std::ceil((bend - begin) / longest - 1e-9);
        for (double k = 1.0; k <= even; k += 1.0) {
            const double until = k == even ? bend : begin + (bend - begin) * k / even;
            while (simulation.system().time < until) {
                evaluate();
                result.line_subcycles += simulation.step().subcycles - 1;
                simulation.step_to(until);
            }
        }
        if (bend < end) begin_next_phase(simulation);
    }
    simulation.evaluate_forces();  // for the force, not for a step
    if (watch) watch(simulation);
    result.unknowns = simulation.unknowns();
    result.force = simulation.system().riser_force.norm();
    return result;
}

/// Integrates by one of ARKODE's pairs, which sees nothing but rates. Evaluations for `watch` do not
/// count.
inline Marched by_sundials(const Scene& scene, const OdeMethod& method, const Leading& leading, double end,
                           const Watch& watch = {}) {
    fullsim::Simulation simulation(scene);
    Marched result;
    const std::vector<double> start = simulation.unknowns();
    std::vector<double> rates(start.size());
    OdeSolver solver(
        method,
        [&](double t, std::span<const double> y, std::span<double> f) {
            ++result.evaluations;
            simulation.rates(t, y, f);
        },
        0.0, start, leading.rtol, std::vector<double>(start.size(), leading.rtol));
    for (const double bend : bends_of(simulation, end)) {
        const double length = bend - solver.time();
        if (leading.dt > 0.0) solver.fix_step(length / std::ceil(length / leading.dt - 1e-9));
        solver.stop_at(bend);
        auto outcome = OdeSolver::Outcome::stepped;
        while (outcome == OdeSolver::Outcome::stepped) {
            outcome = solver.advance();
            if (!watch || outcome == OdeSolver::Outcome::failed) continue;
            simulation.rates(solver.time(), solver.state(), rates);
            watch(simulation);
        }
        const bool finite = std::ranges::all_of(solver.state(), [](double v) { return std::isfinite(v); });
        if (outcome != OdeSolver::Outcome::reached_stop || !finite) {
            result.failure = finite ? solver.failure() : "not finite";
            return result;
        }
        if (bend >= end) break;
        begin_next_phase(simulation);
        const std::vector<double> y(solver.state().begin(), solver.state().end());
        solver.restart(bend, y);
    }
    result.unknowns.assign(solver.state().begin(), solver.state().end());
    simulation.rates(end, result.unknowns, rates);
    result.force = simulation.system().riser_force.norm();
    return result;
}

/// [m] root mean square over nodes of how far they are apart.
inline double distance(const Marched& a, const Marched& b) {
    double sum = 0.0;
    const std::size_t nodes = a.unknowns.size() / 6;
    for (std::size_t i = 0; i < nodes; ++i)
        for (std::size_t c = 0; c < 3; ++c)
            sum += std::pow(a.unknowns[6 * i + c] - b.unknowns[6 * i + c], 2);
    return std::sqrt(sum / static_cast<double>(nodes));
}

}  // namespace twinchute::test
