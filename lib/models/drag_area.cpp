#include "lib/models/drag_area.hpp"

#include <algorithm>
#include <array>

namespace twinchute {
namespace {

/// [(1 - eta) x^3 + eta]^2 (paper, Eq. 14).
ValueAndRate ludtke(double x, double eta) {
    const double root = (1.0 - eta) * x * x * x + eta;
    const double root_rate = 3.0 * (1.0 - eta) * x * x;
    return {root * root, 2.0 * root * root_rate};
}

constexpr std::array<DragAreaLaw, 1> laws{{
    {"ludtke", "Ludtke's law for solid flat circular canopies, paper Eqs 14-15", ludtke},
}};

}  // namespace

std::span<const DragAreaLaw> drag_area_laws() {
    return laws;
}

const DragAreaLaw* find_drag_area_law(std::string_view name) {
    const auto row = std::ranges::find(laws, name, &DragAreaLaw::name);
    return row == laws.end() ? nullptr : &*row;
}

}  // namespace twinchute
