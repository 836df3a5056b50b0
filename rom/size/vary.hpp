// What sizing may change in a scene: a row for each.
#pragma once

#include <span>
#include <string_view>

#include "lib/scene/scene.hpp"

namespace twinchute::rom {

/// Which of the values that meet the limits is wanted.
enum class Goal { smallest, largest };

struct Bounds {
    double low = 0.0, high = 0.0;  ///< both above 0
};

struct VaryRow {
    std::string_view name, unit, title;
    std::string_view what;  ///< goes along with it, in words
    Goal (*goal)(const SizeSpec&);
    Bounds (*bounds)(const Scene&);
    double (*get)(const Scene&);
    void (*set)(Scene&, double);
};

std::span<const VaryRow> vary_rows();
const VaryRow* find_vary(std::string_view name);

/// D0 [m] whose steady drag carries payload and parachute at max_descent_rate in the densest air of the fall,
/// that at the ground: sqrt(8 m g/(pi rho C_D0 v^2)). The run, with whatever mass such a canopy has, comes
/// later. Not for a scene without that limit.
double diameter_by_descent_rate(const Scene& scene);

/// The scene with another type of canopy of the same diameter: C_D0, C_x, D_p/D0, n and law in place of its
/// own, as far as the type has them. `kept`: what it does not have, so that the scene's own stands.
Scene with_type(const Scene& scene, const CanopyType& type, std::vector<std::string>& kept);

/// How the parachute's mass follows its diameter, in words.
std::string mass_text(const Parachute& chute);

}  // namespace twinchute::rom
