#include "lib/scene/needs.hpp"

#include <fmt/format.h>

namespace twinchute {
namespace {

/// A part of a parachute that a scene may leave out.
struct PartKey {
    const char* key;
    bool of_lines;
    bool in_mesh;  ///< a mesh of one's own says it
    bool (*given)(const Parachute& p);
};

constexpr PartKey part_keys[] = {
    {"parachute.gores", true, true, [](const Parachute& p) { return p.gores > 0; }},
    {"parachute.line_length", true, true, [](const Parachute& p) { return p.line_length > 0.0; }},
    {"parachute.riser_length", true, true, [](const Parachute& p) { return p.riser_length > 0.0; }},
    {"parachute.line", true, false, [](const Parachute& p) { return !p.line.name.empty(); }},
    {"parachute.projected_diameter_ratio", false, false,
     [](const Parachute& p) { return p.projected_diameter_ratio > 0.0; }},
    {"parachute.vent_diameter", false, true, [](const Parachute& p) { return p.vent_diameter > 0.0; }},
    {"parachute.risers", false, true, [](const Parachute& p) { return p.risers > 0; }},
    {"parachute.fabric", false, false, [](const Parachute& p) { return !p.fabric.name.empty(); }},
    {"parachute.tapes.radial", false, true, [](const Parachute& p) { return !p.tapes.radial.name.empty(); }},
    {"parachute.tapes.skirt", false, true, [](const Parachute& p) { return !p.tapes.skirt.name.empty(); }},
    {"parachute.tapes.vent", false, true, [](const Parachute& p) { return !p.tapes.vent.name.empty(); }},
};

std::vector<std::string> missing(const Parachute& chute, bool only_lines) {
    std::vector<std::string> keys;
    for (const PartKey& part : part_keys)
        if ((only_lines ? part.of_lines : !(part.in_mesh && chute.mesh)) && !part.given(chute))
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

std::optional<Warning> stand_in(const Parachute& chute) {
    if (!chute.type || chute.mesh || chute.type->meshed.shape != MeshedCanopy::Shape::flat_circular)
        return std::nullopt;
    return Warning{fmt::format("a flat circular canopy stands in for a {} one", chute.type->title),
                   chute.type->meshed.why,
                   "trust drag area and forces of the whole, not the stresses; or give parachute.mesh"};
}

}  // namespace twinchute
