#include "lib/cli/record_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lib/record/display_units.hpp"
#include "lib/record/metrics.hpp"
#include "lib/solve/opening.hpp"

namespace twinchute {
namespace {

std::string heading(std::string_view text, const Style& style) {
    return "\n" + style.paint(text, Colour::bold) + "\n";
}

std::string metrics_text(const std::vector<Metric>& metrics) {
    Table table;
    table.right = {false, true};
    for (const Metric& metric : metrics) {
        const Shown number = shown(metric.value, split_metric_key(metric.key).unit);
        table.rows.push_back({metric_words(metric.key), readable(number.value), std::string(number.unit),
                              std::string(metric_kind_name(metric.kind)), printable(metric.note)});
    }
    return aligned(table, {}, 2);
}

std::string events_text(const std::vector<Event>& events) {
    Table table;
    table.right = {false, true, true, true};
    for (const Event& event : events) {
        const double altitude = std::abs(event.altitude) < 0.05 ? 0.0 : event.altitude;  // no -0.0
        table.rows.push_back({printable(event.name), fmt::format("{:.3f} s", event.time),
                              fmt::format("{:.1f}{}", shown(altitude, "m").value, spaced_unit("m")),
                              fmt::format("{:.2f}{}", shown(event.speed, "m/s").value, spaced_unit("m/s"))});
    }
    return aligned(table, {}, 2);
}

}  // namespace

Colour status_colour(StatusCode code) {
    if (is_numerical_failure(code) || failed_to_open(code)) return Colour::red;
    return code == StatusCode::interrupted || code == StatusCode::refused ? Colour::yellow : Colour::green;
}

std::string fill_constant_text(const RunRecord& record) {
    const Input* n = record.find_input("parachute.fill_time.n");
    if (n == nullptr || !std::holds_alternative<double>(n->value)) return {};
    const double value = std::get<double>(n->value);
    std::string text = fmt::format("fill constant n = {:.6g} ({}{}{})", value, origin_name(n->origin),
                                   n->source.empty() ? "" : ": ", n->source);
    const auto says = [&record](std::string_view key, const decltype(Input::value)& wanted) {
        const Input* input = record.find_input(key);
        return input != nullptr && input->value == wanted;
    };
    // 0.5 D0/v_s of n D0/v_s, whatever D0 and v_s are.
    const double share = 0.5 / value;
    if (share > longest_initial_share && says("parachute.initial_phase", std::string("transit")) &&
        says("parachute.fill_time.model", std::string("fill-constant")) &&
        says("parachute.fill_time.density_exponent", 0.0) &&
        !says("parachute.deploy.by", std::string("inflated")))
        text += fmt::format(
            "; by default the initial phase is {:.0f} % of the filling time (tests show at most "
            "{:.0f} %), parachute.initial_phase sets it",
            100.0 * share, 100.0 * longest_initial_share);
    return text;
}

std::string filling_text(const PredictedFilling& filling, std::string_view whose) {
    const auto value = [](const std::optional<double>& number) {
        return number ? readable(*number, 3) : std::string("-");
    };
    std::string text =
        fmt::format("filling   {}{}, initial mouth {:g}, entrance loss {:g}; {}\n", whose,
                    printable(filling.model), filling.initial_mouth, filling.entrance_loss,
                    filling.critical_speed ? "squids above " + with_unit(*filling.critical_speed, "m/s", 3)
                                           : std::string("squids at no subsonic speed"));
    for (const PredictedFilling::At& at : filling.bracket)
        text +=
            fmt::format("bracket   {}initial mouth {:g}: t_f = {} s, n = {}, peak force {}{} ({})\n", whose,
                        at.initial_mouth, value(at.filling_time), value(at.fill_constant),
                        value(at.peak_force ? std::optional(shown(*at.peak_force, "N").value) : std::nullopt),
                        spaced_unit("N"), printable(at.status));
    return text;
}

std::string units_text() {
    return units_remark().empty() ? std::string() : fmt::format("units     {}\n", units_remark());
}

std::string calibration_text(const RunRecord& record, std::string_view whose) {
    if (!record.uncalibrated) return {};
    std::string text;
    for (const CalibratedInput& input : record.uncalibrated->inputs)
        text +=
            fmt::format("{}{} times {:.4g}", text.empty() ? "" : ", ", printable(input.key), input.factor);
    return fmt::format("factors   {}{}, by its calibration\n", whose, text);
}

std::string uncalibrated_text(const RunRecord& record) {
    if (!record.uncalibrated) return {};
    std::string text;
    for (const char* key : {"peak_force_N", "time_to_peak_force_s", "descent_rate_m_s"})
        if (const auto metric = std::ranges::find(record.uncalibrated->metrics, key, &Metric::key);
            metric != record.uncalibrated->metrics.end())
            text += fmt::format("{}{} {}", text.empty() ? "" : ", ", metric_words(key),
                                with_unit(metric->value, split_metric_key(key).unit));
    return text.empty() ? text : fmt::format("without   {}\n", text);
}

std::string time_text(double seconds) {
    const double magnitude = std::abs(seconds);
    if (magnitude < 1e-6) return fmt::format("{:.3g} ns", seconds * 1e9);
    if (magnitude < 1e-3) return fmt::format("{:.3g} us", seconds * 1e6);
    if (magnitude < 1) return fmt::format("{:.3g} ms", seconds * 1e3);
    return fmt::format("{} s", readable(seconds, 3));
}

std::string cost_text(const Cost& cost) {
    std::string text = fmt::format("{} wall, {} steps", time_text(cost.wall_s), cost.steps);
    if (cost.dt_max_s > 0)
        text += fmt::format(" of {} to {}", time_text(cost.dt_min_s), time_text(cost.dt_max_s));
    if (cost.rejected_steps > 0) text += fmt::format(", {} rejected", cost.rejected_steps);
    if (cost.element_steps > 0) {
        text += fmt::format(", {} ns per element-step", readable(cost.ns_per_element_step, 3));
    } else if (cost.rhs_calls > 0) {
        text += fmt::format(", {} right-hand sides", cost.rhs_calls);
    }
    return text;
}

std::string warnings_text(const std::vector<Warning>& warnings, std::string_view prefix, const Style& style) {
    std::string text;
    for (const Warning& warning : warnings) {
        std::string line =
            fmt::format("{}{}: {}", prefix, style.paint("warning", Colour::yellow), printable(warning.what));
        if (!warning.why.empty()) line += fmt::format(" ({})", printable(warning.why));
        if (!warning.suggestion.empty()) line += fmt::format(", {}", printable(warning.suggestion));
        text += line + "\n";
    }
    return text;
}

std::string estimates_text(const RunRecord& record, const Style& style) {
    Table table;
    table.right = {false, true, false, true};
    for (const Estimate& estimate : record.estimates) {
        const auto run = record.metric(estimate.metric);
        const Shown number = shown(estimate.value, split_metric_key(estimate.metric).unit);
        table.rows.push_back(
            {printable(estimate.title), readable(number.value), std::string(number.unit),
             run && *run != 0 ? fmt::format("{:.0f} % of the run's", 100 * estimate.value / *run) : "",
             estimate.outside.empty() ? "holds here" : "does not hold: " + printable(estimate.outside)});
    }
    std::string text;
    const std::string lines = aligned(table, {}, 2);
    std::string_view rest = lines;
    for (const Estimate& estimate : record.estimates) {
        const std::string_view line = rest.substr(0, rest.find('\n'));
        rest.remove_prefix(line.size() + 1);
        text += (estimate.outside.empty() ? std::string(line) : style.paint(line, Colour::dim)) + "\n";
    }
    return text;
}

std::string record_text(const RunRecord& record, std::string_view title, const Style& style) {
    std::string text =
        fmt::format("{}  {}\n", style.paint(printable(record.scene.name), Colour::bold), title);
    text +=
        fmt::format("{}", style.paint(status_name(record.status.code), status_colour(record.status.code)));
    if (!record.status.detail.empty()) text += ": " + printable(record.status.detail);
    text += "\n";
    if (const std::string fill = fill_constant_text(record); !fill.empty()) text += printable(fill) + "\n";

    if (!record.metrics.empty()) text += heading("key figures", style) + metrics_text(record.metrics);
    if (!record.estimates.empty())
        text += heading("peak force by formula", style) + estimates_text(record, style);
    if (!record.events.empty()) text += heading("events", style) + events_text(record.events);
    text += "\n";
    if (record.energy) {
        text += fmt::format("energy    {:.3g} % of the drag work does not add up\n",
                            100 * std::abs(record.energy->residual_fraction));
    }
    if (record.filling) text += filling_text(*record.filling);
    text += calibration_text(record) + uncalibrated_text(record);
    text += units_text();
    text += fmt::format("cost      {}\n", cost_text(record.cost));
    for (const LeftOut& row : record.left_out) {
        text += fmt::format("left out  {}{}\n", printable(row.what),
                            row.why.empty() ? "" : fmt::format(" ({})", printable(row.why)));
    }
    return text + warnings_text(record.warnings, "", style);
}

}  // namespace twinchute
