#include "compare/trend.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lib/record/metric_key.hpp"

namespace twinchute::compare {
namespace {

/// Exactly at the tolerance is within, whatever its last bit.
constexpr double round_off = 1e-12;

std::optional<double> value_of(const RunRecord& record, const std::string& key) {
    const std::optional<double> value = record.metric(key);
    return value && std::isfinite(*value) ? value : std::nullopt;
}

/// Keys of both, those of `now` first and in its order.
std::vector<std::string> keys_of(const RunRecord& before, const RunRecord& now) {
    std::vector<std::string> keys;
    for (const RunRecord* record : {&now, &before})
        for (const Metric& metric : record->metrics)
            if (std::ranges::find(keys, metric.key) == keys.end()) keys.push_back(metric.key);
    return keys;
}

Verdict judge(const MetricChange& change) {
    if (!change.tolerance || !change.before) return Verdict::not_judged;  // a new metric has no past
    if (!change.now) return Verdict::missing;
    const double allowed = change.tolerance->relative ? change.tolerance->value * std::abs(*change.before)
                                                      : change.tolerance->value;
    return std::abs(*change.difference) <= allowed * (1 + round_off) ? Verdict::within : Verdict::exceeded;
}

bool moved(const MetricChange& change) {
    if (!change.difference) return true;  // it came or went
    return std::abs(*change.difference) > trend_threshold * std::abs(*change.before);
}

double size_of(const MetricChange& change) {
    return change.relative ? std::abs(*change.relative) : std::numeric_limits<double>::infinity();
}

using Tolerances = std::map<std::string, Tolerance>;

Tolerances judged_metrics(const FidelityGap& gap, const Tolerances& asked) {
    Tolerances judged = asked;  // they win
    for (const MetricGap& metric : gap.metrics)
        if (metric.tolerance) judged.try_emplace(std::string(metric.row->name), trend_tolerance);
    return judged;
}

void add_changes(Trend& trend, const RunRecord& before, const RunRecord& now, const Tolerances& judged,
                 bool both_ended) {
    for (const std::string& key : keys_of(before, now)) {
        MetricChange change{now.fidelity, key, value_of(before, key), value_of(now, key), {}, {}};
        if (!change.before && !change.now) continue;
        if (change.before && change.now) {
            change.difference = *change.now - *change.before;
            if (*change.before != 0) change.relative = *change.difference / std::abs(*change.before);
        }
        const auto tolerance = judged.find(std::string(split_metric_key(key).name));
        if (tolerance != judged.end()) change.tolerance = tolerance->second;
        if (both_ended) change.verdict = judge(change);
        ++trend.compared;
        trend.judged += change.verdict != Verdict::not_judged;
        if (moved(change) || change.verdict == Verdict::exceeded) trend.changes.push_back(std::move(change));
    }
}

std::string input_text(const Input* input) {
    if (!input) return {};
    const auto* number = std::get_if<double>(&input->value);
    const std::string text = number ? fmt::format("{}", *number) : std::get<std::string>(input->value);
    return text + (input->unit.empty() ? "" : " ") + input->unit;
}

/// A tolerance that is asked for is no input of a run.
bool is_physics(const Input& input) {
    return !input.key.starts_with("compare.");
}

void add_if_other(std::vector<OtherChange>& list, std::string what, const std::string& before,
                  const std::string& now) {
    if (before != now) list.push_back({std::move(what), before, now});
}

void add_provenance(Trend& trend, const Comparison& before, const Comparison& now) {
    const Provenance &then = before.reference.provenance, &today = now.reference.provenance;
    add_if_other(trend.model, "version", then.version, today.version);
    add_if_other(trend.model, "commit", then.commit, today.commit);
    add_if_other(trend.model, "compiler", then.compiler, today.compiler);
    add_if_other(trend.model, "flags", then.flags, today.flags);
    add_if_other(trend.machine, "processor", then.host_cpu, today.host_cpu);
    add_if_other(trend.machine, "instruction set", then.instruction_set, today.instruction_set);
    add_if_other(trend.machine, "threads", std::to_string(then.threads), std::to_string(today.threads));
}

bool ended(const RunRecord& record) {
    return twinchute::exit_code(record.status.code) == ExitCode::done;
}

std::vector<std::string> names_of(const Trend& trend, Verdict verdict) {
    std::vector<std::string> names;
    for (const MetricChange& change : trend.changes)
        if (change.verdict == verdict)
            names.push_back(fmt::format("{} {}", change.fidelity, split_metric_key(change.key).name));
    return names;
}

}  // namespace

bool same_value(const Input& one, const Input& other) {
    const auto *a = std::get_if<double>(&one.value), *b = std::get_if<double>(&other.value);
    return one.value == other.value || (a && b && std::isnan(*a) && std::isnan(*b));
}

std::vector<OtherChange> input_changes(const std::vector<Input>& before, const std::vector<Input>& now) {
    const auto find = [](const std::vector<Input>& inputs, const std::string& key) {
        const auto found = std::ranges::find(inputs, key, &Input::key);
        return found == inputs.end() ? nullptr : &*found;
    };
    std::vector<OtherChange> changes;
    for (const Input& input : now) {
        const Input* old = find(before, input.key);
        if (is_physics(input) && (!old || !same_value(*old, input)))
            changes.push_back({input.key, input_text(old), input_text(&input)});
    }
    for (const Input& input : before)
        if (is_physics(input) && !find(now, input.key))
            changes.push_back({input.key, input_text(&input), {}});
    return changes;
}

Trend measure_trend(const Comparison& before, const Comparison& now, const Tolerances& asked) {
    Trend trend;
    const Tolerances judged = judged_metrics(now.gap, asked);
    const std::pair<const RunRecord&, const RunRecord&> sides[] = {{before.candidate, now.candidate},
                                                                   {before.reference, now.reference}};
    for (const auto& [then, today] : sides) {
        const bool both_ended = ended(then) && ended(today);
        if (!both_ended)
            trend.note =
                fmt::format("{} of the {} ended as {}", today.fidelity, ended(then) ? "new run" : "baseline",
                            status_name((ended(then) ? today : then).status.code));
        add_changes(trend, then, today, judged, both_ended);
    }
    std::ranges::stable_sort(trend.changes, std::greater{}, size_of);
    trend.inputs = input_changes(before.reference.inputs, now.reference.inputs);
    add_provenance(trend, before, now);
    if (trend.note.empty() && trend.judged == 0) trend.note = "no metric has a tolerance";
    return trend;
}

Verdict overall_verdict(const Trend& trend) {
    const auto bad = [](const MetricChange& change) {
        return change.verdict == Verdict::exceeded || change.verdict == Verdict::missing;
    };
    if (std::ranges::any_of(trend.changes, bad)) return Verdict::exceeded;
    return trend.judged == 0 ? Verdict::not_judged : Verdict::within;
}

std::string verdict_line(const Trend& trend) {
    const std::string counts =
        fmt::format("{} judged, {} of {} metrics moved", trend.judged, trend.changes.size(), trend.compared);
    std::string line;
    if (overall_verdict(trend) == Verdict::exceeded) {
        std::vector<std::string> names = names_of(trend, Verdict::exceeded);
        for (const std::string& name : names_of(trend, Verdict::missing))
            names.push_back(name + " (gone)");
        line = fmt::format("moved too far from the baseline: {} ({})", fmt::join(names, ", "), counts);
    } else if (trend.judged > 0) {
        line = fmt::format("no judged metric moved beyond its tolerance ({})", counts);
    }
    if (trend.note.empty()) return line;
    return line.empty() ? "nothing judged: " + trend.note : line + "; " + trend.note;
}

}  // namespace twinchute::compare
