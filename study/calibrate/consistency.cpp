// Causes of residuals other than noise. Each is tried as one more parameter, and named where the fit with it
// is better by more than chance allows.
#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>

#include "lib/cli/text.hpp"
#include "study/calibrate/calibration.hpp"

namespace twinchute::study {
namespace {

constexpr double smallest_p_value = 1e-4;  // probability below which noise alone is no explanation
constexpr double much_better = 20.0;       // [-] fall of the sum of squares: 4.5 standard deviations
constexpr double least_scale = 0.01;       // [-] a scale that is nearer to one is none to speak of
constexpr double least_clock = 2e-3;       // [s]
constexpr double least_misfit = 0.02;      // [-] of the largest reading: less structure is no other canopy
constexpr int few_iterations = 15;

constexpr double most_of_it = 0.5;   // [-] of the misfit beyond noise: less explains nothing,
constexpr double little_left = 1.5;  // [-] unless little is left: variances are seldom known better

struct Explanation {
    double better = 0.0;
    Finding finding;
};

/// Data less parameters.
double freedom_of(const Likelihood& likelihood, const Calibration& calibration) {
    return static_cast<double>(likelihood.data()) - static_cast<double>(calibration.fitted);
}

/// Fall of the sum of squares, in units of the noise; where that is learnt from the residuals itself, the
/// fall of what it would be (likelihood ratio).
double improvement(const Likelihood& likelihood, double before, double after) {
    if (likelihood.all_sigma_given()) return before - after;
    const auto count = static_cast<double>(likelihood.data());
    return after > 0.0 ? count * std::log(before / after) : 0.0;
}

/// Whether a fit with one more unknown is better than chance allows, and leaves little to explain.
bool explains(const Likelihood& likelihood, const Calibration& calibration, double after) {
    if (improvement(likelihood, calibration.sum, after) < much_better) return false;
    const double freedom = freedom_of(likelihood, calibration);
    if (!calibration.sigma_given || !(freedom > 0.0)) return true;
    const double beyond = calibration.sum - freedom;
    return after < little_left * freedom || calibration.sum - after > most_of_it * beyond;
}

/// The fit with one more unknown.
std::pair<double, double> fit_with(std::vector<FittedTest>& tests, const Likelihood& likelihood,
                                   const std::vector<double>& values, const std::vector<bool>& free,
                                   const Unknown& more) {
    std::vector<Unknown> unknowns = likelihood.unknowns();
    unknowns.push_back(more);
    const Likelihood wider(tests, unknowns);
    std::vector<double> start = values;
    start.push_back(more.variable.start);
    std::vector<bool> all = free;
    all.push_back(true);
    const FitResult fit = fit_from(wider.problem(), start, all, few_iterations);
    return {fit.sum, fit.values.back()};
}

std::string of_test(const Calibration& calibration, const DropTest& test) {
    const auto first = calibration.histories.empty() ? nullptr : calibration.histories.front().test;
    const bool several =
        std::ranges::any_of(calibration.histories, [&](const HistoryFit& f) { return f.test != first; });
    return several ? " of " + test.name : std::string();
}

void look_for_scale(std::vector<Explanation>& found, const Calibration& calibration,
                    std::vector<FittedTest>& tests, const std::vector<double>& values,
                    const std::vector<bool>& free, const Likelihood& likelihood, std::size_t t,
                    std::size_t h) {
    const HistoryKind& kind = *tests[t].test.histories[h].kind;
    Unknown scale;
    scale.kind = Unknown::Kind::scale;
    scale.test = t, scale.history = h;
    scale.variable = {1.0, 0.2, 5.0, true, 1e-3};
    const auto [sum, value] = fit_with(tests, likelihood, values, free, scale);
    const double better = improvement(likelihood, calibration.sum, sum);
    if (!explains(likelihood, calibration, sum) || std::abs(value - 1.0) < least_scale) return;
    found.push_back(
        {better,
         {fmt::format(
              "the scale of the {} sensor{} looks wrong: its readings are {} of what the model's would be",
              kind.name, of_test(calibration, tests[t].test), fmt::format("{:.1f} %", 100.0 * value)),
          fmt::format(
              "with that factor the misfit falls by {} (20 is beyond chance); a load is held against the "
              "weight that it ends at",
              readable(better, 3)),
          "check calibration and unit of the sensor, and the mass of the payload"}});
}

void look_for_clock(std::vector<Explanation>& found, const Calibration& calibration,
                    std::vector<FittedTest>& tests, const std::vector<double>& values,
                    const std::vector<bool>& free, const Likelihood& likelihood, std::size_t t) {
    Unknown clock;
    clock.kind = Unknown::Kind::clock;
    clock.name = clock_offset;
    clock.test = t;
    clock.variable = {0.0, -5.0, 5.0, false, 1e-3};
    const auto [sum, value] = fit_with(tests, likelihood, values, free, clock);
    const double better = improvement(likelihood, calibration.sum, sum);
    if (!explains(likelihood, calibration, sum) || std::abs(value) < least_clock) return;
    found.push_back(
        {better,
         {fmt::format("the clock{} looks wrong by {:+.3f} s, which is said to be known",
                      of_test(calibration, tests[t].test), value),
          fmt::format("with that offset the misfit falls by {} (20 is beyond chance)", readable(better, 3)),
          "check what its time counts from, or take clock = \"known\" out"}});
}

void look_at_bounds(Calibration& calibration) {
    for (const Parameter& p : calibration.parameters) {
        if (p.held || !p.unknown.variable.is_at_bound(p.estimate)) continue;
        const bool drag = p.unknown.name.ends_with("drag_area");
        calibration.findings.push_back(
            {fmt::format("{} is on its bound, {}{}", p.label(), readable(p.estimate),
                         p.unknown.unit.empty() ? "" : " " + p.unknown.unit),
             drag ? "the tests ask for a canopy of another drag area than this scene can mean"
                  : "the tests ask for more than it may be",
             p.unknown.kind == Unknown::Kind::clock
                 ? "check what the clock counts from, or widen it with --vary clock_offset=LO..HI"
             : drag ? fmt::format("is the test of this canopy? Otherwise widen it with --vary {}=LO..HI",
                                  p.unknown.name)
                    : fmt::format("widen it with --vary {}=LO..HI, or vary what else may be wrong",
                                  p.unknown.name)});
    }
}

/// Judges the residuals that no single cause explains.
void look_at_rest(Calibration& calibration, const Likelihood& likelihood) {
    const double freedom = freedom_of(likelihood, calibration);
    const bool measured =
        std::ranges::none_of(calibration.histories, [](const HistoryFit& f) { return f.test->is_record; });
    const bool judged = calibration.sigma_given && measured && freedom > 0.0;
    const double p_value = judged ? gsl_cdf_chisq_Q(calibration.sum, freedom) : 1.0;
    if (p_value < smallest_p_value)
        calibration.findings.push_back(
            {fmt::format("the model misses the tests by {:.2g} times their uncertainty",
                         std::sqrt(calibration.sum / freedom)),
             fmt::format("chi-square is {} where {} are expected, which noise does once in {:.0e} cases",
                         readable(calibration.sum), readable(freedom), 1.0 / std::max(p_value, 1e-99)),
             "another canopy, another law of growth or another deployment than the scene's; or the "
             "uncertainty is larger"});
    if (!measured) return;
    for (const HistoryFit& fit : calibration.histories) {
        // A history says nothing of structure where nobody knows its noise and nothing is left over to speak
        // of.
        const double misfit = fit.rms / fit.measured.largest();
        if (!(fit.structure < smallest_p_value) || misfit < least_misfit ||
            (fit.noise.given && p_value >= smallest_p_value))
            continue;
        calibration.findings.push_back(
            {fmt::format("what is left over of the {} hangs together: {:.1f} % of its largest reading, with "
                         "a correlation "
                         "of {:.2f} from one reading to the next",
                         fit.measured.kind->name, 100.0 * misfit, fit.first_lag),
             "noise does not do so: the history has another shape than the model can take",
             "another canopy, another law of growth or another deployment than the scene's"});
    }
}

}  // namespace

void judge_consistency(Calibration& calibration, std::vector<FittedTest>& tests,
                       const std::vector<double>& values, const std::vector<bool>& free,
                       const Likelihood& likelihood) {
    std::vector<Explanation> found;
    for (std::size_t t = 0; t < tests.size(); ++t) {
        if (tests[t].test.is_record) continue;
        for (std::size_t h = 0; h < tests[t].test.histories.size(); ++h)
            if (tests[t].test.histories[h].kind->is_load)
                look_for_scale(found, calibration, tests, values, free, likelihood, t, h);
        if (tests[t].test.clock_known && !tests[t].test.histories.empty())
            look_for_clock(found, calibration, tests, values, free, likelihood, t);
    }
    std::ranges::stable_sort(found, std::ranges::greater{}, &Explanation::better);
    for (Explanation& one : found)
        calibration.findings.push_back(std::move(one.finding));
    look_at_bounds(calibration);
    look_at_rest(calibration, likelihood);
}

}  // namespace twinchute::study
