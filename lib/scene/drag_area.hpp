// The drag area that a scene's parachute opens to: what is stated of it, corrected where the scene asks for
// that.
#pragma once

#include "lib/scene/scene.hpp"

namespace twinchute {

/// L_e/D0 [-] of lines and risers; 0 where the scene does not give them.
double line_ratio(const Parachute& chute);

/// Sets (C_D S)_0 of a parachute of the scene to `stated` [m^2] times what line ratio and forebody wake make
/// of it. Lines, risers, D_p/D0 and the payload's diameter have to be known where a correction needs them.
void set_drag_area(const Scene& scene, Parachute& p, double stated);

/// The parachute that the payload lands under: of those that are not cut, or else of all, the one with the
/// largest drag area, whichever place it has in the scene.
const Parachute& landing_parachute(const Scene& scene);

/// [m^2] before corrections.
double stated_drag_area(const Parachute& chute);

/// The keys that the scene's corrections need and the scene does not give.
std::vector<std::string> missing_for_corrections(const Scene& scene);

/// Says where a factor is held beyond its figure, what the factors are, and where lines far from D0 would
/// need one that the scene does not ask for.
void warn_of_drag_area(Scene& scene);

}  // namespace twinchute
