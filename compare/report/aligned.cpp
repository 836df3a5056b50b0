#include "compare/report/aligned.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "compare/histories.hpp"

namespace twinchute::compare {
namespace {

// Most points of a channel: those that a screen can show, and those that a page can hold.
constexpr std::size_t fine_points = 900, coarse_points = 400;

/// The rows of a channel with finite times that do not fall, in the page's clock; nothing where that does not
/// last.
Curve rows_of(const RunRecord& record, std::string_view channel, double zero) {
    Curve rows;
    const Channel* time = record.find_channel("time");
    const Channel* values = record.find_channel(channel);
    if (time == nullptr || values == nullptr) return rows;
    for (std::size_t i = 0; i < std::min(time->values.size(), values->values.size()); ++i) {
        const double t = time->values[i] - zero;
        if (!std::isfinite(t) || (!rows.time.empty() && t < rows.time.back())) continue;
        rows.time.push_back(t);
        rows.value.push_back(values->values[i]);
    }
    if (rows.time.empty() || !(rows.time.back() > rows.time.front())) return {};
    return rows;
}

double opening_end(const Comparison& comparison, const SharedClock& clock) {
    double last = 0.0;
    const auto sides = page_sides(comparison);
    for (std::size_t s = 0; s < 2; ++s)
        for (const char* name : {"full-open", "canopy-filled", "peak-force"})
            if (const Event* event = sides[s].record->find_event(name); event && std::isfinite(event->time))
                last = std::max(last, event->time - clock.zero[s]);
    return 2.0 * last;
}

void add_evenly(std::vector<double>& clock, double from, double to, std::size_t points) {
    for (std::size_t i = 0; i <= points; ++i)
        clock.push_back(from + (to - from) * static_cast<double>(i) / static_cast<double>(points));
}

/// Instants at which rows jump.
void add_jumps(std::vector<double>& jumps, const Curve& rows) {
    for (std::size_t i = 1; i < rows.time.size(); ++i)
        if (rows.time[i] == rows.time[i - 1] && rows.value[i] != rows.value[i - 1])
            jumps.push_back(rows.time[i]);
}

/// Values at the instants of the clock: at the first of two equal ones what was, at the second what follows.
std::vector<double> resampled(const Curve& rows, const std::vector<double>& clock) {
    std::vector<double> values;
    values.reserve(clock.size());
    for (std::size_t i = 0; i < clock.size(); ++i) {
        const double t = clock[i];
        const bool follows = i > 0 && clock[i - 1] == t;
        values.push_back(t < rows.time.front() || t > rows.time.back()
                             ? std::numeric_limits<double>::quiet_NaN()
                         : follows ? value_after(rows, t)
                                   : value_before(rows, t));
    }
    return values;
}

/// The instants of a test, as many as can be told apart. Its clock begins at release: on this one it lies as
/// the reference does.
Curve measured_rows(const Curve& measured, double zero) {
    constexpr std::size_t most = 400;
    Curve rows;
    const std::size_t count = measured.time.size(), stride = (count + most - 1) / most;
    const double largest = std::ranges::max(measured.value);
    for (std::size_t i = 0; i < count; ++i)
        if (i % stride == 0 || measured.value[i] == largest) {
            rows.time.push_back(measured.time[i] - zero);
            rows.value.push_back(measured.value[i]);
        }
    return rows;
}

/// Rows at their own instants of the clock, nothing in between. What lies before the runs or after them
/// has none.
std::vector<double> placed(const Curve& rows, const std::vector<double>& clock) {
    std::vector<double> values(clock.size(), std::numeric_limits<double>::quiet_NaN());
    for (std::size_t i = 0; i < rows.time.size(); ++i)
        if (const auto at = std::ranges::lower_bound(clock, rows.time[i]);
            at != clock.end() && *at == rows.time[i])
            values[static_cast<std::size_t>(at - clock.begin())] = rows.value[i];
    return values;
}

}  // namespace

AlignedHistories aligned_histories(const Comparison& comparison) {
    AlignedHistories aligned;
    const SharedClock clock = shared_clock(comparison);
    const auto sides = page_sides(comparison);
    std::vector<std::array<Curve, 2>> rows;
    double first = std::numeric_limits<double>::infinity(), last = -first;
    std::vector<double> peaks, jumps;
    for (const MetricRow& row : history_rows()) {
        std::array<Curve, 2> both;
        AlignedChannel channel{row.key, row.title, {}, {}, {}, {}};
        for (std::size_t s = 0; s < 2; ++s) {
            both[s] = rows_of(*sides[s].record, row.key, clock.zero[s]);
            if (both[s].time.empty()) continue;
            channel.there[s] = true;
            channel.unit = sides[s].record->find_channel(row.key)->unit;
            first = std::min(first, both[s].time.front());
            last = std::max(last, both[s].time.back());
            const auto at = std::ranges::max_element(both[s].value) - both[s].value.begin();
            peaks.push_back(both[s].time[static_cast<std::size_t>(at)]);
            add_jumps(jumps, both[s]);
        }
        if (!channel.there[0] && !channel.there[1]) continue;
        aligned.channels.push_back(std::move(channel));
        rows.push_back(std::move(both));
    }
    if (aligned.channels.empty()) return aligned;
    const double end = opening_end(comparison, clock);
    aligned.opening_end = end > first && end < last ? end : last;
    aligned.clock = std::move(peaks);
    add_evenly(aligned.clock, first, aligned.opening_end, fine_points);
    if (aligned.opening_end < last) add_evenly(aligned.clock, aligned.opening_end, last, coarse_points);
    std::vector<Curve> measured(rows.size());
    for (std::size_t c = 0; comparison.test && c < rows.size(); ++c)
        if (const Curve* curve = comparison.test->find(aligned.channels[c].channel)) {
            measured[c] = measured_rows(*curve, clock.zero[1]);
            std::ranges::copy_if(measured[c].time, std::back_inserter(aligned.clock),
                                 [&](double t) { return t >= first && t <= last; });
        }
    aligned.clock.insert(aligned.clock.end(), jumps.begin(), jumps.end());
    for (std::vector<double>* list : {&aligned.clock, &jumps}) {
        std::ranges::sort(*list);
        list->erase(std::unique(list->begin(), list->end()), list->end());
    }
    aligned.clock.insert(aligned.clock.end(), jumps.begin(), jumps.end());
    std::ranges::sort(aligned.clock);
    for (std::size_t c = 0; c < rows.size(); ++c) {
        for (std::size_t s = 0; s < 2; ++s)
            if (aligned.channels[c].there[s])
                aligned.channels[c].value[s] = resampled(rows[c][s], aligned.clock);
        if (!measured[c].time.empty()) aligned.channels[c].test = placed(measured[c], aligned.clock);
    }
    return aligned;
}

}  // namespace twinchute::compare
