#include "compare/ladder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "lib/cli/record_text.hpp"
#include "lib/scene/scene_id.hpp"
#include "lib/solve/stopwatch.hpp"

namespace twinchute::compare {
namespace {

/// Runs shorter than this are repeated, since other work on the machine only ever adds to their time.
constexpr double short_run = 0.2;       // [s]
constexpr double repeating_time = 0.3;  // [s] of one level in all
constexpr int most_repeats = 20;
/// A closed form is too quick for the clock: it is timed in batches.
constexpr int batches = 7, batch_size = 2000;

double median(std::vector<double> values) {
    std::ranges::sort(values);
    const std::size_t half = values.size() / 2;
    return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

std::optional<LevelMetric> metric_of(const RunRecord& record, const MetricRow& row, std::string_view key) {
    const Metric* metric = record.find_metric(key);
    if (metric == nullptr || !std::isfinite(metric->value)) return {};
    LevelMetric found;
    found.row = &row;
    found.value = found.low = found.high = metric->value;
    found.kind = metric->kind;
    return found;
}

std::vector<LevelMetric> metrics_of(const Level& level, const RunRecord& record) {
    std::vector<LevelMetric> metrics;
    for (const MetricRow* row : record.rows_of_metrics()) {
        if (!level.metric.empty() && level.metric != row->name) continue;
        if (auto metric = metric_of(record, *row, level.key.empty() ? row->key : level.key))
            metrics.push_back(std::move(*metric));
    }
    return metrics;
}

void answer(LevelResult& result) {
    const MetricRow* row = find_metric_row(result.level.metric);
    double sum = 0.0;
    for (int batch = 0; batch < batches; ++batch) {
        const Stopwatch watch;
        for (int i = 0; i < batch_size; ++i)
            sum += result.level.closed_form();
        const double wall = watch.wall() / batch_size;
        result.wall_s = batch == 0 ? wall : std::min(result.wall_s, wall);
    }
    result.runs = batches * batch_size;
    result.was_run = true;
    const double value = sum / result.runs;
    result.status = {StatusCode::completed, "evaluated"};
    if (!std::isfinite(value)) {
        result.status = {StatusCode::not_finite, "the closed form has no value here"};
        return;
    }
    LevelMetric metric;
    metric.row = row;
    metric.value = metric.low = metric.high = result.level.closed_form();
    result.metrics.push_back(metric);
}

/// Runs the scene of a level, again and again while that is quick; the time is the least.
RunRecord run_repeatedly(const Fidelity& fidelity, const Scene& scene, const RunOne& run, int& runs) {
    RunRecord record = run(fidelity, scene);
    ++runs;
    double total = record.cost.wall_s;
    for (int i = 1; i < most_repeats && record.cost.wall_s < short_run && total < repeating_time; ++i) {
        if (twinchute::exit_code(record.status.code) != ExitCode::done) break;
        const RunRecord again = run(fidelity, scene);
        ++runs;
        total += again.cost.wall_s;
        if (again.status.code == StatusCode::interrupted) break;
        record.cost.wall_s = std::min(record.cost.wall_s, again.cost.wall_s);
    }
    return record;
}

/// Median and range over the seeds of what every one of them has.
void take_medians(LevelResult& result, const std::vector<std::vector<LevelMetric>>& of_seeds) {
    for (const LevelMetric& first : of_seeds.front()) {
        std::vector<double> values;
        for (const std::vector<LevelMetric>& metrics : of_seeds) {
            const auto same = std::ranges::find(metrics, first.row, &LevelMetric::row);
            if (same != metrics.end()) values.push_back(same->value);
        }
        if (values.size() != of_seeds.size()) continue;
        LevelMetric metric = first;
        std::tie(metric.low, metric.high) = std::pair(std::ranges::min(values), std::ranges::max(values));
        metric.value = median(std::move(values));
        result.metrics.push_back(std::move(metric));
    }
}

void run_level(LevelResult& result, const Scene& scene, const Fidelity& fidelity,
               const LadderOptions& options, const RunOne& run) {
    const Scene changed = scene_of(result.level, scene);
    // The reduced-order model has no noise: one seed says all.
    const bool scatters = result.level.fidelity == "full" && changed.full.noise &&
                          changed.parachutes.front().deploy.starts_packed();
    result.seeds = scatters ? options.seeds : 1;
    result.was_run = true;
    std::vector<double> walls;
    std::vector<std::vector<LevelMetric>> of_seeds;
    for (int i = 0; i < result.seeds; ++i) {
        const std::optional<std::uint64_t> seed =
            scatters ? std::optional(changed.full.noise->seed + static_cast<std::uint64_t>(i)) : std::nullopt;
        const RunRecord record =
            run_repeatedly(fidelity, scene_of(result.level, scene, seed), run, result.runs);
        walls.push_back(record.cost.wall_s);
        if (i == 0 || twinchute::exit_code(record.status.code) != ExitCode::done)
            result.status = record.status;
        result.steps = std::max(result.steps, record.cost.steps);
        result.rhs_calls = std::max(result.rhs_calls, record.cost.rhs_calls);
        of_seeds.push_back(metrics_of(result.level, record));
        // A maximum or a time of a run that broke off is not that of the level.
        if (!result.ended()) break;
    }
    result.wall_s = median(walls);
    if (result.ended()) take_medians(result, of_seeds);
}

}  // namespace

Ladder climb(const Scene& scene, std::span<const Fidelity* const> fidelities, const LadderOptions& options,
             const RunOne& run) {
    Ladder ladder;
    ladder.scene = scene_id(scene);
    ladder.inputs = scene.inputs;
    ladder.provenance = current_provenance();
    ladder.threads = options.threads;
    ladder.quick = options.quick;
    ladder.test = options.test;
    for (const Fidelity* fidelity : fidelities)
        ladder.fidelities.push_back(fidelity->name);

    bool interrupted = false;
    for (Level& level : ladder_levels(scene)) {
        const auto fidelity = std::ranges::find(fidelities, level.fidelity, &Fidelity::name);
        if (!level.closed_form && fidelity == fidelities.end()) continue;
        if (options.quick && level.cost > quick_cost * (1 + 1e-9)) continue;
        LevelResult result;
        result.setting = setting_of(level, scene);
        result.level = std::move(level);
        if (interrupted)
            result.status = {StatusCode::interrupted, "not run: the ladder was interrupted before"};
        else if (result.level.closed_form)
            answer(result);
        else
            run_level(result, scene, **fidelity, options, run);
        interrupted = interrupted || result.status.code == StatusCode::interrupted;
        ladder.levels.push_back(std::move(result));
    }
    evaluate(ladder, scene);
    return ladder;
}

}  // namespace twinchute::compare
