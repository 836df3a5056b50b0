// Scenes that cases start from, built in code: they need no file when the program runs.
#pragma once

#include "lib/scene/scene.hpp"

namespace twinchute::compare {

/// A C-9 at line stretch, straight down at 21 m/s in uniform air of sea-level density.
Scene c9_at_line_stretch();

/// Inflation without added mass and initial phase: what closed forms assume.
Scene c9_of_closed_forms();

/// Snatch with neither air nor weight to speak of, on a static line from an anchor that stands still.
Scene c9_snatch_in_empty_space();

/// Open from the start, at rest.
Scene c9_inflated();

/// Few elements: 28 gores of six rows, one riser.
Scene c9_coarse();

/// Two elements across a gore, gores that touch, and a filling that is predicted.
Scene c9_that_fills_itself();

/// Released at rest in its pack on a static line, few elements, with the noise of one seed.
Scene c9_packed();

/// Ends a run of the scene so many seconds after release.
void stop_after(Scene& scene, double seconds);

}  // namespace twinchute::compare
