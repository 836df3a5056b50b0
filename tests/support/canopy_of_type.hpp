// The C-9 of tests as a canopy of another type: its sizes, lines and materials, the type's gores.
#pragma once

#include <string>

#include "lib/scene/canopy_types.hpp"
#include "tests/support/c9_scene.hpp"

namespace twinchute::test {

/// Types whose gores the full model meshes by panels.
inline constexpr const char* panelled_types[] = {"conical",           "biconical",         "triconical",
                                                 "extended-skirt-10", "extended-skirt-14", "hemispherical",
                                                 "conical-ribbon",    "disk-gap-band",     "ringsail"};

/// Whose constructed meridian is an arc.
inline bool is_round(const std::string& type) {
    return type == "hemispherical" || type == "ringsail";
}

/// Types whose slots the full model smears.
inline constexpr const char* slotted_types[] = {"ringslot", "flat-ribbon", "conical-ribbon", "ringsail"};

inline Parachute canopy_of_type(const std::string& type, int gores = 28) {
    Parachute chute = c9_scene().parachutes.front();
    chute.type = read_canopy_type(type, "parachute.type", {}, TWINCHUTE_SOURCE_DIR "/data");
    chute.gores = gores;
    return chute;
}

}  // namespace twinchute::test
