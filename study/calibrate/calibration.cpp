#include "study/calibrate/calibration.hpp"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "lib/cli/command.hpp"
#include "lib/solve/stopwatch.hpp"
#include "study/calibrate/unknowns.hpp"

namespace twinchute::study {
namespace {

constexpr int starts_looked_at = 48, most_iterations = 40;
constexpr std::size_t starts_fitted = 4;
constexpr double apart = 0.3;                // [-] of an input's range, between two of these
constexpr std::size_t most_readings = 2000;  // of a history: more are thinned out
/// [-] of the ranges: where the weakest direction is known no better, a parameter is not seen.
constexpr double unseen = 0.15;
constexpr double closely_correlated = 0.9;

/// Every so many readings of a history that has very many: noise of neighbours is correlated by then.
std::vector<DropTest> thinned(const std::vector<DropTest>& tests, std::vector<std::string>& notes) {
    std::vector<DropTest> thin = tests;
    for (DropTest& test : thin)
        for (MeasuredHistory& history : test.histories) {
            const std::size_t stride = (history.time.size() + most_readings - 1) / most_readings;
            if (stride <= 1) continue;
            notes.push_back(fmt::format("{}: of {} readings of the {} every {}th is used", test.name,
                                        history.time.size(), history.kind->name, stride));
            std::size_t kept = 0;
            for (std::size_t i = 0; i < history.time.size(); i += stride, ++kept) {
                history.time[kept] = history.time[i];
                history.value[kept] = history.value[i];
            }
            history.time.resize(kept);
            history.value.resize(kept);
        }
    return thin;
}

/// Heights of the tests become altitudes, above the ground of each.
std::vector<FittedTest> fitted_tests(const SceneWith& scene_with, std::vector<DropTest>& tests,
                                     const Fidelity& fidelity, const std::vector<Unknown>& unknowns) {
    std::vector<std::string> keys;
    std::vector<KeyValue> low, high;
    for (const Unknown& unknown : unknowns) {
        if (unknown.kind != Unknown::Kind::key) continue;
        keys.push_back(unknown.name);
        low.emplace_back(unknown.variable.low), high.emplace_back(unknown.variable.high);
    }
    const std::vector<double> probe = probe_of(unknowns);
    std::vector<FittedTest> fitted;
    fitted.reserve(tests.size());
    for (DropTest& test : tests) {
        const SceneWith with_conditions = [&scene_with, &test](const std::vector<std::string>& more) {
            std::vector<std::string> all;
            for (const std::string& condition : test.conditions)
                all.push_back("--to " + condition);
            all.insert(all.end(), more.begin(), more.end());
            return scene_with(all);
        };
        VariedScene varied(with_conditions, keys, probe);
        varied.check_corners(low, high);
        for (MeasuredHistory& history : test.histories)
            for (double& height : history.value)
                if (history.kind->name == "height") height += varied.base().environment.ground;
        fitted.emplace_back(test, fidelity, std::move(varied));
    }
    return fitted;
}

/// The most likely of many starts, each with the best clocks for it.
std::vector<std::vector<double>> best_starts(const Likelihood& likelihood, const FitProblem& problem,
                                             const std::stop_token& stop) {
    std::vector<bool> looked_for;
    bool any_history = false;
    for (const Unknown& unknown : likelihood.unknowns())
        looked_for.push_back(unknown.kind == Unknown::Kind::key);
    for (const FittedTest& one : likelihood.tests())
        any_history = any_history || !one.test.histories.empty();
    std::vector<std::pair<double, std::vector<double>>> found;
    for (std::vector<double>& point : start_points(problem, looked_for, starts_looked_at)) {
        if (stop.stop_requested()) break;
        const auto sum = any_history ? likelihood.look_for_clocks(point) : sum_of_squares(problem, point);
        if (sum && std::isfinite(*sum)) found.emplace_back(*sum, std::move(point));
    }
    std::ranges::stable_sort(found, {}, &std::pair<double, std::vector<double>>::first);
    // From as many valleys as there may be: each start is apart from those before it in some input.
    const auto is_apart = [&](const std::vector<double>& one, const std::vector<double>& other) {
        for (std::size_t i = 0; i < one.size(); ++i) {
            const FitVariable& v = problem.variables[i];
            if (looked_for[i] && std::abs(v.to_scale(one[i]) - v.to_scale(other[i])) > apart * v.range())
                return true;
        }
        return false;
    };
    std::vector<std::vector<double>> starts;
    for (const auto& one : found)
        if (starts.size() < starts_fitted &&
            std::ranges::all_of(starts, [&](const auto& before) { return is_apart(one.second, before); }))
            starts.push_back(one.second);
    return starts;
}

/// Optima, the best first: what is found from each start. Several of them where the sum of squares has
/// several valleys, as of a pulse between a few readings.
std::vector<FitResult> optima_from(const FitProblem& problem, const std::vector<std::vector<double>>& starts,
                                   const std::vector<bool>& free, const std::stop_token& stop) {
    std::vector<FitResult> optima;
    for (const std::vector<double>& start : starts) {
        if (stop.stop_requested()) break;
        FitResult one = fit_from(problem, start, free, most_iterations);
        if (std::isfinite(one.sum)) optima.push_back(std::move(one));
    }
    std::ranges::stable_sort(optima, {}, &FitResult::sum);
    return optima;
}

std::vector<std::vector<double>> values_of(const std::vector<FitResult>& optima) {
    std::vector<std::vector<double>> values;
    for (const FitResult& one : optima)
        values.push_back(one.values);
    return values;
}

std::size_t count_free(const std::vector<bool>& free) {
    return static_cast<std::size_t>(std::ranges::count(free, true));
}

/// Fits again with the noise that the residuals show, and holds what the tests do not see. What is held moves
/// the valleys, so that each is fitted again then.
void settle(Likelihood& likelihood, std::vector<FitResult>& optima, std::vector<bool>& free,
            std::vector<std::string>& why, const std::stop_token& stop) {
    for (int round = 0; round < 3 + static_cast<int>(free.size()); ++round) {
        likelihood.learn_noise(optima.front().values, count_free(free));
        const FitProblem problem = likelihood.problem();
        std::vector<FitResult> again = optima_from(problem, values_of(optima), free, stop);
        if (again.empty()) return;
        optima = std::move(again);
        const FitResult& best = optima.front();
        const auto J = jacobian(problem, best.values, free);
        const auto least = J ? weakest(*J, problem, free) : std::nullopt;
        if (least && least->share > unseen) {
            const std::size_t i = least->variable;
            free[i] = false;
            for (FitResult& one : optima)
                one.values[i] = problem.variables[i].start;
            why[i] = "the tests do not see it";
            if (count_free(free) == 0) return;
        } else if (round >= 2) {
            break;
        }
    }
}

/// [-] By which the sum of squares rises at the end of a 95 % interval.
double rise_of_95(const Likelihood& likelihood, std::size_t parameters) {
    if (likelihood.all_sigma_given()) return gsl_cdf_chisq_Pinv(0.95, 1.0);
    const double freedom =
        std::max(1.0, static_cast<double>(likelihood.data()) - static_cast<double>(parameters));
    const double t = gsl_cdf_tdist_Pinv(0.975, freedom);
    return t * t;
}

/// Each test fitted by itself, and the scatter of each input from test to test: what they differ by beyond
/// their own uncertainty (DerSimonian and Laird, Controlled Clinical Trials 7 (1986) 177).
void add_scatter(Calibration& calibration, std::vector<FittedTest>& tests, const Likelihood& all,
                 const std::vector<double>& values, const std::vector<bool>& free) {
    calibration.alone.assign(tests.size(), std::vector<std::optional<double>>(values.size()));
    std::vector<std::vector<std::pair<double, double>>> found(values.size());
    for (std::size_t t = 0; t < tests.size(); ++t) {
        const Likelihood alone(tests, all.unknowns(), t);
        std::vector<bool> own = free;
        for (std::size_t i = 0; i < own.size(); ++i)
            if (all.unknowns()[i].kind == Unknown::Kind::clock && all.unknowns()[i].test != t) own[i] = false;
        const FitProblem problem = alone.problem();
        const FitResult one = fit_from(problem, values, own, most_iterations);
        const auto J = jacobian(problem, one.values, own);
        if (!J) continue;
        const auto least = weakest(*J, problem, own);
        if (!least || least->share > unseen) continue;
        const Eigen::MatrixXd covariance = covariance_of(*J, own);
        for (std::size_t i = 0; i < values.size(); ++i)
            if (own[i] && all.unknowns()[i].kind == Unknown::Kind::key) {
                calibration.alone[t][i] = one.values[i];
                found[i].emplace_back(problem.variables[i].to_scale(one.values[i]),
                                      covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)));
            }
    }
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (found[i].size() < 2) continue;
        double weights = 0.0, squares = 0.0, mean = 0.0, heterogeneity = 0.0;
        for (const auto& [value, variance] : found[i]) {
            weights += 1.0 / variance;
            squares += 1.0 / (variance * variance);
            mean += value / variance;
        }
        mean /= weights;
        for (const auto& [value, variance] : found[i])
            heterogeneity += (value - mean) * (value - mean) / variance;
        const double beyond = heterogeneity - static_cast<double>(found[i].size() - 1);
        calibration.parameters[i].scatter = std::sqrt(std::max(0.0, beyond / (weights - squares / weights)));
    }
}

/// An interval of a mean over tests that scatter is wider than that of the same value in all of them.
void widen(Parameter& p, std::size_t tests) {
    if (!p.scatter || !(*p.scatter > 0.0) || !(p.sigma > 0.0)) return;
    const FitVariable& v = p.unknown.variable;
    const double factor =
        std::sqrt(1.0 + *p.scatter * *p.scatter / (static_cast<double>(tests) * p.sigma * p.sigma));
    const double centre = v.to_scale(p.estimate);
    const auto moved = [&](double end) {
        return std::clamp(v.from_scale(centre + factor * (v.to_scale(end) - centre)), v.low, v.high);
    };
    p.interval.low = moved(p.interval.low);
    p.interval.high = moved(p.interval.high);
    p.interval.low_open = p.interval.low_open || p.interval.low <= v.low;
    p.interval.high_open = p.interval.high_open || p.interval.high >= v.high;
}

/// Whether two optima are one, to a thousandth of the ranges.
bool is_same(const FitProblem& problem, const FitResult& one, const FitResult& other) {
    for (std::size_t i = 0; i < one.values.size(); ++i) {
        const FitVariable& v = problem.variables[i];
        if (std::abs(v.to_scale(one.values[i]) - v.to_scale(other.values[i])) > 1e-3 * v.range())
            return false;
    }
    return true;
}

/// Takes into the intervals what other valleys hold that are nearly as deep as the best one.
void take_in_other_valleys(Calibration& calibration, const FitProblem& problem,
                           const std::vector<FitResult>& optima, const std::vector<bool>& free, double rise) {
    for (const FitResult& other : optima) {
        const double left = rise - (other.sum - optima.front().sum);
        if (!(left > 0.0) || is_same(problem, optima.front(), other)) continue;
        const auto J = jacobian(problem, other.values, free);
        if (!J) continue;
        const Eigen::MatrixXd covariance = covariance_of(*J, free);
        std::string where;
        for (std::size_t i = 0; i < free.size(); ++i) {
            if (!free[i]) continue;
            Parameter& p = calibration.parameters[i];
            const ProfileInterval own =
                profile_interval(problem, other, covariance, std::vector<bool>(free.size(), true), i, left);
            p.interval = {std::min(p.interval.low, own.low), std::max(p.interval.high, own.high),
                          p.interval.low_open || own.low_open, p.interval.high_open || own.high_open};
            where += fmt::format("{}{} = {:.4g}", where.empty() ? "" : ", ", p.label(), other.values[i]);
        }
        calibration.notes.push_back(fmt::format(
            "other values explain the tests nearly as well, and the intervals reach to them: {}", where));
    }
}

void add_parameters(Calibration& calibration, const Likelihood& likelihood,
                    const std::vector<FitResult>& optima, const std::vector<bool>& free,
                    const std::vector<std::string>& why, std::size_t tests) {
    const FitResult& best = optima.front();
    const double rise = rise_of_95(likelihood, count_free(free));
    const FitProblem problem = likelihood.problem();
    // What is held is not known: within its bounds it may make up for the others.
    const std::vector<bool> all(free.size(), true);
    for (std::size_t i = 0; i < best.values.size(); ++i) {
        const Unknown& unknown = likelihood.unknowns()[i];
        Parameter p;
        p.unknown = unknown;
        p.estimate = best.values[i];
        p.start = unknown.variable.start;
        p.held = !free[i];
        p.why = why[i];
        p.tests = tests;
        p.interval = {unknown.variable.low, unknown.variable.high, true, true};
        if (free[i]) {
            const auto k = static_cast<Eigen::Index>(i);
            p.sigma = std::sqrt(std::max(0.0, calibration.covariance(k, k)));
            p.interval = profile_interval(problem, best, calibration.covariance, all, i, rise);
        }
        calibration.parameters.push_back(std::move(p));
    }
    take_in_other_valleys(calibration, problem, optima, free, rise);
}

/// Ljung and Box, Biometrika 65 (1978) 297: sum of squared correlations up to some lags.
double probability_of_structure(const std::vector<double>& white) {
    const std::size_t n = white.size(), lags = std::min<std::size_t>(20, n / 5);
    if (lags == 0) return 1.0;
    const double power = std::inner_product(white.begin(), white.end(), white.begin(), 0.0);
    double q = 0.0;
    for (std::size_t k = 1; k <= lags; ++k) {
        const double product = std::inner_product(white.begin() + static_cast<std::ptrdiff_t>(k), white.end(),
                                                  white.begin(), 0.0) /
                               power;
        q += product * product / static_cast<double>(n - k);
    }
    return gsl_cdf_chisq_Q(static_cast<double>(n) * static_cast<double>(n + 2) * q,
                           static_cast<double>(lags));
}

void add_fits(Calibration& calibration, const Likelihood& likelihood, const std::vector<double>& values) {
    for (std::size_t t = 0; t < likelihood.tests().size(); ++t) {
        const FittedTest& one = likelihood.tests()[t];
        const auto model = likelihood.predicted(t, values);
        if (!model) continue;
        for (std::size_t h = 0; h < one.test.histories.size(); ++h) {
            const MeasuredHistory& measured = one.test.histories[h];
            HistoryFit fit{&one.test, measured, model->histories[h], one.used[h], one.noise[h], 0.0,
                           0.0,       1.0};
            std::vector<double> white;
            double sum = 0.0, product = 0.0, before = 0.0, time = 0.0;
            for (std::size_t i = 0; i < measured.time.size(); ++i) {
                if (!fit.used[i]) continue;
                const double left = measured.value[i] - fit.model[i];
                sum += left * left;
                product += left * before;
                const double memory = white.empty() || !(fit.noise.memory > 0.0)
                                          ? 0.0
                                          : std::exp(-(measured.time[i] - time) / fit.noise.memory);
                white.push_back(left - memory * before);
                before = left;
                time = measured.time[i];
            }
            if (!white.empty()) fit.rms = std::sqrt(sum / static_cast<double>(white.size()));
            if (sum > 0.0) fit.first_lag = product / sum;
            fit.structure = sum > 0.0 ? probability_of_structure(white) : 1.0;
            calibration.histories.push_back(std::move(fit));
        }
        for (std::size_t s = 0; s < one.test.scalars.size(); ++s)
            calibration.scalars.push_back({&one.test, &one.test.scalars[s], model->scalars[s]});
    }
}

/// Says where a test has hardly a reading of the filling: the sum of squares is then a landscape of valleys,
/// and no interval of what the filling alone tells is to be relied on. A record has its answers beside its
/// readings.
void note_sparse_readings(Calibration& calibration, const Likelihood& likelihood,
                          const std::vector<double>& values) {
    constexpr int few = 6;
    bool any = false, all = true;
    for (std::size_t t = 0; t < likelihood.tests().size(); ++t) {
        const FittedTest& one = likelihood.tests()[t];
        const auto [begin, end] = one.prediction.filling(likelihood.scene_of(t, values));
        int most = 0;
        for (std::size_t h = 0; h < one.test.histories.size() && end > begin; ++h) {
            int count = 0;
            for (std::size_t i = 0; i < one.test.histories[h].time.size(); ++i) {
                const double time = one.test.histories[h].time[i] - likelihood.offset_of(t, values);
                count += one.used[h][i] && time >= begin && time <= end ? 1 : 0;
            }
            most = std::max(most, count);
        }
        if (one.test.is_record || one.test.histories.empty() || !(end > begin)) continue;
        any = true;
        all = all && most < few;
        if (most < few)
            calibration.notes.push_back(
                fmt::format("{}: {} readings lie within the filling of {:.2g} s: what it alone sees, the "
                            "fill constant, the "
                            "initial ratio and the clock, is not to be relied on",
                            one.test.name, most, end - begin));
    }
    if (!any || !all) return;
    for (Parameter& p : calibration.parameters) {
        const std::string& name = p.unknown.name;
        const bool of_filling = p.unknown.kind == Unknown::Kind::clock || name.ends_with(".fill_time.n") ||
                                name.ends_with(".initial_drag_area_ratio") ||
                                name.ends_with(".drag_area_exponent");
        if (!of_filling || p.held) continue;
        p.identified = false;
        p.why = "too few readings lie within the filling";
    }
}

void add_pairs(Calibration& calibration) {
    for (std::size_t i = 0; i < calibration.parameters.size(); ++i)
        for (std::size_t j = i + 1; j < calibration.parameters.size(); ++j)
            if (const double r = calibration.correlation(i, j); std::abs(r) > closely_correlated)
                calibration.pairs.push_back({i, j, r});
}

}  // namespace

std::string Parameter::label() const {
    if (unknown.kind != Unknown::Kind::clock || tests < 2) return unknown.name;
    return fmt::format("{}.{}", unknown.name, unknown.test + 1);
}

double Calibration::correlation(std::size_t i, std::size_t j) const {
    const auto a = static_cast<Eigen::Index>(i), b = static_cast<Eigen::Index>(j);
    const double size = std::sqrt(covariance(a, a) * covariance(b, b));
    return i == j ? 1.0 : size > 0.0 ? covariance(a, b) / size : 0.0;
}

const Parameter* Calibration::find(std::string_view name) const {
    const auto found =
        std::ranges::find_if(parameters, [&](const Parameter& p) { return p.unknown.name == name; });
    return found == parameters.end() ? nullptr : &*found;
}

Calibration calibrate(const SceneWith& scene_with, const std::vector<DropTest>& tests,
                      const Fidelity& fidelity, const CalibrationSettings& settings) {
    const Stopwatch watch;
    Calibration result;
    const Scene scene = scene_with({});
    const std::vector<Unknown> unknowns = unknowns_of(scene, tests, settings.vary);
    std::vector<DropTest> thin = thinned(tests, result.notes);
    for (const DropTest& test : tests)
        result.notes.insert(result.notes.end(), test.notes.begin(), test.notes.end());
    std::vector<FittedTest> fitted = fitted_tests(scene_with, thin, fidelity, unknowns);
    Likelihood likelihood(fitted, unknowns);
    std::vector<bool> free(unknowns.size(), true);
    std::vector<std::string> why(unknowns.size());
    const auto give_up = [&](const std::string& reason) {
        throw UsageError(fmt::format("{}: cannot be calibrated ({}), check the scene and the tests",
                                     scene.file.string(), reason));
    };

    std::vector<std::vector<double>> starts = best_starts(likelihood, likelihood.problem(), settings.stop);
    if (settings.stop.stop_requested()) return result.interrupted = true, result;
    if (starts.empty()) give_up("the model runs with none of the values inside the bounds");
    if (!likelihood.leave_out_before_release(starts.front()))
        give_up(
            "at the likeliest clock a history lies wholly before the release, nothing in it is like the "
            "drop");
    std::vector<FitResult> optima = optima_from(likelihood.problem(), starts, free, settings.stop);
    if (settings.stop.stop_requested()) return result.interrupted = true, result;
    if (optima.empty()) give_up("the model fails near every start");
    settle(likelihood, optima, free, why, settings.stop);
    if (settings.stop.stop_requested()) return result.interrupted = true, result;
    const FitResult& best = optima.front();
    if (count_free(free) == 0)
        give_up("the tests see none of its inputs, as with a clock that is off by more than its bounds");

    const FitProblem problem = likelihood.problem();
    const auto J = jacobian(problem, best.values, free);
    if (!J) give_up("the model fails beside the best values");
    result.covariance = covariance_of(*J, free);
    add_parameters(result, likelihood, optima, free, why, tests.size());
    add_scatter(result, fitted, likelihood, best.values, free);
    for (Parameter& p : result.parameters) {
        widen(p, tests.size());
        p.identified = !p.held && !p.interval.low_open && !p.interval.high_open;
        if (!p.held && !p.identified) p.why = "its interval reaches a bound";
    }
    add_pairs(result);
    note_sparse_readings(result, likelihood, best.values);
    result.sum = best.sum;
    result.readings = likelihood.readings();
    result.fitted = count_free(free);
    result.sigma_given = likelihood.all_sigma_given();
    add_fits(result, likelihood, best.values);
    judge_consistency(result, fitted, best.values, free, likelihood);
    result.runs = likelihood.runs();
    result.seconds = watch.wall();
    if (settings.predict) predict_next_drop(result, scene_with, fidelity, settings.stop);
    result.interrupted = settings.stop.stop_requested();
    // The thinned tests end here.
    const auto whole = [&](const DropTest*& test) {
        test = &tests[static_cast<std::size_t>(test - thin.data())];
    };
    for (HistoryFit& fit : result.histories)
        whole(fit.test);
    for (ScalarFit& fit : result.scalars) {
        const auto index = static_cast<std::size_t>(fit.measured - fit.test->scalars.data());
        whole(fit.test);
        fit.measured = &fit.test->scalars[index];
    }
    return result;
}

}  // namespace twinchute::study
