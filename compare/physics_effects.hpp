// Physics effects that a scene can do without: the ladder leaves out one at a time, the attribution of a
// gap brings them back one at a time.
#pragma once

#include <span>
#include <string_view>

#include "lib/scene/scene.hpp"

namespace twinchute::compare {

/// How an attribution switches an effect.
enum class Switching {
    never,  ///< it is no effect of a gap: numerical, or a choice of cost
    alone,  ///< off in both models, then back in both, everything else still off
    last    ///< back on top of everything else: it has no meaning without the rest
};

struct PhysicsEffect {
    std::string_view name;   ///< e.g. "added-mass"
    std::string_view title;  ///< e.g. "Added mass"
    std::string_view level;  ///< as the ladder names a run without it; empty: no level
    std::string_view why;    ///< what such a level shows
    bool in_rom;             ///< otherwise in the full model alone
    bool (*present)(const Scene&);
    void (*remove)(Scene&);
    double cost = 1.0;  ///< predicted of a run without it, in runs of the scene as it is
    Switching switching = Switching::never;
    /// Stands for its absence in an attribution; null: `remove`.
    void (*silence)(Scene&) = nullptr;
    std::string_view detail = {};  ///< of an attribution: what off means, where the title does not say it
};

/// In the order of the ladder and of attributions.
std::span<const PhysicsEffect> physics_effects();

/// The row of a name, or null.
const PhysicsEffect* find_physics_effect(std::string_view name);

/// Takes an effect out of a scene that has it, as an attribution understands it.
void silence(const PhysicsEffect& effect, Scene& scene);

}  // namespace twinchute::compare
