// The opening of the line-stretch demo on its mesh: peak force, its time and filling time by the model's own
// steps and by integrators that know nothing of it.
#include <fmt/format.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "fullsim/mesh/start.hpp"
#include "fullsim/run/observer.hpp"
#include "lib/solve/stopwatch.hpp"
#include "tests/bench/work/opening.hpp"
#include "tests/support/time_integration.hpp"

namespace twinchute::bench {
namespace {

/// [s]: the peak comes at 1.5 s, and so does the filling.
constexpr double end = 1.65;
/// As the full model defines the filling time (docs/theory/filling-time.md).
constexpr double filled_share = 0.98;

/// Opening as an integrator computes it, seen by the observer of runs after each of its steps.
struct Seen {
    Measured found;
    std::string failure;
};

/// steady_area [m2]: that of a run, since no march goes on until the canopy is steady.
template <class March>
Seen see(const Scene& scene, double steady_area, March&& march) {
    const fullsim::Simulation parachute(scene);
    fullsim::Observer observer(parachute.mesh(), scene.environment.gravity, scene.full.output_rate);
    Seen seen;
    const Stopwatch stopwatch;
    const test::Marched marched = march([&](fullsim::Simulation& s) {
        observer.observe(s.system(), s.payload_force());
        if (observer.row_is_due(s.system().time)) observer.add_row(s.synchronised_state());
        seen.found.element_steps = static_cast<double>(s.element_steps());
    });
    seen.found.seconds = stopwatch.wall();
    seen.found.evaluations = marched.evaluations;
    seen.failure = marched.failure;
    if (!seen.failure.empty()) return seen;
    observer.finish();
    seen.found.opening = {observer.peak().value, observer.peak().time,
                          observer.first_time_of_area(filled_share * steady_area).value_or(NAN)};
    return seen;
}

Seen by_own_steps(const Scene& scene, double steady_area) {
    return see(scene, steady_area,
               [&](const test::Watch& watch) { return test::by_own_steps(scene, end, INFINITY, watch); });
}

/// elements: evaluated at each evaluation of forces.
Seen by_pair(const Scene& scene, double steady_area, const OdeMethod& method, double rtol, double elements) {
    Seen seen = see(scene, steady_area, [&](const test::Watch& watch) {
        return test::by_sundials(scene, method, {rtol}, end, watch);
    });
    seen.found.element_steps = elements * static_cast<double>(seen.found.evaluations);
    return seen;
}

/// Seen from outside, the model's own steps have to be those of a run: else pairs would be held to another
/// definition of its answers.
void check_the_looking(const Opening& seen, const Opening& run) {
    for (const double off : errors_of(seen, run))
        if (!(off <= 1e-9))
            throw std::runtime_error(
                fmt::format("the same steps seen from outside give another opening, off by {:.1e}", off));
}

/// Forces of one system: else its shortest steps could not come that near to the truth in time, whose own
/// error is below 1e-5. Found are 5e-5 on the mesh of the demo, and less on the coarse one.
void check_the_truth(const Curve& curve) {
    if (const double off = curve.samples.back().error; !(off <= 3e-4))
        throw std::runtime_error(
            fmt::format("{}: the shortest steps miss the peak of the truth by {:.1e}", curve.method, off));
}

Curve own_steps(const char* method, Scene scene, double steady_area, const std::vector<double>& factors,
                const Opening& truth) {
    Curve curve{method, own_rule, {}};
    for (const double factor : factors) {
        scene.full.time_step_factor = factor;
        curve.samples.push_back(
            sample_of(fmt::format("{:g}", factor), by_own_steps(scene, steady_area).found, truth));
        say(curve);
    }
    return curve;
}

}  // namespace

void study_opening_in_time(const Scene& demo, const TimeSettings& with,
                           const std::filesystem::path& directory) {
    Scene subcycles = fullsim::weighed(demo);  // as runs do
    subcycles.full.output_rate = 2000.0;       // for the filling time, which is linear between rows
    Scene plain = subcycles;
    plain.full.line_substeps = 1;  // the equations as they stand, for integrators that know no subcycles
    const Measured run = run_opening(plain);
    const Measured seen = by_own_steps(plain, run.steady_area).found;
    check_the_looking(seen.opening, run.opening);
    const double elements = seen.element_steps / static_cast<double>(seen.evaluations);

    const Seen truth =
        by_pair(plain, run.steady_area, *find_ode_method("zonneveld"), with.truth_rtol, elements);
    if (!truth.failure.empty()) throw std::runtime_error(truth.failure);
    say("truth in time", truth.found);
    Study study = opening_study(
        with.name, "Opening of the demo: error against the time step",
        fmt::format(
            "line stretch to {:g} s on the mesh of the scene; truth: order 4 at {:.0e}, {} evaluations", end,
            with.truth_rtol, truth.found.evaluations),
        micrometre, micrometre_apart(demo), run.opening);
    const auto own_curve = [&](const char* method, const Scene& scene) {
        study.curves.push_back(own_steps(method, scene, run.steady_area, with.factors, truth.found.opening));
        check_the_truth(study.curves.back());
    };
    own_curve("midpoint, lines in subcycles", subcycles);
    own_curve("midpoint", plain);
    for (const OdeMethod& method : explicit_methods()) {
        if (method.multistep || method.order < with.lowest_order || method.order > with.highest_order)
            continue;
        Curve curve{fmt::format("order {}", method.order), adaptive_steps, {}};
        for (const double rtol : with.tolerances) {
            const Seen pair = by_pair(plain, run.steady_area, method, rtol, elements);
            if (!pair.failure.empty()) {
                fmt::print("order {} at {:.0e}: {}\n", method.order, rtol, pair.failure);
                continue;
            }
            curve.samples.push_back(sample_of(fmt::format("{:.0e}", rtol), pair.found, truth.found.opening));
            say(curve);
        }
        if (!curve.samples.empty()) study.curves.push_back(std::move(curve));
    }
    write(study, directory);
}

}  // namespace twinchute::bench
