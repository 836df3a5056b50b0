#include "compare/report/plots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "compare/report/svg_plot.hpp"
#include "lib/cli/text.hpp"

namespace twinchute::compare {
namespace {

struct Side {
    const RunRecord* record;
    Role role;
};

std::array<Side, 2> sides(const Comparison& comparison) {
    return {{{&comparison.reference, Role::reference}, {&comparison.candidate, Role::candidate}}};
}

/// When the canopy is open: as measured where the model has a shape, else as prescribed.
const Event* opening(const RunRecord& record) {
    const Event* filled = record.find_event("canopy-filled");
    return filled != nullptr ? filled : record.find_event("full-open");
}

/// One series a side that has the channel, and a marker where its canopy is open.
Plot channel_plot(const Comparison& comparison, std::string_view channel) {
    Plot plot;
    plot.subtitle = comparison.reference.scene.name;
    plot.x_label = "time since release [s]";
    for (const auto& [record, role] : sides(comparison)) {
        const Channel* time = record->find_channel("time");
        const Channel* values = record->find_channel(channel);
        if (time != nullptr && values != nullptr) {
            plot.series.push_back({record->fidelity, role, time->values, values->values});
        }
        if (const Event* open = opening(*record)) {
            plot.markers.push_back({"full open, " + record->fidelity, role, open->time});
        }
    }
    if (const Curve* measured = comparison.test ? comparison.test->find(channel) : nullptr)
        plot.series.push_back(
            {"test: " + comparison.test->file, Role::test, measured->time, measured->value});
    return plot;
}

void scale(Plot& plot, double factor) {
    for (Series& series : plot.series) {
        for (double& y : series.y)
            y *= factor;
    }
}

double largest(const Plot& plot) {
    double value = 0;
    for (const Series& series : plot.series) {
        for (const double y : series.y) {
            if (std::isfinite(y)) value = std::max(value, std::abs(y));
        }
    }
    return value;
}

}  // namespace

std::string force_svg(const Comparison& comparison) {
    Plot plot = channel_plot(comparison, "force");
    plot.title = "Opening force";
    double last = 0;
    for (const auto& [record, role] : sides(comparison)) {
        const auto peak = record->metric("peak_force_N");
        const auto delay = record->metric("time_to_peak_force_s");
        const double at = snatch_of(*record) + delay.value_or(0);
        if (delay) last = std::max(last, at);
        if (const Event* open = opening(*record)) last = std::max(last, open->time);
        if (!peak) continue;
        for (Series& series : plot.series) {
            if (series.role != role) continue;
            series.label += fmt::format(": peak {} N", readable(*peak));
            if (delay) series.label += fmt::format(" at {:.2f} s", at);
        }
    }
    if (last > 0) plot.x_end = 2 * last;
    const bool kilo = largest(plot) >= 1e4;
    if (kilo) scale(plot, 1e-3);
    plot.y_label = kilo ? "opening force [kN]" : "opening force [N]";
    return svg_plot(plot);
}

std::string history_svg(const Comparison& comparison, std::string_view channel) {
    if (channel == "force") return force_svg(comparison);
    Plot plot = channel_plot(comparison, channel);
    std::string name(channel), unit;
    std::ranges::replace(name, '_', ' ');
    double last = 0;
    for (const auto& [record, role] : sides(comparison)) {
        if (const Channel* values = record->find_channel(channel)) unit = values->unit;
        for (const char* event : {"canopy-filled", "full-open", "peak-force"})
            if (const Event* happened = record->find_event(event)) last = std::max(last, happened->time);
    }
    if (last > 0) plot.x_end = 2 * last;
    plot.y_label = fmt::format("{} [{}]", name, unit);
    name[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(name[0])));
    plot.title = name;
    return svg_plot(plot);
}

std::string speed_svg(const Comparison& comparison) {
    Plot plot = channel_plot(comparison, "speed");
    plot.title = "Speed of the payload";
    plot.y_label = "speed over ground [m/s]";
    for (const auto& [record, role] : sides(comparison)) {
        const auto rate = record->metric("descent_rate_m_s");
        for (Series& series : plot.series) {
            if (rate && series.role == role)
                series.label += fmt::format(": descends at {} m/s", readable(*rate, 3));
        }
    }
    return svg_plot(plot);
}

}  // namespace twinchute::compare
