// Handbook data of a type of canopy, whatever its size: ranges of coefficients, each with its source and how
// far that can be relied on. Read from data/parachutes/types/ by lib/scene/canopy_types.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace twinchute {

/// Range that the tests of a type gave, from low to high.
struct TypeRange {
    double low = 0.0, high = 0.0;
    std::string source;
    std::string grade;  ///< A: transcriptions agree, B: one transcription, C: computed, R: recollection

    double middle() const { return 0.5 * (low + high); }
    /// A recollection without a source is shown and never used.
    bool may_be_default() const { return grade != "R"; }
    bool operator==(const TypeRange&) const = default;
};

/// Part of a gore from one distance along its seam to the next. The constructed canopy has one slope there,
/// or turns evenly from one slope to another. Slopes are angles below the plane across the axis [rad].
struct GorePanel {
    double length;       ///< along the seam, over that of the other panels [-]
    double top, bottom;  ///< slope at its upper and at its lower edge
    bool gap = false;    ///< no fabric between its edges, which the radial tapes hold together

    bool operator==(const GorePanel&) const = default;
};

/// The canopy that the full model meshes for a type.
struct MeshedCanopy {
    enum class Shape {
        own,            ///< flat circular, of the panels below, or a cross
        flat_circular,  ///< a flat circular canopy stands in for one of another shape
        none            ///< no canopy that it can mesh comes near
    };
    Shape shape = Shape::none;
    std::string why = "the type's file does not say that a flat circular canopy may stand in for it";
    std::vector<GorePanel> gore;  ///< from apex to skirt; empty: none, or flat circular
    std::string gore_source;      ///< of these numbers, or of the arms' ratio
    /// Width of the arms over the length from end to end, of a cross of two strips [-]; 0: gores.
    double arm_ratio = 0.0;
    bool slotted = false;      ///< narrow slots across the gores: fabric and slots are smeared to one sheet
    bool open_middle = false;  ///< D0 is that of the fabric's area: the middle within the vent does not count

    bool operator==(const MeshedCanopy&) const = default;
};

struct CanopyType {
    std::string name;                                    ///< of its file, e.g. "flat-circular"
    std::string title;                                   ///< e.g. "flat circular"
    std::optional<TypeRange> drag_coefficient;           ///< C_D0 [-] on the nominal area, lines of D0
    std::optional<TypeRange> opening_force_coefficient;  ///< C_x [-] at infinite mass
    std::optional<TypeRange> projected_diameter_ratio;   ///< D_p/D0 [-]
    std::optional<TypeRange> fill_constant;              ///< n [-] of t_f = n D0/v_s, unreefed
    std::optional<TypeRange> oscillation;                ///< [rad], average angle; no model uses it
    std::optional<TypeRange> growth_exponent;            ///< j [-]: (C_D S) grows with the power j of time
    MeshedCanopy meshed;

    bool operator==(const CanopyType&) const = default;
};

}  // namespace twinchute
