#include "compare/validate/series_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "compare/parallel.hpp"
#include "lib/cli/exit_code.hpp"
#include "lib/record/metrics.hpp"
#include "lib/scene/keys.hpp"

namespace twinchute::compare {
namespace {

/// Metrics of a run, or why there are none.
struct CaseOutcome {
    std::map<std::string, double> metrics;
    std::string failure;
};

CaseOutcome outcome_of(const RunRecord& record) {
    CaseOutcome outcome;
    if (twinchute::exit_code(record.status.code) != ExitCode::done &&
        record.status.code != StatusCode::interrupted)
        outcome.failure = fmt::format("{}: {}", status_name(record.status.code), record.status.detail);
    for (const MetricRow& row : metric_rows())
        if (const auto value = record.metric(row.key)) outcome.metrics[std::string(row.name)] = *value;
    return outcome;
}

/// Medians of one case over its seeds: metrics that every run has.
std::map<std::string, double> medians(std::span<const CaseOutcome> outcomes) {
    std::map<std::string, double> middle;
    for (const auto& [name, value] : outcomes.front().metrics) {
        std::vector<double> values;
        for (const CaseOutcome& one : outcomes)
            if (const auto found = one.metrics.find(name); found != one.metrics.end())
                values.push_back(found->second);
        if (values.size() == outcomes.size()) middle[name] = median(values);
    }
    return middle;
}

RowResult judged(const ValidationCase& one, const ExpectedRow& row, std::string_view fidelity,
                 const std::vector<SeriesPoint>& points, const std::string& failure) {
    RowResult result;
    result.name = one.name;
    result.fidelity = fidelity;
    result.quantity = trend_words(*row.trend);
    result.expected = row.expected;
    result.source = row.source, result.grade = row.grade, result.where = row.where, result.note = row.note;
    const auto amount = [&](const Tolerance& given) {
        return given.relative ? given.value * std::abs(row.expected.value_or(0.0)) : given.value;
    };
    if (row.sigma) result.sigma_measured = amount(*row.sigma);
    if (row.tolerance)
        result.tolerance = amount(*row.tolerance);
    else if (row.sigma)
        result.tolerance = 2.0 * *result.sigma_measured;
    result.why = failure;
    if (failure.empty()) {
        result.predicted = trend_of(*row.trend, points);
        if (!result.predicted) result.why = "not every case has these metrics";
    }
    // Written so that a NaN is not within.
    const bool holds = result.predicted && result.expected && result.tolerance &&
                       std::abs(*result.predicted - *result.expected) <= *result.tolerance;
    const bool judged = row.judged && !row.grade.starts_with('D') && !row.grade.starts_with('R');
    result.verdict = !judged ? RowVerdict::not_judged : holds ? RowVerdict::within : RowVerdict::exceeded;
    return result;
}

}  // namespace

std::vector<RowResult> run_series(const ValidationCase& one, const CaseScene& scenes,
                                  const Fidelity& fidelity, const ValidationOptions& options) {
    const Key& seed = *find_key(scene_keys(), "full.noise.seed");
    const bool many = one.seeds > 0 && user_name(seed.user) == fidelity.name;
    const int seeds = !many ? 1 : options.quick ? quick_seeds : one.seeds;
    std::vector<Scene> runs;  // case by case, seed by seed
    std::vector<SeriesPoint> points;
    for (const Scene& scene : scenes.series())
        points.push_back({scene.case_name, scene.series ? scene.series->group : "", {}});
    for (int i = 1; i <= seeds; ++i)
        for (Scene& scene : scenes.series(many ? std::vector{fmt::format("{}={}", seed.path, i)}
                                               : std::vector<std::string>{}))
            runs.push_back(std::move(scene));
    std::vector<CaseOutcome> outcomes(runs.size());
    in_parallel(runs.size(), options.threads, [&](std::size_t i) {
        Run run;
        run.stop = options.stop;
        outcomes[i] = outcome_of(fidelity.run(runs[i], run));
    });
    std::string failure;
    for (std::size_t k = 0; k < points.size(); ++k) {
        std::vector<CaseOutcome> of_case;
        for (std::size_t i = k; i < outcomes.size(); i += points.size()) {
            of_case.push_back(outcomes[i]);
            if (failure.empty() && !outcomes[i].failure.empty())
                failure = fmt::format("{}, {}", points[k].name, outcomes[i].failure);
        }
        points[k].metrics = medians(of_case);
    }
    std::vector<RowResult> rows;
    for (const ExpectedRow& row : one.rows)
        if (row.fidelities.empty() ||
            std::ranges::find(row.fidelities, fidelity.name) != row.fidelities.end())
            rows.push_back(judged(one, row, fidelity.name, points, failure));
    return rows;
}

}  // namespace twinchute::compare
