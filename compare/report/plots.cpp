#include "compare/report/plots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "compare/render/plot.hpp"
#include "lib/cli/text.hpp"
#include "lib/record/display_units.hpp"

namespace twinchute::compare {
namespace {

/// When the canopy is open: as measured where the model has a shape, else as prescribed.
const Event* opening(const RunRecord& record) {
    const Event* filled = record.find_event("canopy-filled");
    return filled != nullptr ? filled : record.find_event("full-open");
}

/// A curve of each side that has the channel, with `more` behind its name, a marker where its canopy is open,
/// and dots where a test measured. Reference first: the dashed line of the candidate is drawn on top, and
/// both are seen where they agree.
Plot channel_plot(const PageSides& sides, const DropTestHistories* test, std::string_view channel,
                  const std::array<std::string, 2>& more = {}) {
    Plot plot;
    plot.subtitle = sides.back().record->scene.name;
    plot.x.label = "time since release [s]";
    plot.y.from_zero = true;
    for (std::size_t s = sides.size(); s-- > 0;) {
        const RunRecord& record = *sides[s].record;
        const bool is_reference = sides[s].tone == Tone::reference;
        const char* colour = is_reference ? blue : vermillion;
        const Channel* time = record.find_channel("time");
        const Channel* values = record.find_channel(channel);
        if (time != nullptr && values != nullptr)
            plot.series.push_back({.label = record.fidelity + more[s],
                                   .colour = colour,
                                   .x = time->values,
                                   .y = values->values,
                                   .dash = is_reference || sides.size() == 1 ? "" : "8 4"});
        if (const Event* open = opening(record))
            plot.markers.push_back({"full open, " + record.fidelity, colour, open->time});
    }
    if (const Curve* measured = test ? test->find(channel) : nullptr)
        plot.series.push_back({.label = "test: " + test->file,
                               .x = measured->time,
                               .y = measured->value,
                               .line = 0.0,
                               .marker = MarkerShape::dot,
                               .filled = false});
    return plot;
}

/// Largest value of the lines over time, and the one that is exceeded in 2 % of it.
struct Heights {
    double largest = 0.0, usual = 0.0;
};
Heights heights_of(const Plot& plot) {
    Heights heights;
    std::vector<std::pair<double, double>> values;  // with the time [s] that each stands for
    double total = 0.0;
    for (const PlotSeries& series : plot.series) {
        const std::size_t count = series.line > 0.0 ? std::min(series.x.size(), series.y.size()) : 0;
        for (std::size_t i = 0; i < count; ++i) {
            if (!std::isfinite(series.y[i]) || (plot.x.end && !(series.x[i] <= *plot.x.end))) continue;
            const double weight = 0.5 * (series.x[std::min(i + 1, count - 1)] - series.x[i > 0 ? i - 1 : 0]);
            values.emplace_back(series.y[i], std::isfinite(weight) ? weight : 0.0);
            total += values.back().second;
        }
    }
    std::ranges::sort(values, std::greater<>{});
    double rest = 0.02 * total;
    for (const auto& [value, weight] : values) {
        heights.largest = std::max(heights.largest, value);
        heights.usual = std::max(value, 0.0);
        if ((rest -= weight) <= 0.0) break;
    }
    return heights;
}

/// Ends the axis below a spike of a few milliseconds that would flatten all else, as the live plots of a page
/// do; what is up to `kept` is never cut. Returns the height of the spike.
std::optional<double> cut_spike(Plot& plot, double kept = 0.0) {
    const Heights heights = heights_of(plot);
    const double usual = std::max(heights.usual, kept);
    if (!(usual > 0.0) || !(heights.largest > 1.5 * usual)) return {};
    plot.y.end = 1.25 * usual;
    return heights.largest;
}

void scale(Plot& plot, double factor) {
    for (PlotSeries& series : plot.series)
        for (double& y : series.y)
            y *= factor;
    if (plot.y.end) *plot.y.end *= factor;
}

/// Brings all curves of an SI unit into the one that is shown.
void show_in_units(Plot& plot, std::string_view si_unit) {
    scale(plot, shown_factor(si_unit));
}

void say_spike(Plot& plot, const std::optional<double>& spike, std::string_view si_unit) {
    if (spike) plot.subtitle += fmt::format("; a spike of {} is cut off", with_unit(*spike, si_unit));
}

/// Changes the unit from N to kN where forces are that large, or to that of the units chosen.
void scale_force(Plot& plot) {
    if (shown_unit("N") != "N") {
        show_in_units(plot, "N");
        plot.y.label = fmt::format("opening force [{}]", shown_unit("N"));
        return;
    }
    double largest = 0.0;
    for (const PlotSeries& series : plot.series)
        for (const double y : series.y)
            if (std::isfinite(y)) largest = std::max(largest, std::abs(y));
    plot.y.label = "opening force [N]";
    if (std::min(largest, plot.y.end.value_or(largest)) < 1e4) return;
    plot.y.label = "opening force [kN]";
    scale(plot, 1e-3);
}

}  // namespace

std::string force_svg(const PageSides& sides, const DropTestHistories* test) {
    double last = 0, highest = 0;
    std::array<std::string, 2> peaks;
    for (std::size_t s = 0; s < sides.size(); ++s) {
        const RunRecord& record = *sides[s].record;
        const auto peak = record.metric("peak_force_N");
        const auto delay = record.metric("time_to_peak_force_s");
        const double at = snatch_of(record) + delay.value_or(0);
        if (delay) last = std::max(last, at);
        highest = std::max(highest, peak.value_or(0));
        if (const Event* open = opening(record)) last = std::max(last, open->time);
        if (peak) peaks[s] = ": peak " + with_unit(*peak, "N");
        if (peak && delay) peaks[s] += fmt::format(" at {:.2f} s", at);
    }
    Plot plot = channel_plot(sides, test, "force", peaks);
    plot.title = "Opening force";
    if (last > 0) plot.x.end = 2 * last;
    say_spike(plot, cut_spike(plot, highest), "N");
    scale_force(plot);
    return svg_plot(plot);
}

std::string history_svg(const PageSides& sides, const DropTestHistories* test, std::string_view channel) {
    if (channel == "force") return force_svg(sides, test);
    Plot plot = channel_plot(sides, test, channel);
    std::string name(channel), unit;
    std::ranges::replace(name, '_', ' ');
    double last = 0;
    for (const PageSide& side : sides) {
        const RunRecord* record = side.record;
        if (const Channel* values = record->find_channel(channel)) unit = values->unit;
        for (const char* event : {"canopy-filled", "full-open", "peak-force"})
            if (const Event* happened = record->find_event(event)) last = std::max(last, happened->time);
    }
    if (last > 0) plot.x.end = 2 * last;
    say_spike(plot, cut_spike(plot), unit);
    show_in_units(plot, unit);
    plot.y.label = fmt::format("{} [{}]", name, shown_unit(unit));
    name[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(name[0])));
    plot.title = name;
    return svg_plot(plot);
}

std::string speed_svg(const PageSides& sides, const DropTestHistories* test) {
    std::array<std::string, 2> rates;
    for (std::size_t s = 0; s < sides.size(); ++s)
        if (const auto rate = sides[s].record->metric("descent_rate_m_s"))
            rates[s] = ": descends at " + with_unit(*rate, "m/s", 3);
    Plot plot = channel_plot(sides, test, "speed", rates);
    plot.title = "Speed of the payload";
    show_in_units(plot, "m/s");
    plot.y.label = fmt::format("speed over ground [{}]", shown_unit("m/s"));
    return svg_plot(plot);
}

}  // namespace twinchute::compare
