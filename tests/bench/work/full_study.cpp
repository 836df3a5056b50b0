#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "lib/scene/read_scene.hpp"
#include "lib/solve/stopwatch.hpp"
#include "tests/bench/work/study.hpp"
#include "tests/support/time_integration.hpp"

namespace twinchute::bench {
namespace {

struct Interval {
    std::string name, title;
    Scene scene;
    double end;         ///< [s]
    double truth_rtol;  ///< of the pair of order 4 that is the truth in time
    std::vector<double> tolerances;
};

Sample sample_of(const std::string& setting, const test::Marched& run, double seconds,
                 const test::Marched& truth, double length) {
    return {setting, run.evaluations, seconds, test::distance(run, truth) / length,
            std::abs(run.force / truth.force - 1.0)};
}

void measure(const Interval& interval, const std::filesystem::path& directory) {
    const test::Marched truth =
        test::by_sundials(interval.scene, *find_ode_method("zonneveld"), {interval.truth_rtol}, interval.end);
    const double length = interval.scene.parachutes.front().nominal_diameter;
    Study study{
        interval.name,
        interval.title,
        fmt::format("largest critical time steps at the left ends; truth: order 4 at {:.0e}, {} evaluations",
                    interval.truth_rtol, truth.evaluations),
        "place, rms of all nodes over D0",
        {}};
    const auto timed = [&](Curve& curve, const std::string& setting,
                           const std::function<test::Marched()>& run) {
        const Stopwatch watch;
        const test::Marched found = run();
        const double seconds = watch.wall();
        if (!found.failure.empty()) {
            fmt::print("{}, {} at {}: {}\n", interval.name, curve.method, setting, found.failure);
            return;
        }
        curve.samples.push_back(sample_of(setting, found, seconds, truth, length));
        const Sample& s = curve.samples.back();
        fmt::print("{}, {} at {}: {} evaluations, {:.3g} s, place {:.2e}, force {:.2e}\n", interval.name,
                   curve.method, setting, s.evaluations, s.seconds, s.error, s.other_error);
        std::fflush(stdout);
    };
    Curve midpoint{"midpoint", own_rule, {}};
    for (const double factor : {0.95, 0.475, 0.2375, 0.11875}) {
        Scene scene = interval.scene;
        scene.full.line_substeps = 1;  // so early none are taken anyway
        scene.full.time_step_factor = factor;
        timed(midpoint, fmt::format("{:g}", factor), [&] { return test::by_own_steps(scene, interval.end); });
    }
    study.curves.push_back(std::move(midpoint));
    for (const OdeMethod& method : explicit_methods()) {
        if (method.multistep) continue;
        Curve curve{fmt::format("order {}", method.order), adaptive_steps, {}};
        // A method of order 2 needs millions of evaluations at a tight tolerance.
        for (const double rtol : interval.tolerances)
            if (method.order > 2 || rtol > 1e-5)
                timed(curve, fmt::format("{:.0e}", rtol),
                      [&] { return test::by_sundials(interval.scene, method, {rtol}, interval.end); });
        study.curves.push_back(std::move(curve));
    }
    // Even steps, in those that the model's own step takes at its largest; how long they may be at most is
    // what control by tolerance finds out.
    Scene scene = interval.scene;
    scene.full.line_substeps = 1;
    const auto steps = static_cast<double>(test::by_own_steps(scene, interval.end).evaluations);
    for (const OdeMethod& method : explicit_methods()) {
        if (method.multistep || method.order == 2) continue;
        Curve curve{fmt::format("even, order {}", method.order), even_steps, {}};
        for (const double share : {1.0, 0.8, 0.6, 0.3}) {
            const double dt = share * interval.end / steps;
            timed(curve, fmt::format("{:g}", share), [&] {
                return test::by_sundials(interval.scene, method, {1e-6, dt}, interval.end);
            });
        }
        if (!curve.samples.empty()) study.curves.push_back(std::move(curve));
    }
    write(study, directory);
}

}  // namespace

void study_full(const std::filesystem::path& directory, bool quick) {
    Scene scene = read_scene(TWINCHUTE_SOURCE_DIR "/data/scenes/c9-inflation.toml");
    // Contact is a kink at each meeting of two nodes: what is compared here are methods, on the paper's
    // canopy.
    scene.full.contact = Contact::none;
    scene.full.mesh = {2, 17, 31, 5};
    if (quick) {
        scene.parachutes.front().gores = 8;
        scene.parachutes.front().risers = 1;
        scene.full.mesh = {2, 5, 4, 1};
        return measure({"full-quick", "Steps of the full model", scene, 0.01, 1e-8, {1e-4}}, directory);
    }
    measure({"full-beginning",
             "Time steps of the full model: the first 0.3 s of the demo",
             scene,
             0.3,
             1e-9,
             {1e-4, 1e-6, 1e-8}},
            directory);
}

}  // namespace twinchute::bench
