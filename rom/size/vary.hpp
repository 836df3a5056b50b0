// Quantities of a scene that sizing may change, a row each.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lib/scene/scene.hpp"

namespace twinchute::rom {

/// Which of the values that meet the limits is wanted.
enum class Goal {
    smallest,
    largest,
    min_load  ///< whichever leaves the most of force and deceleration
};

struct Bounds {
    double low = 0.0, high = 0.0;  ///< both above 0
};

struct VaryRow {
    std::string_view name, unit, title;
    std::string_view what;  ///< goes along with it, in words
    /// Why a scene does not have it; empty where it does.
    std::string (*why_unavailable)(const Scene&);
    Goal (*goal)(const SizeSpec&);
    Bounds (*bounds)(const Scene&);  ///< between which the search begins
    Bounds (*ends)(const Scene&);    ///< as far as it goes on where they are the best
    double (*get)(const Scene&);
    void (*set)(Scene&, double);
};

std::span<const VaryRow> vary_rows();
const VaryRow* find_vary(std::string_view name);

/// The parachute that is sized.
const Parachute& sized_parachute(const Scene& scene);

/// D0 [m] whose steady drag carries payload and parachutes at max_descent_rate in the densest air of the
/// fall, that at the ground: sqrt(8 m g/(pi rho C_D0 v^2)), of what the payload and the other parachutes that
/// stay do not carry. The run, with whatever mass such a canopy has, comes later. Not for a scene without
/// that limit.
double diameter_by_descent_rate(const Scene& scene);

/// The scene with another type of canopy of the same diameter: C_D0, C_x, D_p/D0, n and law in place of its
/// own. A filling time or a law that the scene itself gives is kept for every type; what the type does not
/// have as well, and `notes` say so. The type has to have a drag coefficient.
Scene with_type(const Scene& scene, const CanopyType& type, std::vector<std::string>& notes);

/// How the parachute's mass follows its diameter, in words.
std::string mass_text(const Parachute& chute);

}  // namespace twinchute::rom
