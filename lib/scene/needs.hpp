// Keys that a scene may leave out of a parachute, and the models that need them; how far its wind has to
// reach.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lib/models/meridian.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute {

/// Keys of the lines that a packed start draws out, which the scene does not give.
std::vector<std::string> missing_lines(const Parachute& chute);

/// Keys that a model of the structure needs, those of the lines among them, which the scene does not give.
std::vector<std::string> missing_structure(const Parachute& chute);

/// Why the full model has no canopy to mesh for the parachute's type; empty where it has one, where no type
/// is given, and for a mesh of one's own.
std::string lacks_canopy(const Parachute& chute);

/// Panels of the gores that the full model meshes, from apex to skirt: those of the type, with the angles and
/// lengths that the parachute has itself. Empty for flat circular canopies and where nothing else is known.
std::vector<GorePanel> gore_panels(const Parachute& chute);

/// Number of panels whose materials a parachute may name: those of its gores, of a cross the square in its
/// middle and the arms; 0: none.
std::size_t panel_count(const Parachute& chute);

/// Width over length [-] of the two strips that cross in the canopy which the full model meshes; 0: it has
/// gores, or is a mesh of one's own.
double cross_arm_ratio(const Parachute& chute);

/// Length [m] of both strips from end to end: S0 = 2 w L - w^2 is that of the nominal circle, w = ratio L.
double cross_length(double nominal_diameter, double arm_ratio);

/// A key by which the full model refuses a cross, and why.
struct CrossRefusal {
    std::string key, why;
};

/// Keys by which a scene asks of a cross more than the full model can do; empty for all others.
std::vector<CrossRefusal> cross_refusals(const Scene& scene);

/// Four slings of a payload, from where they are tied around its axis to the point where they meet.
struct SlingGeometry {
    double x, y;    ///< [m] from the axis, along either edge of the body
    double rise;    ///< [m] above the upper face; not above zero: they are too short to meet
    double length;  ///< [m]
};

/// Slings of a body that has some.
SlingGeometry sling_geometry(const PayloadBody& body);

/// Warning where a canopy is a cross.
std::optional<Warning> open_corners(const Parachute& chute);

/// Constructed meridian of these gores; they have panels.
Meridian gore_meridian(const Parachute& chute);

/// Whether the gores lie around an open middle that D0 does not count.
bool has_open_middle(const Parachute& chute);

/// Whether lines hold the vent down.
bool holds_vent_down(const Parachute& chute);

/// Length [m] of one of the vent lines, which the parachute has. vent, skirt: apex to these along the seam
/// [m].
double vent_line_length(const Parachute& chute, double vent, double skirt);

/// Share [-] of slots in the area between vent and skirt, of a type whose slots the full model smears: what
/// parachute.geometric_porosity leaves after the vent. 0 for all others, and for a mesh of one's own.
double slot_share(const Parachute& chute);

/// The sheet that the full model meshes: the fabric, thinner by its slots where these are smeared, and as
/// much weaker.
Fabric meshed_fabric(const Parachute& chute);

/// Sheet of one of its panels, which may have a fabric of its own.
Fabric meshed_fabric(const Parachute& chute, std::size_t panel);

/// Whether its gores have gaps. A mesh of one's own says by itself where it has some.
bool has_gaps(const Parachute& chute);

/// Share [-] of those gaps in the area S0 = pi/4 D0^2, which counts them. Without a number of gores, which
/// the reduced-order model does not need, that of a round canopy.
double gap_share(const Parachute& chute);

/// Warning where the mesh has gaps.
Warning open_gaps(const Parachute& chute);

/// Warning where a canopy has an open middle.
std::optional<Warning> open_middle(const Parachute& chute);

/// Warning where slots are smeared.
std::optional<Warning> smeared_slots(const Parachute& chute);

/// Warning where a flat circular canopy stands in for another type, as lacks_canopy; otherwise nothing.
std::optional<Warning> stand_in(const Parachute& chute);

/// Warning about a flight from `low` to `high` [m] through a wind whose levels end inside it.
std::optional<Warning> wind_warning(const Environment& environment, double low, double high);

}  // namespace twinchute
