// Causes of residuals other than noise. Each is tried as one more parameter, and the likeliest is named where
// the fit with it is better by more than chance allows; others where they explain what it leaves.
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
constexpr int few_iterations = 30;

constexpr double most_of_it = 0.5;   // [-] of the misfit beyond noise: less explains nothing,
constexpr double little_left = 1.5;  // [-] unless little is left: variances are seldom known better

/// One cause, tried as one more unknown.
struct Fault {
    Unknown unknown;
    FitResult fit;        // with it
    double better = 0.0;  // fall of the sum of squares
    Finding finding;
};

/// The fit to be judged, and its data.
struct Trial {
    Calibration& calibration;
    std::vector<FittedTest>& tests;
    const std::vector<double>& values;
    const std::vector<bool>& free;
    const Likelihood& likelihood;
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

/// The values with the scene's own inputs.
std::vector<double> values_of_scene(const Trial& trial) {
    std::vector<double> own = trial.values;
    for (std::size_t i = 0; i < own.size(); ++i) {
        const Unknown& unknown = trial.likelihood.unknowns()[i];
        if (unknown.kind == Unknown::Kind::key) own[i] = unknown.variable.start;
    }
    return own;
}

/// Reading over what the model of the scene's own inputs has, by least squares.
double scale_of_scene(const Trial& trial, std::size_t t, std::size_t h) {
    const auto model = trial.likelihood.predicted(t, values_of_scene(trial));
    if (!model) return 1.0;
    const FittedTest& one = trial.tests[t];
    double product = 0.0, square = 0.0;
    for (std::size_t i = 0; i < model->histories[h].size(); ++i) {
        if (!one.used[h][i]) continue;
        product += model->histories[h][i] * one.test.histories[h].value[i];
        square += model->histories[h][i] * model->histories[h][i];
    }
    return square > 0.0 ? product / square : 1.0;
}

/// The fit with more unknowns: from where the fit without them ended, which a fault may have driven to a
/// bound, and from the scene's own inputs.
FitResult fit_with(const Trial& trial, const std::vector<Unknown>& more) {
    std::vector<Unknown> unknowns = trial.likelihood.unknowns();
    std::vector<double> found = trial.values, own = values_of_scene(trial);
    std::vector<bool> all = trial.free;
    for (const Unknown& one : more) {
        unknowns.push_back(one);
        found.push_back(one.variable.start);
        own.push_back(one.variable.start);
        all.push_back(true);
    }
    const Likelihood wider(trial.tests, unknowns);
    FitResult near = fit_from(wider.problem(), found, all, few_iterations),
              far = fit_from(wider.problem(), own, all, few_iterations);
    return far.sum < near.sum ? far : near;
}

std::string of_test(const Calibration& calibration, const DropTest& test) {
    const auto first = calibration.histories.empty() ? nullptr : calibration.histories.front().test;
    const bool several =
        std::ranges::any_of(calibration.histories, [&](const HistoryFit& f) { return f.test != first; });
    return several ? " of " + test.name : std::string();
}

void look_for_scale(std::vector<Fault>& found, const Trial& trial, std::size_t t, std::size_t h) {
    const HistoryKind& kind = *trial.tests[t].test.histories[h].kind;
    Unknown scale;
    scale.kind = Unknown::Kind::scale;
    scale.test = t, scale.history = h;
    scale.variable = {1.0, 0.2, 5.0, true, 1e-3};
    scale.variable.start = std::clamp(scale_of_scene(trial, t, h), 0.25, 4.0);
    FitResult fit = fit_with(trial, {scale});
    const double value = fit.values.back();
    const double better = improvement(trial.likelihood, trial.calibration.sum, fit.sum);
    if (better < much_better || std::abs(value - 1.0) < least_scale) return;
    found.push_back(
        {scale,
         std::move(fit),
         better,
         {fmt::format(
              "the scale of the {} sensor{} looks wrong: its readings are {} of what the model's would be",
              kind.name, of_test(trial.calibration, trial.tests[t].test),
              fmt::format("{:.1f} %", 100.0 * value)),
          fmt::format(
              "with that factor the misfit falls by {} (20 is beyond chance); a load is held against the "
              "weight that it ends at",
              readable(better, 3)),
          "check calibration and unit of the sensor, and the mass of the payload",
          {}}});
}

void look_for_clock(std::vector<Fault>& found, const Trial& trial, std::size_t t) {
    Unknown clock;
    clock.kind = Unknown::Kind::clock;
    clock.name = clock_offset;
    clock.test = t;
    clock.variable = {0.0, -5.0, 5.0, false, 1e-3};
    FitResult fit = fit_with(trial, {clock});
    const double value = fit.values.back();
    const double better = improvement(trial.likelihood, trial.calibration.sum, fit.sum);
    if (better < much_better || std::abs(value) < least_clock) return;
    found.push_back(
        {clock,
         std::move(fit),
         better,
         {fmt::format("the clock{} looks wrong by {:+.3f} s, which is said to be known",
                      of_test(trial.calibration, trial.tests[t].test), value),
          fmt::format("with that offset the misfit falls by {} (20 is beyond chance)", readable(better, 3)),
          "check what its time counts from, or take clock = \"known\" out",
          {}}});
}

/// Whether the faults that were found leave nothing more to explain.
bool is_explained(const Trial& trial, const FitResult& corrected) {
    if (trial.calibration.findings.empty()) return false;
    const double freedom = freedom_of(trial.likelihood, trial.calibration);
    return trial.calibration.sigma_given ? corrected.sum < little_left * freedom
                                         : corrected.sum < most_of_it * trial.calibration.sum;
}

/// Takes in the likeliest fault, and of the others those that explain what it leaves over, by as much as
/// chance does not. The rest follow from these. Gives the fit with them.
FitResult take_faults(const Trial& trial, std::vector<Fault>& found) {
    std::ranges::stable_sort(found, std::ranges::greater{}, &Fault::better);
    FitResult corrected{trial.values, trial.calibration.sum, true};
    std::vector<Unknown> taken;
    for (Fault& one : found) {
        std::vector<Unknown> more = taken;
        more.push_back(one.unknown);
        FitResult fit = taken.empty() ? one.fit : fit_with(trial, more);
        auto& findings = trial.calibration.findings;
        if (improvement(trial.likelihood, corrected.sum, fit.sum) < much_better) {
            findings.front().explains.push_back(fmt::format("by itself {}, by which the misfit falls by {}",
                                                            one.finding.what, readable(one.better, 3)));
            continue;
        }
        findings.push_back(std::move(one.finding));
        taken = std::move(more);
        corrected = std::move(fit);
    }
    // Faults that leave much mend another canopy a little: all of them stand where hardly anything is left,
    // the first alone where it explains most.
    if (is_explained(trial, corrected) || taken.empty()) return corrected;
    const bool stands = explains(trial.likelihood, trial.calibration, found.front().fit.sum);
    trial.calibration.findings.resize(stands ? 1 : 0);
    return stands ? found.front().fit : FitResult{trial.values, trial.calibration.sum, true};
}

/// Takes in what was found: as a cause, or as what the likeliest fault explains.
void take(Calibration& calibration, Finding finding, bool explained) {
    if (explained)
        calibration.findings.front().explains.push_back(std::move(finding.what));
    else
        calibration.findings.push_back(std::move(finding));
}

void look_at_bounds(Calibration& calibration, const FitResult& corrected) {
    const bool any_fault = !calibration.findings.empty();
    for (std::size_t i = 0; i < calibration.parameters.size(); ++i) {
        const Parameter& p = calibration.parameters[i];
        if (p.held || !p.unknown.variable.is_at_bound(p.estimate)) continue;
        const bool drag = p.unknown.name.ends_with("drag_area");
        take(calibration,
             {fmt::format("{} is on its bound, {}{}", p.label(), readable(p.estimate),
                          p.unknown.unit.empty() ? "" : " " + p.unknown.unit),
              drag ? "the tests ask for a canopy of another drag area than this scene can mean"
                   : "the tests ask for more than it may be",
              p.unknown.kind == Unknown::Kind::clock
                  ? "check what the clock counts from, or widen it with --vary clock_offset=LO..HI"
              : drag ? fmt::format("is the test of this canopy? Otherwise widen it with --vary {}=LO..HI",
                                   p.unknown.name)
                     : fmt::format("widen it with --vary {}=LO..HI, or vary what else may be wrong",
                                   p.unknown.name),
              {}},
             any_fault && !p.unknown.variable.is_at_bound(corrected.values[i]));
    }
}

/// Judges the residuals, with and without the faults that were found.
void look_at_rest(const Trial& trial, const FitResult& corrected) {
    Calibration& calibration = trial.calibration;
    const double freedom = freedom_of(trial.likelihood, calibration);
    const bool measured =
        std::ranges::none_of(calibration.histories, [](const HistoryFit& f) { return f.test->is_record; });
    const bool judged = calibration.sigma_given && measured && freedom > 0.0;
    const double p_value = judged ? gsl_cdf_chisq_Q(calibration.sum, freedom) : 1.0;
    const bool explained = is_explained(trial, corrected);
    if (p_value < smallest_p_value)
        take(calibration,
             {fmt::format("the model misses the tests by {:.2g} times their uncertainty",
                          std::sqrt(calibration.sum / freedom)),
              fmt::format("chi-square is {} where {} are expected, which noise does once in {:.0e} cases",
                          readable(calibration.sum), readable(freedom), 1.0 / std::max(p_value, 1e-99)),
              "another canopy, another law of growth or another deployment than the scene's; or the "
              "uncertainty is larger",
              {}},
             explained);
    if (!measured) return;
    for (const HistoryFit& fit : calibration.histories) {
        // A history says nothing of structure where nobody knows its noise and nothing is left over to speak
        // of.
        const double misfit = fit.rms / fit.measured.largest();
        if (!(fit.structure < smallest_p_value) || misfit < least_misfit ||
            (fit.noise.given && p_value >= smallest_p_value))
            continue;
        take(calibration,
             {fmt::format("what is left over of the {} hangs together: {:.1f} % of its largest reading, with "
                          "a correlation "
                          "of {:.2f} from one reading to the next",
                          fit.measured.kind->name, 100.0 * misfit, fit.first_lag),
              "noise does not do so: the history has another shape than the model can take",
              "another canopy, another law of growth or another deployment than the scene's",
              {}},
             explained);
    }
}

}  // namespace

void judge_consistency(Calibration& calibration, std::vector<FittedTest>& tests,
                       const std::vector<double>& values, const std::vector<bool>& free,
                       const Likelihood& likelihood) {
    const Trial trial{calibration, tests, values, free, likelihood};
    std::vector<Fault> found;
    for (std::size_t t = 0; t < tests.size(); ++t) {
        if (tests[t].test.is_record) continue;
        for (std::size_t h = 0; h < tests[t].test.histories.size(); ++h)
            if (tests[t].test.histories[h].kind->is_load) look_for_scale(found, trial, t, h);
        if (tests[t].test.clock_known && !tests[t].test.histories.empty()) look_for_clock(found, trial, t);
    }
    const FitResult corrected = take_faults(trial, found);
    look_at_bounds(calibration, corrected);
    look_at_rest(trial, corrected);
}

}  // namespace twinchute::study
