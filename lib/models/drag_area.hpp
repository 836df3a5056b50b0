// Growth of the drag area during filling: value and rate, so that no caller differentiates.
#pragma once

#include <span>
#include <string_view>

namespace twinchute {

struct ValueAndRate {
    double value = 0.0;
    double rate = 0.0;
};

/// A row of the table of drag-area laws.
struct DragAreaLaw {
    std::string_view name;
    std::string_view source;
    /// (C_D S)_t/(C_D S)_0 and its derivative with respect to x, for the fill fraction
    /// x in [0, 1] and eta = sqrt((C_D S)_i/(C_D S)_0) in [0, 1].
    ValueAndRate (*at)(double x, double eta);
    /// Integral of that ratio from 0 to x: what brakes a body that nothing but drag acts on.
    double (*integral)(double x, double eta);
};

std::span<const DragAreaLaw> drag_area_laws();
const DragAreaLaw* find_drag_area_law(std::string_view name);

}  // namespace twinchute
