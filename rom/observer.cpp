#include "rom/observer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "lib/math/root.hpp"

namespace twinchute::rom {

void Observer::mark(double t, std::span<const double> y) {
    rows_.push_back(row_of_(t, y));
    consider(rows_.back());
    for (; !sample_times_.empty() && sample_times_.front() <= t; sample_times_ = sample_times_.subspan(1))
        if (sample_times_.front() == t) samples_.push_back(rows_.back());
}

void Observer::step(const OdeSolver& solver) {
    const double a = solver.previous_time(), b = solver.time();
    if (!(b > a)) return;
    buffer_.resize(solver.state().size());
    const auto at = [&](double t) {
        solver.interpolate(t, buffer_);
        return row_of_(t, buffer_);
    };
    const HistoryRow end = row_of_(b, solver.state());
    double from = a;
    if (rows_.back().vertical_speed > 0.0 && end.vertical_speed < 0.0) {
        const double top = root_between([&](double t) { return at(t).vertical_speed; }, a, b,
                                        4.0 * std::numeric_limits<double>::epsilon());
        if (top > a && top < b) add_rows(std::exchange(from, top), top, at(top), at);
    }
    add_rows(from, b, end, at);
    for (; !sample_times_.empty() && sample_times_.front() <= b; sample_times_ = sample_times_.subspan(1))
        samples_.push_back(at(sample_times_.front()));
}

template <class RowAt>
void Observer::add_rows(double a, double b, const HistoryRow& end, const RowAt& at) {
    std::array<double, std::tuple_size_v<decltype(peaks_)>> before{};
    std::ranges::transform(peaks_, before.begin(), [](const Peak& peak) { return peak.best.value; });
    for (int i = 1; i <= pieces; ++i) {
        rows_.push_back(i < pieces ? at(a + (b - a) * i / pieces) : end);
        consider(rows_.back());
    }
    for (std::size_t i = 0; i < watched_; ++i)
        refine(peaks_[i], before[i], a, b, at);
}

template <class RowAt>
void Observer::refine(Peak& peak, double before, double a, double b, const RowAt& at) {
    // Only a step that raised the maximum, or its neighbour, can hold the true one.
    if (!(peak.best.value > before) && rows_.size() - peak.row > 2 * pieces) return;
    if (rows_.size() <= pieces) return;
    std::array<double, pieces + 1> values;
    std::ranges::transform(std::span(rows_).last(pieces + 1), values.begin(), peak.quantity);
    const Maximum best = maximum_on([&](double t) { return at(t).*peak.quantity; }, a, b, values);
    if (best.value > peak.best.value) peak.best = best;
}

bool Observer::is_finite() {
    const std::size_t first = rows_.size() > pieces ? rows_.size() - pieces : 0;
    for (std::size_t i = first; i < rows_.size(); ++i) {
        const HistoryRow& r = rows_[i];
        if (std::isfinite(r.force + r.acceleration + r.speed + r.altitude + r.dynamic_pressure)) continue;
        rows_.resize(std::max<std::size_t>(i, 1));
        return false;
    }
    return true;
}

Maximum Observer::take_peak() {
    peaks_[of_force].row = rows_.size();
    return std::exchange(peaks_[of_force].best, {0.0, -1.0});
}

std::pair<Maximum, std::size_t> Observer::take_canopy_peak() {
    Peak& peak = peaks_[of_canopy_force];
    const std::size_t whose = peak.row < rows_.size() ? rows_[peak.row].canopy : 0;
    peak.row = rows_.size();
    return {std::exchange(peak.best, {0.0, -1.0}), whose};
}

double Observer::impulse_between(double begin, double end) const {
    double sum = 0.0;
    auto i = static_cast<std::size_t>(std::ranges::lower_bound(rows_, begin, {}, &HistoryRow::time) -
                                      rows_.begin());
    while (i + 2 < rows_.size() && rows_[i + 2].time <= end * (1.0 + 1e-12)) {
        const double h = rows_[i + 1].time - rows_[i].time;
        if (!(h > 0.0)) {  // two rows at one time: a stage boundary
            ++i;
            continue;
        }
        sum += h / 3.0 * (rows_[i].force + 4.0 * rows_[i + 1].force + rows_[i + 2].force);
        i += 2;
    }
    return sum;
}

std::array<const HistoryRow*, 2> Observer::around(double t) const {
    const std::span rows(rows_);
    if (rows.size() < 2) return {&rows.front(), &rows.front()};
    const auto inner = rows.subspan(1, rows.size() - 2);  // the last is never passed
    const auto right = 1 + static_cast<std::size_t>(
                               std::ranges::lower_bound(inner, t, {}, &HistoryRow::time) - inner.begin());
    return {&rows[right - 1], &rows[right]};
}

double Observer::speed_at(double t) const {
    const auto [a, b] = around(t);
    const double h = b->time - a->time;
    return h > 0.0 ? a->speed + (t - a->time) / h * (b->speed - a->speed) : b->speed;
}

double Observer::altitude_at(double t) const {
    const auto around_it = around(t);
    const HistoryRow &a = *around_it[0], &b = *around_it[1];
    const double h = b.time - a.time;
    if (!(h > 0.0)) return b.altitude;
    const double x = (t - a.time) / h, y = 1.0 - x;
    return y * y * (1.0 + 2.0 * x) * a.altitude + x * x * (1.0 + 2.0 * y) * b.altitude +
           h * x * y * (y * a.vertical_speed - x * b.vertical_speed);
}

void Observer::consider(const HistoryRow& row) {
    for (Peak& peak : std::span(peaks_).first(watched_)) {
        if (!(row.*peak.quantity > peak.best.value)) continue;
        peak.best = {row.time, row.*peak.quantity};
        peak.row = static_cast<std::size_t>(&row - rows_.data());
    }
}

}  // namespace twinchute::rom
