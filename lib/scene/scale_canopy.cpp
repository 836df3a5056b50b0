#include "lib/scene/scale_canopy.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>
#include <vector>

#include "lib/math/vec.hpp"
#include "lib/models/meridian.hpp"
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

/// Fabric [kg] and seam [m], from vent to skirt, of gores that are cut as the meridian says.
struct GoreMaterial {
    double fabric = 0.0, seam = 0.0, skirt = 0.0;  ///< skirt: diameter [m]
};

GoreMaterial gore_material(const Parachute& p) {
    const std::vector<GorePanel> panels = gore_panels(p);
    const Meridian meridian = gore_meridian(p);
    const double vent = meridian.seam_at(polygon_radius(p.vent_diameter, p.gores));
    const double chords = 2.0 * p.gores * std::sin(pi / p.gores);  // of all gores, over the radius
    GoreMaterial made{0.0, meridian.length() - vent, meridian.at(meridian.length()).radius * chords / pi};
    double top = vent;
    for (std::size_t i = 0; i < panels.size(); ++i) {
        const double bottom = meridian.edges()[i];
        const Fabric fabric = meshed_fabric(p, i);
        if (!panels[i].gap) made.fabric += meridian.area(top, bottom) * fabric.density * fabric.thickness;
        top = bottom;
    }
    return made;
}

GoreMaterial cross_material(const Parachute& p) {
    const double arms = cross_arm_ratio(p), strip = cross_length(p.nominal_diameter, arms),
                 width = arms * strip;
    const Fabric middle = meshed_fabric(p, 0), arm = meshed_fabric(p, 1);
    return {width * width * middle.density * middle.thickness +
                2.0 * width * (strip - width) * arm.density * arm.thickness,
            0.5 * strip, 4.0 / pi * strip};
}

GoreMaterial flat_material(const Parachute& p) {
    const double d = p.nominal_diameter, v = p.vent_diameter;
    const Fabric fabric = meshed_fabric(p);
    return {0.25 * pi * (d * d - v * v) * fabric.density * fabric.thickness, 0.5 * (d - v), d};
}

/// Mass [kg] of fabric, tapes, lines and risers, one strand of these for each line; what a nominal area alone
/// has to stand for, in m^2, where they are not all given. Only its ratio for two diameters is used.
double mass_measure(const Parachute& p) {
    if (!missing_structure(p).empty()) return p.nominal_diameter * p.nominal_diameter;
    const GoreMaterial made = cross_arm_ratio(p) > 0.0 ? cross_material(p)
                              : gore_panels(p).empty() ? flat_material(p)
                                                       : gore_material(p);
    if (!std::isfinite(made.fabric)) return p.nominal_diameter * p.nominal_diameter;  // no vent that fits
    double vent_lines = 0.0;
    if (p.vent_lines && (p.vent_lines->length || p.vent_lines->pull_down_ratio ||
                         p.vent_lines->model == VentLines::Model::across)) {
        const bool across = p.vent_lines->model == VentLines::Model::across;
        const double vent = 0.5 * p.vent_diameter;
        const Cord& cord = p.vent_lines->cord.name.empty() ? p.line : p.vent_lines->cord;
        vent_lines = (across ? 0.5 : 1.0) * p.gores * vent_line_length(p, vent, vent + made.seam) *
                     cord.linear_density();
    }
    return made.fabric + p.gores * made.seam * p.tapes.radial.linear_density() +
           pi * (made.skirt * p.tapes.skirt.linear_density() +
                 p.vent_diameter * p.tapes.vent.linear_density()) +
           p.gores * (p.line_length + p.riser_length) * p.line.linear_density() + vent_lines;
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
