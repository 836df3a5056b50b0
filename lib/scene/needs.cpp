#include "lib/scene/needs.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "lib/scene/keys.hpp"

namespace twinchute {
namespace {

/// A part of a parachute that a scene may leave out.
struct PartKey {
    const char* key;
    bool of_lines;
    bool in_mesh;  ///< a mesh of one's own says it

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
    {"parachute.vent_diameter", false, true},
    {"parachute.risers", false, true},
    {"parachute.fabric", false, false},
    {"parachute.tapes.radial", false, true},
    {"parachute.tapes.skirt", false, true},
    {"parachute.tapes.vent", false, true},
};

std::vector<std::string> missing(const Parachute& chute, bool only_lines) {
    std::vector<std::string> keys;
    for (const PartKey& part : part_keys)
        if ((only_lines ? part.of_lines : !(part.in_mesh && chute.mesh)) && !part.is_given(chute))
            keys.emplace_back(part.key);
    return keys;
}

}  // namespace

std::vector<std::string> missing_lines(const Parachute& chute) {
    return missing(chute, true);
}

std::vector<std::string> missing_structure(const Parachute& chute) {
    return missing(chute, false);
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

std::optional<Warning> stand_in(const Parachute& chute) {
    if (!chute.type || chute.mesh || chute.type->meshed.shape != MeshedCanopy::Shape::flat_circular)
        return std::nullopt;
    return Warning{fmt::format("a flat circular canopy stands in for a {} one", chute.type->title),
                   chute.type->meshed.why,
                   "trust drag area and forces of the whole, not the stresses; or give parachute.mesh"};
}

}  // namespace twinchute
