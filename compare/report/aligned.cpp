#include "compare/report/aligned.hpp"

#include <algorithm>
#include <boost/math/interpolators/makima.hpp>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include "compare/histories.hpp"
#include "lib/record/display_units.hpp"

namespace twinchute::compare {
namespace {

// Most points of a channel: those that a page can hold, for the opening and for what follows.
constexpr std::size_t fine_points = 2000, coarse_points = 600;

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

double opening_end(const PageSides& sides, const SharedClock& clock) {
    double last = 0.0;
    for (std::size_t s = 0; s < sides.size(); ++s)
        for (const char* name : {"full-open", "canopy-filled", "peak-force"})
            if (const Event* event = sides[s].record->find_event(name); event && std::isfinite(event->time))
                last = std::max(last, event->time - clock.zero[s]);
    return 2.0 * last;
}

/// The instants of both sides from `from` to `to`, so that their difference is one of values of the finer
/// side, and evenly spaced ones besides, which draw a curve of few rows; evenly spaced ones alone where a
/// page cannot hold all.
void add_instants(std::vector<double>& clock, const std::vector<double>& own, double from, double to,
                  std::size_t most) {
    std::vector<double> inside;
    std::ranges::copy_if(own, std::back_inserter(inside), [&](double t) { return t > from && t < to; });
    std::ranges::sort(inside);
    inside.erase(std::unique(inside.begin(), inside.end()), inside.end());
    const std::size_t even = inside.size() + most / 4 <= most ? most / 4 : most;
    if (even < most) clock.insert(clock.end(), inside.begin(), inside.end());
    for (std::size_t i = 0; i <= even; ++i)
        clock.push_back(from + (to - from) * static_cast<double>(i) / static_cast<double>(even));
}

/// Instants at which rows jump.
void add_jumps(std::vector<double>& jumps, const Curve& rows) {
    for (std::size_t i = 1; i < rows.time.size(); ++i)
        if (rows.time[i] == rows.time[i - 1] && rows.value[i] != rows.value[i - 1])
            jumps.push_back(rows.time[i]);
}

/// Rows between two jumps, and a smooth curve through them: a history with few rows, as of the reduced-order
/// model, is as smooth as its solution, and straight lines between its rows would show as a difference.
class Piece {
public:
    Piece(std::vector<double> time, std::vector<double> value)
        : begin(time.front()), end(time.back()), only_(value.front()) {
        if (time.size() >= 4) {
            curve_.emplace(std::move(time), std::move(value));
        } else {
            straight_ = {std::move(time), std::move(value)};
        }
    }

    double begin, end;
    double at(double t) const {
        if (curve_) return (*curve_)(t);
        return straight_.time.size() > 1 ? value_before(straight_, t) : only_;
    }

private:
    double only_;
    Curve straight_;
    std::optional<boost::math::interpolators::makima<std::vector<double>>> curve_;
};

/// In order; what is not finite is in none.
std::vector<Piece> pieces_of(const Curve& rows) {
    std::vector<Piece> pieces;
    std::vector<double> time, value;
    const auto finish = [&] {
        if (!time.empty()) pieces.emplace_back(std::move(time), std::move(value));
        time.clear(), value.clear();
    };
    for (std::size_t i = 0; i < rows.time.size(); ++i) {
        if (!std::isfinite(rows.value[i])) {
            finish();
            continue;
        }
        if (!time.empty() && rows.time[i] == time.back())
            finish();  // a jump, or a kink that a stage ends with
        time.push_back(rows.time[i]);
        value.push_back(rows.value[i]);
    }
    finish();
    return pieces;
}

/// Values at the instants of the clock: at the first of two equal ones what was, at the second what follows.
std::vector<double> resampled(const Curve& rows, const std::vector<double>& clock) {
    const std::vector<Piece> pieces = pieces_of(rows);
    std::vector<double> values;
    values.reserve(clock.size());
    for (std::size_t i = 0; i < clock.size(); ++i) {
        const double t = clock[i];
        const bool follows = i > 0 && clock[i - 1] == t;
        const auto holds = [t](const Piece& piece) { return piece.begin <= t && t <= piece.end; };
        auto piece = std::ranges::find_if(pieces, holds);
        if (follows && piece != pieces.end() && std::next(piece) != pieces.end() && holds(*std::next(piece)))
            ++piece;
        values.push_back(piece == pieces.end() ? std::numeric_limits<double>::quiet_NaN() : piece->at(t));
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

AlignedHistories aligned_histories(const PageSides& sides, const DropTestHistories* test) {
    AlignedHistories aligned;
    const SharedClock clock = shared_clock(sides);
    std::vector<std::array<Curve, 2>> rows;
    double first = std::numeric_limits<double>::infinity(), last = -first;
    std::vector<double> peaks, jumps;
    std::vector<std::string_view> units;  // SI
    for (const MetricRow& row : history_rows()) {
        std::array<Curve, 2> both;
        AlignedChannel channel{row.key, row.title, {}, {}, {}, {}};
        for (std::size_t s = 0; s < sides.size(); ++s) {
            both[s] = rows_of(*sides[s].record, row.key, clock.zero[s]);
            if (both[s].time.empty()) continue;
            channel.there[s] = true;
            const std::string& unit = sides[s].record->find_channel(row.key)->unit;
            channel.unit = shown_unit(unit);
            for (double& value : both[s].value)
                value *= shown_factor(unit);
            first = std::min(first, both[s].time.front());
            last = std::max(last, both[s].time.back());
            const auto at = std::ranges::max_element(both[s].value) - both[s].value.begin();
            peaks.push_back(both[s].time[static_cast<std::size_t>(at)]);
            add_jumps(jumps, both[s]);
        }
        if (!channel.there[0] && !channel.there[1]) continue;
        aligned.channels.push_back(std::move(channel));
        rows.push_back(std::move(both));
        units.push_back(row.unit);
    }
    if (aligned.channels.empty()) return aligned;
    const double end = opening_end(sides, clock);
    aligned.opening_end = end > first && end < last ? end : last;
    aligned.clock = std::move(peaks);
    std::vector<double> own;
    for (const Curve& curve : rows.front())
        own.insert(own.end(), curve.time.begin(), curve.time.end());
    add_instants(aligned.clock, own, first, aligned.opening_end, fine_points);
    if (aligned.opening_end < last)
        add_instants(aligned.clock, own, aligned.opening_end, last, coarse_points);
    std::vector<Curve> measured(rows.size());
    for (std::size_t c = 0; test && c < rows.size(); ++c)
        if (const Curve* curve = test->find(aligned.channels[c].channel)) {
            measured[c] = measured_rows(*curve, clock.zero[sides.size() - 1]);
            for (double& value : measured[c].value)
                value *= shown_factor(units[c]);
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
        for (std::size_t s = 0; s < sides.size(); ++s)
            if (aligned.channels[c].there[s])
                aligned.channels[c].value[s] = resampled(rows[c][s], aligned.clock);
        if (!measured[c].time.empty()) aligned.channels[c].test = placed(measured[c], aligned.clock);
    }
    return aligned;
}

}  // namespace twinchute::compare
