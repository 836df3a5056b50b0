// Corrections of a drag coefficient from a handbook's table for a parachute: the length of its lines, and the
// wake of its forebody.
#pragma once

#include <span>
#include <string_view>

namespace twinchute {

/// A factor on the drag coefficient, and whether the figure that it is read from reaches that far. Beyond its
/// ends the factor of the nearer end is held.
struct DragFactor {
    double value = 1.0;
    bool inside = true;
};

/// Drag coefficient against the effective length of the lines: a curve for each kind of canopy.
struct LineRatioModel {
    std::string_view name, source;
    std::string_view range;              ///< of L_e/D0, in words
    DragFactor (*factor)(double ratio);  ///< C_D0(L_e/D0)/C_D0(1) [-]; L_e from skirt to confluence
};

std::span<const LineRatioModel> line_ratio_models();
const LineRatioModel* find_line_ratio(std::string_view name);

/// Drag coefficient in the wake of a forebody.
struct ForebodyWakeModel {
    std::string_view name, source;
    std::string_view range;
    /// C_D/C_D,inf [-]; `trailing`: distance of the skirt behind the body, `diameter`: D_p of the canopy,
    /// each over the diameter of the body.
    DragFactor (*factor)(double trailing, double diameter);
};

std::span<const ForebodyWakeModel> forebody_wake_models();
const ForebodyWakeModel* find_forebody_wake(std::string_view name);

}  // namespace twinchute
