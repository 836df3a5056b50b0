#include "compare/validate/quantities.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "lib/math/vec.hpp"
#include "lib/record/metrics.hpp"

namespace twinchute::compare {
namespace {

/// A history between whose points there are straight lines, and its integral.
class History {
public:
    History(std::span<const double> time, std::span<const double> value) : time_(time), value_(value) {
        sum_.push_back(0.0);
        for (std::size_t i = 1; i < time.size(); ++i)
            sum_.push_back(sum_.back() + 0.5 * (time[i] - time[i - 1]) * (value[i] + value[i - 1]));
    }

    double begin() const { return time_.front(); }
    double end() const { return time_.back(); }

    double mean(double begin, double window) const {
        return (integral(begin + window) - integral(begin)) / window;
    }

    /// Where a window may begin for its mean to be the largest: its ends lie on points, or the history has
    /// the same value at both.
    std::vector<double> starts(double window) const {
        std::vector<double> at;
        for (const double t : time_) {
            if (t + window <= end()) at.push_back(t);
            if (t - window >= begin()) at.push_back(t - window);
        }
        std::ranges::sort(at);
        const std::size_t count = at.size();
        for (std::size_t i = 0; i + 1 < count; ++i) {
            const double a = at[i], b = at[i + 1], third = (b - a) / 3.0;
            if (!(third > 0.0)) continue;
            // Between points the rate of the mean is a straight line.
            const double p = rate(a + third, window), q = rate(b - third, window);
            const double zero = a + third + third * p / (p - q);
            if (p > q && zero > a && zero < b) at.push_back(zero);
        }
        std::ranges::sort(at);
        return at;
    }

private:
    std::size_t interval(double t) const {
        const auto next = std::ranges::upper_bound(time_, t);
        const auto i = static_cast<std::size_t>(next - time_.begin());
        return std::clamp<std::size_t>(i, 1, time_.size() - 1) - 1;
    }
    double at(double t) const {
        const std::size_t i = interval(t);
        const double h = time_[i + 1] - time_[i];
        return h > 0.0 ? value_[i] + (t - time_[i]) / h * (value_[i + 1] - value_[i]) : value_[i + 1];
    }
    double integral(double t) const {
        const std::size_t i = interval(t);
        return sum_[i] + 0.5 * (t - time_[i]) * (value_[i] + at(t));
    }
    double rate(double t, double window) const { return at(t + window) - at(t); }

    std::span<const double> time_, value_;
    std::vector<double> sum_;
};

struct Window {
    double begin = 0.0, mean = 0.0;
};

std::optional<Window> highest(const History& history, double window) {
    std::optional<Window> best;
    for (const double start : history.starts(window)) {
        const double mean = history.mean(start, window);
        if (!best || mean > best->mean) best = Window{start, mean};
    }
    return best;
}

bool is_usable(std::span<const double> time, std::span<const double> value, double window) {
    return time.size() == value.size() && time.size() >= 2 && time.back() - time.front() >= window;
}

/// The channel beside the time, or null.
const std::vector<double>* channel(const RunRecord& record, std::string_view name) {
    const Channel* found = record.find_channel(name);
    return found && found->values.size() >= 2 ? &found->values : nullptr;
}

std::optional<double> mean_peak_force(const RunRecord& record, const Scene&, const QuantityArguments& a) {
    const auto *time = channel(record, "time"), *force = channel(record, "force");
    if (!time || !force) return {};
    return largest_mean(*time, *force, a.window);
}

std::optional<double> mean_peak_load(const RunRecord& record, const Scene& scene,
                                     const QuantityArguments& a) {
    const auto force = mean_peak_force(record, scene, a);
    if (!force) return {};
    return *force / (scene.payload.mass * standard_gravity);
}

std::optional<double> largest_force(const RunRecord& record, const Scene&, const QuantityArguments&) {
    const auto* force = channel(record, "force");
    if (!force) return {};
    return *std::ranges::max_element(*force);
}

/// Time between the half-height points of the moving mean around its highest window.
std::optional<double> pulse_width(const RunRecord& record, const Scene&, const QuantityArguments& a) {
    const auto *time = channel(record, "time"), *force = channel(record, "force");
    if (!time || !force || !is_usable(*time, *force, a.window)) return {};
    const History history(*time, *force);
    const auto best = highest(history, a.window);
    if (!best || !(best->mean > 0.0)) return {};
    const std::vector<double> starts = history.starts(a.window);
    const auto top = std::ranges::lower_bound(starts, best->begin) - starts.begin();
    // From the top outward to the first point below half of it, then by halving.
    const auto edge = [&](std::ptrdiff_t step) -> std::optional<double> {
        for (auto i = top; i >= 0 && i < std::ssize(starts); i += step) {
            double out = starts[static_cast<std::size_t>(i)];
            if (history.mean(out, a.window) >= 0.5 * best->mean) continue;
            double in = i == top ? best->begin : starts[static_cast<std::size_t>(i - step)];
            for (int n = 0; n < 60; ++n) {
                const double middle = 0.5 * (in + out);
                (history.mean(middle, a.window) >= 0.5 * best->mean ? in : out) = middle;
            }
            return in;
        }
        return {};
    };
    const auto rise = edge(-1), fall = edge(1);
    if (!fall) return {};
    // An opening that begins with the recording has less than half only before it.
    return *fall - rise.value_or(starts.front());
}

/// First time at which the payload falls through a height above the ground.
std::optional<double> time_at(const RunRecord& record, const Scene& scene, double height) {
    const auto *time = channel(record, "time"), *altitude = channel(record, "altitude");
    if (!time || !altitude) return {};
    const double level = scene.environment.ground + height;
    for (std::size_t i = 1; i < altitude->size(); ++i) {
        const double above = (*altitude)[i - 1], below = (*altitude)[i];
        if (!(above >= level && below <= level && above > below)) continue;
        return (*time)[i - 1] + ((*time)[i] - (*time)[i - 1]) * (above - level) / (above - below);
    }
    return {};
}

std::optional<double> fall_time(const RunRecord& record, const Scene& scene, const QuantityArguments& a) {
    const auto begin = time_at(record, scene, a.from), end = time_at(record, scene, a.to);
    if (!begin || !end) return {};
    return *end - *begin;
}

/// Interpolated in time; for a recording without a speed, from its heights.
std::optional<double> fall_speed(const RunRecord& record, const Scene& scene, const QuantityArguments& a) {
    const auto at = time_at(record, scene, a.height);
    if (!at) return {};
    const auto &time = *channel(record, "time"), &altitude = *channel(record, "altitude");
    const auto next = std::ranges::lower_bound(time, *at);
    const auto i = std::clamp<std::size_t>(static_cast<std::size_t>(next - time.begin()), 1, time.size() - 1);
    const double h = time[i] - time[i - 1];
    const auto* speed = channel(record, "vertical_speed");
    if (!speed) return (altitude[i - 1] - altitude[i]) / h;
    const double share = h > 0.0 ? (*at - time[i - 1]) / h : 1.0;
    return -((*speed)[i - 1] + share * ((*speed)[i] - (*speed)[i - 1]));
}

std::optional<double> fall_speed_ratio(const RunRecord& record, const Scene& scene,
                                       const QuantityArguments& a) {
    const auto above = fall_speed(record, scene, {a.window, a.from, 0.0, 0.0}),
               below = fall_speed(record, scene, {a.window, a.to, 0.0, 0.0});
    if (!above || !below || *below == 0.0) return {};
    return *above / *below;
}

std::optional<double> full_open_speed(const RunRecord& record, const Scene&, const QuantityArguments&) {
    const Event* event = record.find_event("full-open");
    if (!event) return {};
    return event->speed;
}

std::optional<double> full_open_time(const RunRecord& record, const Scene&, const QuantityArguments&) {
    const Event* event = record.find_event("full-open");
    if (!event) return {};
    return event->time;
}

std::optional<double> switch_time(const RunRecord& record, const Scene&, const QuantityArguments&) {
    const Event* event = record.find_event("switch");
    if (!event) return {};
    return event->time;
}

std::optional<double> opening_time(const RunRecord& record, const Scene&, const QuantityArguments&) {
    const Event *open = record.find_event("full-open"), *snatch = record.find_event("snatch");
    if (!open || !snatch) return {};
    return open->time - snatch->time;
}

/// j of a drag area that goes with the power j of time: what it has come to halfway through its filling.
std::optional<double> growth_exponent(const RunRecord& record, const Scene&, const QuantityArguments&) {
    const Event* snatch = record.find_event("snatch");
    if (!snatch) snatch = record.find_event("line-stretch");
    const Event* open = record.find_event("full-open");
    const Channel *time = record.find_channel("time"), *area = record.find_channel("drag_area");
    if (!snatch || !open || !time || !area) return {};
    const double half = 0.5 * (snatch->time + open->time);
    const auto row = [&](double t) {
        return static_cast<std::size_t>(std::ranges::lower_bound(time->values, t) - time->values.begin());
    };
    const std::size_t i = row(half), beyond = row(open->time * (1.0 + 1e-12));
    if (i == 0 || i >= beyond) return {};
    const double share = (half - time->values[i - 1]) / (time->values[i] - time->values[i - 1]);
    const double then = area->values[i - 1] + share * (area->values[i] - area->values[i - 1]);
    return std::log2(area->values[beyond - 1] / then);  // of the stage that begins there
}

constexpr std::array quantity_rows{
    Quantity{"mean_peak_force", "N", "largest mean of the opening force over a window", "window",
             mean_peak_force},
    Quantity{"mean_peak_load", "1", "the same over m_l g0: what an accelerometer in the payload reads, in g",
             "window", mean_peak_load},
    Quantity{"largest_force", "N", "largest value of the history's force", "", largest_force},
    Quantity{"pulse_width", "s", "full width at half height of the force's moving mean", "window",
             pulse_width},
    Quantity{"fall_time", "s", "between two heights above the ground", "from|to", fall_time},
    Quantity{"fall_speed", "m/s", "downward, at a height above the ground", "height", fall_speed},
    Quantity{"fall_speed_ratio", "1", "that at one height over that at another", "from|to", fall_speed_ratio},
    Quantity{"full_open_speed", "m/s", "of the payload when the drag area is full", "", full_open_speed},
    Quantity{"full_open_time", "s", "since release, when the drag area is full", "", full_open_time},
    Quantity{"switch_time", "s", "since release, when finite elements begin to take over", "", switch_time},
    Quantity{"opening_time", "s",
             "from snatch until the drag area is full: what the fill constant prescribes", "", opening_time},
    Quantity{"growth_exponent", "1",
             "log2 of the full drag area over that halfway through its filling: j of growth with t^j", "",
             growth_exponent},
};

}  // namespace

std::span<const Quantity> quantities() {
    return quantity_rows;
}

const Quantity* find_quantity(std::string_view name) {
    const auto row = std::ranges::find(quantity_rows, name, &Quantity::name);
    return row == quantity_rows.end() ? nullptr : &*row;
}

std::optional<double> quantity_value(std::string_view name, const RunRecord& record, const Scene& scene,
                                     const QuantityArguments& arguments) {
    if (const Quantity* row = find_quantity(name)) return row->of(record, scene, arguments);
    const MetricRow* metric = find_metric_row(name);
    return metric ? record.metric(metric->key) : std::nullopt;
}

std::string_view quantity_unit(std::string_view name) {
    if (const Quantity* row = find_quantity(name)) return row->unit;
    const MetricRow* metric = find_judgeable_row(name);
    return metric == nullptr ? std::string_view{} : metric->tolerance_unit();
}

std::string quantity_words(std::string_view name, const QuantityArguments& a) {
    std::string words(name);
    std::ranges::replace(words, '_', ' ');
    const Quantity* row = find_quantity(name);
    if (!row) return words;
    if (row->takes == "window") return fmt::format("{}, {:g} ms", words, 1e3 * a.window);
    if (row->takes == "from|to") return fmt::format("{}, {:g} to {:g} m", words, a.from, a.to);
    if (row->takes == "height") return fmt::format("{} at {:g} m", words, a.height);
    return words;
}

std::optional<double> largest_mean(std::span<const double> time, std::span<const double> value,
                                   double window) {
    if (!is_usable(time, value, window)) return {};
    const auto best = highest(History(time, value), window);
    if (!best) return {};
    return best->mean;
}

}  // namespace twinchute::compare
