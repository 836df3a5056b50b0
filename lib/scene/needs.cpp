#include "lib/scene/needs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lib/math/vec.hpp"
#include "lib/scene/keys.hpp"

namespace twinchute {
namespace {

/// A part of a parachute that a scene may leave out.
struct PartKey {
    const char* key;
    bool of_lines;
    bool in_mesh;  ///< a mesh of one's own says it
    bool of_vent = false;

    bool is_given(const Parachute& chute) const {
        return std::get<BindingOf<Parachute>>(find_key(scene_keys(), key)->binding).get(chute).has_value();
    }
};

constexpr PartKey part_keys[] = {
    {"parachute.gores", true, true},
    {"parachute.line_length", true, true},
    {"parachute.riser_length", true, true},
    {"parachute.line", true, false},
    {"parachute.projected_diameter_ratio", false, false},
    {"parachute.vent_diameter", false, true, true},
    {"parachute.risers", false, true},
    {"parachute.fabric", false, false},
    {"parachute.tapes.radial", false, true},
    {"parachute.tapes.skirt", false, true},
    {"parachute.tapes.vent", false, true, true},
};

std::vector<std::string> missing(const Parachute& chute, bool only_lines) {
    std::vector<std::string> keys;
    for (const PartKey& part : part_keys)
        if ((only_lines ? part.of_lines
                        : !(part.in_mesh && chute.mesh) && !(part.of_vent && cross_arm_ratio(chute) > 0.0)) &&
            !part.is_given(chute))
            keys.emplace_back(part.key);
    return keys;
}

}  // namespace

std::vector<std::string> missing_lines(const Parachute& chute) {
    return missing(chute, true);
}

std::vector<std::string> missing_structure(const Parachute& chute) {
    std::vector<std::string> keys = missing(chute, false);
    if (chute.type && chute.type->meshed.slotted && !chute.mesh && !(slot_share(chute) > 0.0))
        keys.emplace_back("parachute.geometric_porosity");
    return keys;
}

std::string lacks_canopy(const Parachute& chute) {
    if (!chute.type || chute.mesh || chute.type->meshed.shape != MeshedCanopy::Shape::none) return {};
    return fmt::format("{}: {}", chute.type->title, chute.type->meshed.why);
}

std::vector<GorePanel> gore_panels(const Parachute& chute) {
    if (!chute.type || chute.type->meshed.shape != MeshedCanopy::Shape::own) return {};
    std::vector<GorePanel> panels = chute.type->meshed.gore;
    for (std::size_t i = 0; i < std::min(panels.size(), chute.cone_angle.size()); ++i)
        panels[i].top = panels[i].bottom = chute.cone_angle[i];
    for (std::size_t i = 0; i < std::min(panels.size(), chute.panel_length.size()); ++i)
        panels[i].length = chute.panel_length[i];
    return panels;
}

std::size_t panel_count(const Parachute& chute) {
    if (chute.mesh) return 0;
    return cross_arm_ratio(chute) > 0.0 ? 2 : gore_panels(chute).size();
}

double cross_arm_ratio(const Parachute& chute) {
    if (!chute.type || chute.mesh || !(chute.type->meshed.arm_ratio > 0.0)) return 0.0;
    return chute.arm_ratio.value_or(chute.type->meshed.arm_ratio);
}

double cross_length(double nominal_diameter, double arm_ratio) {
    return nominal_diameter * std::sqrt(0.25 * pi / (arm_ratio * (2.0 - arm_ratio)));
}

SlingGeometry sling_geometry(const PayloadBody& body) {
    const bool box = body.shape == PayloadBody::Shape::box;
    const double x = 0.5 * body.size[0] * (box ? 1.0 : std::sqrt(0.5)), y = box ? 0.5 * body.size[1] : x;
    const double length = body.sling_length.value(), reach = std::hypot(x, y);
    return {x, y, length > reach ? std::sqrt(length * length - reach * reach) : 0.0, length};
}

std::vector<CrossRefusal> cross_refusals(const Scene& scene) {
    const Parachute& chute = scene.parachutes.front();
    if (!(cross_arm_ratio(chute) > 0.0)) return {};
    std::vector<CrossRefusal> refusals;
    const auto refuse_if = [&](bool wrong, const char* key, const char* why) {
        if (wrong) refusals.push_back({key, why});
    };
    const int gores = chute.gores, columns = scene.full.mesh.gore_columns;
    refuse_if(chute.vent_diameter > 0.0, "parachute.vent_diameter", "a cross has no vent");
    refuse_if(chute.vent_lines.has_value(), "parachute.vent_lines", "a cross has no vent");
    refuse_if(gores > 0 && (gores % 4 != 0 || gores < 8), "parachute.gores",
              "each of the four arms has as many lines, and one at each corner");
    refuse_if(gores % 4 == 0 && (gores / 4 - 1) * columns % 2 != 0, "full.mesh.gore_columns",
              "elements between two lines: an arm needs an even number of them across");
    refuse_if(!chute.reefing.empty(), "parachute.reefing",
              "a reefing line slides in its rings, and between arms they are farther apart than along them");
    refuse_if(chute.filling.is_predicted(), "parachute.filling",
              "predicted: its balance of air knows no open corners");
    refuse_if(scene.full.contact == Contact::gores, "full.contact", "a cross has no gores");
    refuse_if(scene.full.symmetry == Symmetry::sector, "full.symmetry", "a cross has no gores");
    return refusals;
}

std::optional<Warning> open_corners(const Parachute& chute) {
    if (!(cross_arm_ratio(chute) > 0.0)) return std::nullopt;
    return Warning{
        "the drag acts on the fabric as one pressure, and air passes between the arms unseen",
        fmt::format("{} canopies are open from arm to arm", chute.type->title),
        "projected area and D_p are those of the fabric; the stability that open corners give, and "
        "that the canopy turns, are no result here"};
}

Meridian gore_meridian(const Parachute& chute) {
    const double area = 0.25 * pi * chute.nominal_diameter * chute.nominal_diameter;
    const std::vector<GorePanel> panels = gore_panels(chute);
    return has_open_middle(chute)
               ? open_meridian(panels, chute.gores, area, polygon_radius(chute.vent_diameter, chute.gores))
               : Meridian(panels, chute.gores, area);
}

bool has_open_middle(const Parachute& chute) {
    return chute.type && !chute.mesh && chute.type->meshed.open_middle;
}

bool holds_vent_down(const Parachute& chute) {
    return chute.vent_lines && chute.vent_lines->model == VentLines::Model::pull_down;
}

double vent_line_length(const Parachute& chute, double vent, double skirt) {
    const VentLines& lines = *chute.vent_lines;
    if (lines.length) return *lines.length;
    // Across the vent, from corner to corner of its polygon.
    if (lines.model == VentLines::Model::across)
        return 2.0 * polygon_radius(chute.vent_diameter, chute.gores);
    return lines.joint.value_or(chute.line_length) + (1.0 - *lines.pull_down_ratio) * (skirt - vent);
}

double slot_share(const Parachute& chute) {
    if (!chute.type || !chute.type->meshed.slotted || chute.mesh) return 0.0;
    const double vent = std::pow(chute.vent_diameter / chute.nominal_diameter, 2);
    return std::max(0.0, (chute.geometric_porosity - vent) / (1.0 - vent));
}

namespace {

Fabric smeared(const Parachute& chute, Fabric fabric) {
    const double solid = 1.0 - slot_share(chute);
    fabric.thickness *= solid;
    if (fabric.strength) *fabric.strength *= solid;
    return fabric;
}

}  // namespace

Fabric meshed_fabric(const Parachute& chute) {
    return smeared(chute, chute.fabric);
}

Fabric meshed_fabric(const Parachute& chute, std::size_t panel) {
    const bool own = panel < chute.panel.size() && !chute.panel[panel].fabric.name.empty();
    return smeared(chute, own ? chute.panel[panel].fabric : chute.fabric);
}

std::optional<Warning> smeared_slots(const Parachute& chute) {
    const double slots = slot_share(chute);
    if (!(slots > 0.0)) return std::nullopt;
    return Warning{
        fmt::format(
            "slots are smeared: a sheet of {:.3g} % of the fabric's thickness and strength stands for "
            "both",
            100.0 * (1.0 - slots)),
        fmt::format("slots of {} canopies are narrower than an element", chute.type->title),
        "trust forces and the shape of the whole; across slots only tapes carry load, so that tapes have "
        "more "
        "of it and fabric less than here"};
}

std::optional<Warning> open_middle(const Parachute& chute) {
    if (!has_open_middle(chute)) return std::nullopt;
    return Warning{"projected area and D_p are those of the fabric, the open middle left out",
                   fmt::format("D0 of {} canopies is that of their fabric's area", chute.type->title),
                   "hold the handbook's D_p/D0 against the diameter of the skirt's seams"};
}

bool has_gaps(const Parachute& chute) {
    return !chute.mesh && std::ranges::any_of(gore_panels(chute), &GorePanel::gap);
}

double gap_share(const Parachute& chute) {
    if (!has_gaps(chute)) return 0.0;
    constexpr int as_round_as_a_circle = 4000;  // gores, where the scene gives none: within 1e-6
    const std::vector<GorePanel> panels = gore_panels(chute);
    Parachute cut = chute;
    if (cut.gores == 0) cut.gores = as_round_as_a_circle;
    const Meridian meridian = gore_meridian(cut);
    double area = 0.0, top = 0.0;
    for (std::size_t i = 0; i < panels.size(); ++i) {
        const double bottom = meridian.edges()[i];
        if (panels[i].gap) area += meridian.area(top, bottom);
        top = bottom;
    }
    return area / (0.25 * pi * chute.nominal_diameter * chute.nominal_diameter);
}

Warning open_gaps(const Parachute& chute) {
    return Warning{chute.filling.is_predicted()
                       ? "the air pushes the fabric with one pressure; what passes the gaps leaks, no more"
                       : "the drag acts on the fabric as one pressure, and air passes the gaps unseen",
                   chute.mesh ? std::string("the mesh has gaps, which nothing but its tapes bridges")
                              : fmt::format("gores of {} canopies have gaps that radial tapes alone bridge; "
                                            "no tape lies along their edges",
                                            chute.type->title),
                   "projected area and D_p are those of the fabric; the stability that gaps give is no "
                   "result here"};
}

std::optional<Warning> stand_in(const Parachute& chute) {
    if (!chute.type || chute.mesh || chute.type->meshed.shape != MeshedCanopy::Shape::flat_circular)
        return std::nullopt;
    return Warning{fmt::format("a flat circular canopy stands in for a {} one", chute.type->title),
                   chute.type->meshed.why,
                   "trust drag area and forces of the whole, not the stresses; or give parachute.mesh"};
}

std::optional<Warning> wind_warning(const Environment& environment, double low, double high) {
    const std::optional<Wind>& wind = environment.wind;
    if (!wind || wind->covers(low, high)) return {};
    return Warning{
        fmt::format("the wind of {} ends inside the flight", wind->table),
        fmt::format(
            "its levels reach from {:.6g} to {:.6g} m, the flight from {:.6g} to {:.6g} m; the wind of "
            "the nearest level goes on",
            wind->levels.front().altitude, wind->levels.back().altitude, low, high),
        "add levels to the table"};
}

}  // namespace twinchute
