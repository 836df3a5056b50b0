#include "compare/trend.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <utility>

#include "lib/record/metrics.hpp"
#include "lib/scene/keys.hpp"

namespace twinchute::compare {
namespace {

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

/// `asked`: by name, so that it has to be there; `asked_of_baseline`: also in what was before. `missing`:
/// what the record of now says of it, or null.
Verdict judge(const MetricChange& change, bool asked, bool asked_of_baseline, const MissingMetric* missing,
              double zero) {
    if (!change.tolerance) return Verdict::not_judged;
    if (!change.now) {
        if (missing && missing->not_reached && !asked) return Verdict::not_reached;
        return change.before || asked ? Verdict::missing : Verdict::not_judged;
    }
    if (!change.before)  // a new metric has no past
        return asked_of_baseline ? Verdict::missing : Verdict::not_judged;
    return is_within(*change.difference, *change.tolerance, *change.before, zero) ? Verdict::within
                                                                                  : Verdict::exceeded;
}

bool moved(const MetricChange& change, double zero) {
    if (!change.difference) return true;  // it came or went
    return std::abs(*change.difference) > std::max(trend_threshold * std::abs(*change.before), zero);
}

double size_of(const MetricChange& change) {
    return change.relative ? std::abs(*change.relative) : std::numeric_limits<double>::infinity();
}

using Tolerances = std::map<std::string, Tolerance>;

/// Metrics that either of the two gaps judges: those of a parachute that has another name now are missed.
Tolerances judged_metrics(const FidelityGap& before, const FidelityGap& now, const Tolerances& asked) {
    Tolerances judged = asked;  // they win
    for (const MetricRow& row : metric_rows())
        if (row.tolerance) judged.try_emplace(std::string(row.name), trend_tolerance);
    for (const FidelityGap* gap : {&now, &before})
        for (const MetricGap& metric : gap->metrics)
            if (metric.tolerance) judged.try_emplace(std::string(metric.row->name), trend_tolerance);
    return judged;
}

/// Names that somebody asks for: of the baseline, or of the gap.
std::set<std::string> asked_names(const FidelityGap& gap, const Tolerances& asked) {
    std::set<std::string> names;
    for (const auto& [name, tolerance] : asked)
        names.insert(name);
    for (const MetricGap& metric : gap.metrics)
        if (metric.tolerance && metric.origin != ToleranceOrigin::fallback)
            names.insert(std::string(metric.row->name));
    return names;
}

void add_changes(Trend& trend, const RunRecord& before, const RunRecord& now, const Tolerances& judged,
                 const std::set<std::string>& asked, const Tolerances& asked_of_baseline, bool both_ended) {
    for (const std::string& key : keys_of(before, now)) {
        MetricChange change{now.fidelity, key, value_of(before, key), value_of(now, key), {}, {}};
        if (!change.before && !change.now) continue;
        const auto [name, unit] = split_metric_key(key);
        const double zero = round_off_of(unit, before, now);
        if (change.before && change.now) {
            change.difference = *change.now - *change.before;
            change.relative = relative_difference(*change.now, *change.before, zero);
        }
        const auto tolerance = judged.find(std::string(name));
        if (tolerance != judged.end()) change.tolerance = tolerance->second;
        const auto missing = std::ranges::find(now.missing, key, &MissingMetric::metric);
        const MissingMetric* why = missing == now.missing.end() ? nullptr : &*missing;
        if (why && !change.now) change.note = why->why;
        if (both_ended)
            change.verdict = judge(change, asked.contains(std::string(name)),
                                   asked_of_baseline.contains(std::string(name)), why, zero);
        ++trend.compared;
        trend.judged += change.verdict != Verdict::not_judged && change.verdict != Verdict::not_reached;
        if (moved(change, zero) || change.verdict == Verdict::exceeded)
            trend.changes.push_back(std::move(change));
    }
}

/// A tolerance that somebody asks for on what neither fidelity has, then or now, is held against nothing.
void add_unknown(Trend& trend, const Comparison& before, const Comparison& now, const Tolerances& asked) {
    for (const auto& [name, tolerance] : asked) {
        const MetricRow* row = find_metric_row(name);
        const auto has = [&](const RunRecord& record) {
            return row && value_of(record, std::string(row->key));
        };
        if (has(before.candidate) || has(before.reference) || has(now.candidate) || has(now.reference))
            continue;
        MetricChange change{now.reference.fidelity, row ? std::string(row->key) : name, {}, {}, {}, {}};
        change.tolerance = tolerance;
        change.verdict = Verdict::missing;
        change.note = row ? "no record has it" : "a history, which no baseline is held against";
        ++trend.judged;
        trend.changes.push_back(std::move(change));
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

std::string name_of(const MetricChange& change) {
    return fmt::format("{} {}", change.fidelity, split_metric_key(change.key).name);
}

std::vector<std::string> names_of(const Trend& trend, Verdict verdict) {
    std::vector<std::string> names;
    for (const MetricChange& change : trend.changes)
        if (change.verdict == verdict) names.push_back(name_of(change));
    return names;
}

}  // namespace

bool same_value(const Input& one, const Input& other) {
    const auto *a = std::get_if<double>(&one.value), *b = std::get_if<double>(&other.value);
    return one.value == other.value || (a && b && std::isnan(*a) && std::isnan(*b));
}

std::vector<OtherChange> input_changes(std::vector<Input> before, const std::vector<Input>& now) {
    for (const Key& key : scene_keys()) {  // of a record that is older than the name of a key
        if (key.formerly.empty()) continue;
        const auto below = [](std::string_view path) { return path.substr(path.find('.')); };
        for (Input& input : before)  // several parachutes have theirs as parachute.NAME.*
            if (const std::string_view tail = below(key.formerly); input.key.ends_with(tail))
                input.key.replace(input.key.size() - tail.size(), tail.size(), below(key.path));
    }
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
    const Tolerances judged = judged_metrics(before.gap, now.gap, asked);
    const std::set<std::string> names = asked_names(now.gap, asked);
    const std::pair<const RunRecord&, const RunRecord&> sides[] = {{before.candidate, now.candidate},
                                                                   {before.reference, now.reference}};
    for (const auto& [then, today] : sides) {
        const bool both_ended = is_judged(then) && is_judged(today);
        if (!both_ended)
            trend.note = fmt::format("{} of the {} ended as {}", today.fidelity,
                                     is_judged(then) ? "new run" : "baseline",
                                     status_name((is_judged(then) ? today : then).status.code));
        trend.no_baseline = trend.no_baseline || !is_judged(then);
        add_changes(trend, then, today, judged, names, asked, both_ended);
    }
    if (trend.note.empty()) add_unknown(trend, before, now, asked);
    std::ranges::stable_sort(trend.changes, std::greater{}, size_of);
    trend.inputs = input_changes(before.reference.inputs, now.reference.inputs);
    add_provenance(trend, before, now);
    if (trend.note.empty() && trend.judged == 0) {
        trend.note = "no metric with a tolerance is in both";
        trend.no_baseline = true;  // whoever names one wants it held against something
    }
    return trend;
}

Verdict overall_verdict(const Trend& trend) {
    const auto bad = [](const MetricChange& change) {
        return change.verdict == Verdict::exceeded || change.verdict == Verdict::missing;
    };
    if (trend.no_baseline || std::ranges::any_of(trend.changes, bad)) return Verdict::exceeded;
    return trend.judged == 0 ? Verdict::not_judged : Verdict::within;
}

std::string verdict_line(const Trend& trend) {
    const std::string counts =
        fmt::format("{} judged, {} of {} metrics moved", trend.judged, trend.changes.size(), trend.compared);
    std::string line;
    std::vector<std::string> names = names_of(trend, Verdict::exceeded);
    for (const MetricChange& change : trend.changes)
        if (change.verdict == Verdict::missing)
            names.push_back(name_of(change) + (change.now ? " (not in the baseline)" : " (gone)"));
    if (!names.empty()) {
        line = fmt::format("moved too far from the baseline: {} ({})", fmt::join(names, ", "), counts);
    } else if (trend.judged > 0) {
        line = fmt::format("no judged metric moved beyond its tolerance ({})", counts);
    }
    if (const auto early = names_of(trend, Verdict::not_reached); !early.empty() && !line.empty())
        line += fmt::format("; not reached: {}", fmt::join(early, ", "));
    if (trend.note.empty()) return line;
    return line.empty() ? "nothing judged: " + trend.note : line + "; " + trend.note;
}

}  // namespace twinchute::compare
