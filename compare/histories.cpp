#include "compare/histories.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lib/math/vec.hpp"

namespace twinchute::compare {
namespace {

constexpr double nothing_yet = 0.01;  // of the largest value: nothing to take a ratio to

/// Value on segment i, between its points i and i + 1.
double on_segment(const Curve& curve, std::size_t i, double time) {
    const double a = curve.time[i], b = curve.time[i + 1];
    if (time <= a) return curve.value[i];
    if (time >= b) return curve.value[i + 1];
    const double share = (time - a) / (b - a);
    return (1 - share) * curve.value[i] + share * curve.value[i + 1];
}

/// The segment in which a piece of time just after `time` lies; time is not after the end.
std::size_t segment_after(const Curve& curve, double time) {
    const auto next = std::ranges::upper_bound(curve.time, time);
    const auto i = static_cast<std::size_t>(next - curve.time.begin());
    return std::clamp<std::size_t>(i, 1, curve.time.size() - 1) - 1;
}

/// The segment in which a piece of time just before `time` lies; time is not before the start.
std::size_t segment_before(const Curve& curve, double time) {
    const auto next = std::ranges::lower_bound(curve.time, time);
    const auto i = static_cast<std::size_t>(next - curve.time.begin());
    return std::clamp<std::size_t>(i, 1, curve.time.size() - 1) - 1;
}

/// Times of the points strictly inside, and both ends.
void add_times(std::vector<double>& times, const Curve& curve, double from, double to) {
    const auto begin = std::ranges::upper_bound(curve.time, from),
               end = std::ranges::lower_bound(curve.time, to);
    if (begin < end) times.insert(times.end(), begin, end);
}

/// a - b, or a alone.
Curve combined(const Curve& a, const Curve* b, double from, double to) {
    std::vector<double> times{from, to};
    add_times(times, a, from, to);
    if (b) add_times(times, *b, from, to);
    std::ranges::sort(times);
    times.erase(std::unique(times.begin(), times.end()), times.end());
    Curve result;
    for (std::size_t k = 0; k + 1 < times.size(); ++k) {
        // At a jump the value after it begins a segment and the value before it ends one.
        const std::size_t i = segment_after(a, times[k]), j = b ? segment_after(*b, times[k]) : 0;
        for (const double time : {times[k], times[k + 1]}) {
            const double value = on_segment(a, i, time) - (b ? on_segment(*b, j, time) : 0.0);
            if (!result.time.empty() && result.time.back() == time && result.value.back() == value) continue;
            result.time.push_back(time);
            result.value.push_back(value);
        }
    }
    return result;
}

const Event* event_of(const RunRecord& record, std::initializer_list<const char*> names) {
    for (const char* name : names)
        if (const Event* event = record.find_event(name)) return event;
    // Among several parachutes it is that of the first to come out.
    for (const Event& first : record.events) {
        const auto dot = first.name.find('.');
        if (dot == std::string::npos) continue;
        for (const char* name : names)
            if (const Event* event = record.find_event(first.name.substr(0, dot + 1) + name)) return event;
    }
    return nullptr;
}

/// A parachute that comes out, in the clock of its record [s].
struct Opening {
    std::string parachute;
    double begins, snatch, full;  // begins: its first event; full: infinite where it never is
};

double time_of(const Event* event, double otherwise) {
    return event ? event->time : otherwise;
}

/// Parachutes that come out, among several, in order of their snatch.
std::vector<Opening> openings_of(const RunRecord& record) {
    std::vector<Opening> openings;
    for (const Event& event : record.events) {
        const auto dot = event.name.rfind('.');
        if (dot == std::string::npos) continue;
        const std::string parachute = event.name.substr(0, dot);
        if (std::ranges::find(openings, parachute, &Opening::parachute) != openings.end()) continue;
        const auto at = [&](const char* name) { return record.find_event(parachute + "." + name); };
        const double taut = time_of(at("line-stretch"), infinity), snatch = time_of(at("snatch"), taut);
        if (snatch < infinity)
            openings.push_back({parachute, event.time, snatch, time_of(at("full-open"), infinity)});
    }
    std::ranges::stable_sort(openings, {}, &Opening::snatch);
    return openings;
}

/// Openings of both records, the same parachutes in the reference's order. Where there are not several, or
/// not the same, one opening for all of each record.
std::vector<std::pair<Opening, Opening>> shared_openings(const RunRecord& reference,
                                                         const RunRecord& candidate) {
    const std::vector<Opening> ones = openings_of(reference), others = openings_of(candidate);
    std::vector<std::pair<Opening, Opening>> shared;
    for (const Opening& one : ones)
        if (const auto other = std::ranges::find(others, one.parachute, &Opening::parachute);
            other != others.end())
            shared.emplace_back(one, *other);
    if (shared.size() > 1 && shared.size() == ones.size() && shared.size() == others.size()) return shared;
    const auto all_of = [](const RunRecord& record) {
        return Opening{"", -infinity, snatch_of(record), time_of(event_of(record, {"full-open"}), infinity)};
    };
    return {{all_of(reference), all_of(candidate)}};
}

Curve since(double zero, Curve curve) {
    for (double& t : curve.time)
        t -= zero;
    return curve;
}

std::optional<PhaseScore> score(const Curve& reference, const Curve& candidate, const std::string& parachute,
                                HistoryPhase phase, double from, double to) {
    from = std::max({from, reference.time.front(), candidate.time.front()});
    to = std::min({to, reference.time.back(), candidate.time.back()});
    if (!(to > from)) return {};
    const Curve one = cut(reference, from, to), other = cut(candidate, from, to),
                apart = difference(candidate, reference, from, to);
    const double largest = infinity_norm(one), norm = l2_norm(one);
    if (phase == HistoryPhase::deployment &&
        norm < nothing_yet * infinity_norm(reference) * std::sqrt(to - from))
        return {};
    PhaseScore result{parachute, phase, from, to, 0.0, 0.0, 0.0};
    result.maximum = (infinity_norm(other) - largest) / largest;
    result.l2 = l2_norm(apart) / norm;
    result.infinity = infinity_norm(apart) / largest;
    // A reference of zeros, or values whose squares a double does not hold.
    if (!std::isfinite(result.maximum + result.l2 + result.infinity)) return {};
    return result;
}

/// [s] at which a record goes on with what another model flew: no result of its own.
double own_end(const RunRecord& record) {
    const auto& made = record.handed_over;
    return made && made->to != record.fidelity ? made->time : infinity;
}

}  // namespace

double value_before(const Curve& curve, double time) {
    if (time <= curve.time.front()) return curve.value.front();
    return on_segment(curve, segment_before(curve, time), time);
}

double value_after(const Curve& curve, double time) {
    if (time >= curve.time.back()) return curve.value.back();
    return on_segment(curve, segment_after(curve, time), time);
}

Curve difference(const Curve& a, const Curve& b, double from, double to) {
    return combined(a, &b, from, to);
}

Curve cut(const Curve& curve, double from, double to) {
    return combined(curve, nullptr, from, to);
}

double l2_norm(const Curve& curve) {
    double sum = 0;
    for (std::size_t i = 0; i + 1 < curve.time.size(); ++i) {
        const double a = curve.value[i], b = curve.value[i + 1];
        sum += (curve.time[i + 1] - curve.time[i]) * (a * a + a * b + b * b) / 3.0;
    }
    return std::sqrt(sum);
}

double infinity_norm(const Curve& curve) {
    double most = 0;
    for (const double value : curve.value)
        most = std::max(most, std::abs(value));
    return most;
}

std::string_view phase_name(HistoryPhase phase) {
    switch (phase) {
        case HistoryPhase::deployment:
            return "deployment";
        case HistoryPhase::inflation:
            return "inflation";
        case HistoryPhase::descent:
            return "descent";
    }
    return "unknown";
}

double snatch_of(const RunRecord& record) {
    const Event* event = event_of(record, {"snatch", "line-stretch"});
    return event ? event->time : 0.0;
}

std::optional<Curve> curve_of(const RunRecord& record, std::string_view channel) {
    const Channel *time = record.find_channel("time"), *values = record.find_channel(channel);
    if (!time || !values || time->values.size() < 2 || time->values.size() != values->values.size())
        return {};
    const auto finite = [](double x) { return std::isfinite(x); };
    if (!std::ranges::all_of(time->values, finite) || !std::ranges::all_of(values->values, finite) ||
        !std::ranges::is_sorted(time->values))
        return {};
    return Curve{time->values, values->values};
}

std::vector<PhaseScore> score_history(const RunRecord& reference, const RunRecord& candidate,
                                      const MetricRow& row) {
    const std::optional<Curve> of_reference = curve_of(reference, row.key),
                               of_candidate = curve_of(candidate, row.key);
    if (!of_reference || !of_candidate) return {};
    const auto openings = shared_openings(reference, candidate);
    std::vector<PhaseScore> scores;
    double end_of_one = -infinity,
           end_of_other = -infinity;  // of the parachute before, by each record's clock
    for (std::size_t k = 0; k < openings.size(); ++k) {
        const Opening &one = openings[k].first, &other = openings[k].second;
        double to = infinity;  // since its snatch, as all that follow
        if (k + 1 < openings.size()) {
            const Opening &next_one = openings[k + 1].first, &next_other = openings[k + 1].second;
            to = std::max(0.0, std::min(next_one.begins - one.snatch, next_other.begins - other.snatch));
        }
        to = std::min({to, own_end(reference) - one.snatch, own_end(candidate) - other.snatch});
        const double full = std::min(one.full - one.snatch, to);
        const Curve a = since(one.snatch, *of_reference), b = since(other.snatch, *of_candidate);
        const auto add = [&](HistoryPhase phase, double begin, double end) {
            if (auto result = score(a, b, one.parachute, phase, begin, end))
                scores.push_back(std::move(*result));
        };
        add(HistoryPhase::deployment, std::max(end_of_one - one.snatch, end_of_other - other.snatch), 0.0);
        add(HistoryPhase::inflation, 0.0, full);
        add(HistoryPhase::descent, full, to);
        end_of_one = one.snatch + to;
        end_of_other = other.snatch + to;
    }
    return scores;
}

std::optional<double> judged_score(std::span<const PhaseScore> phases) {
    std::optional<double> most;
    for (const PhaseScore& phase : phases)
        if (phase.phase != HistoryPhase::deployment) most = std::max(most.value_or(0.0), phase.l2);
    return most;
}

}  // namespace twinchute::compare
