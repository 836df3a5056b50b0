#include "lib/scene/scale_canopy.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "lib/math/vec.hpp"
#include "lib/scene/drag_area.hpp"
#include "lib/scene/needs.hpp"

namespace twinchute {
namespace {

/// A length, area or volume of a parachute.
struct SizeRow {
    std::string_view key;
    int power;  ///< of D0 that it goes with
    double Parachute::*member;
};

constexpr SizeRow size_rows[] = {
    {"parachute.vent_diameter", 1, &Parachute::vent_diameter},
    {"parachute.line_length", 1, &Parachute::line_length},
    {"parachute.riser_length", 1, &Parachute::riser_length},
    {"parachute.corner_tie", 1, &Parachute::corner_tie},
    {"parachute.drag_area", 2, &Parachute::drag_area},
};

/// Mass [kg] of fabric, tapes, lines and risers; what a nominal area alone has to stand for, in m^2, where
/// they are not all given. Only its ratio for two diameters is used.
double mass_measure(const Parachute& p) {
    const double d = p.nominal_diameter, v = p.vent_diameter;
    if (!missing_structure(p).empty() || !p.panel.empty()) return d * d;
    const double fabric = 0.25 * pi * (has_open_middle(p) ? d * d : d * d - v * v);
    const double arms = cross_arm_ratio(p);
    const double strip = arms > 0.0 ? cross_length(d, arms) : 0.0;
    const double across = arms > 0.0 ? strip : d - v;        // along two radial tapes
    const double round = arms > 0.0 ? 4.0 / pi * strip : d;  // diameter of the skirt's tape
    return fabric * p.fabric.density * meshed_fabric(p).thickness +
           0.5 * p.gores * across * p.tapes.radial.linear_density() +
           pi * (round * p.tapes.skirt.linear_density() + v * p.tapes.vent.linear_density()) +
           (p.gores * p.line_length + p.risers * p.riser_length) * p.line.linear_density();
}

}  // namespace

std::vector<ScaledQuantity> scale_canopy(Parachute& chute, double diameter,
                                         const std::function<bool(std::string_view key)>& follows) {
    std::vector<ScaledQuantity> scaled;
    const double factor = diameter / chute.nominal_diameter;
    const auto scale = [&](std::string key, int power, double& value) {
        if (!(value > 0.0) || !follows(key)) return;
        for (int i = 0; i < power; ++i)
            value *= factor;
        scaled.push_back({std::move(key), value});
    };
    const auto scale_balance = [&](const std::string& table, FillTime& fill) {
        if (!fill.balance) return;
        if (fill.balance->volume) scale(table + ".volume", 3, *fill.balance->volume);
        if (fill.balance->mouth_area) scale(table + ".mouth_area", 2, *fill.balance->mouth_area);
    };
    // Quantities that stay count as part of the shape: the mass is that of a canopy which they fit.
    Parachute before = chute;
    for (const SizeRow& row : size_rows)
        if (row.power == 1 && !follows(row.key)) before.*row.member /= factor;
    const double measure = mass_measure(before);
    chute.drag_area = stated_drag_area(chute);
    chute.uncorrected_drag_area.reset();
    chute.nominal_diameter = diameter;
    for (const SizeRow& row : size_rows)
        scale(std::string(row.key), row.power, chute.*row.member);
    scale_balance("parachute.fill_time", chute.fill_time);
    if (chute.vent_lines)
        for (const auto& [key, length] : {std::pair{"parachute.vent_lines.length", &VentLines::length},
                                          std::pair{"parachute.vent_lines.joint", &VentLines::joint}})
            if (auto& given = (*chute.vent_lines).*length) scale(key, 1, *given);
    for (std::size_t i = 0; i < chute.reefing.size(); ++i) {
        const std::string stage = fmt::format("parachute.reefing.{}", i + 1);
        if (chute.reefing[i].line_length) scale(stage + ".line_length", 1, *chute.reefing[i].line_length);
        if (chute.reefing[i].fill_time) scale_balance(stage + ".fill_time", *chute.reefing[i].fill_time);
    }
    if (constexpr std::string_view key = "parachute.mass"; follows(key)) {
        chute.mass *= mass_measure(chute) / measure;
        scaled.push_back({std::string(key), chute.mass});
    }
    return scaled;
}

}  // namespace twinchute
