// Sizing: what a parachute has to be to meet a descent rate, a force and a deceleration, for one type of
// canopy or for several side by side.
#pragma once

#include <cstddef>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "rom/size/search.hpp"

namespace twinchute::rom {

/// One type of canopy, sized.
struct Candidate {
    std::string type;                ///< of the catalogue; empty: the scene's canopy has none
    std::vector<std::string> notes;  ///< what was assumed, what else would do
    std::string why_not;             ///< why it was not sized; `found` is empty then
    std::optional<Found> found;

    bool meets() const { return found && found->judged.meets(); }
    double mass() const { return sized_parachute(found->scene).mass; }  ///< estimated [kg], of a found one
};

struct Sized {
    std::vector<const VaryRow*> vary;
    std::vector<Candidate> candidates;
    /// The lightest that meets the limits; where none does, the one that misses them least. Null: none could
    /// be sized.
    const Candidate* best() const;
};

/// Sizes a scene that has limits. Throws Interrupted.
Sized size_scene(const Scene& scene, const std::stop_token& stop);

}  // namespace twinchute::rom
