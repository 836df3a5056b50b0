#include "lib/models/added_mass.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/math/vec.hpp"

namespace twinchute {
namespace {

/// M_a = M_i (1 + 3/8 phi') with M_i = rho volume_per_cube R^3 (paper, Eqs 16 and 18).
/// The density's own rate is left out: it changes over kilometres, the canopy over metres.
ValueAndRate filled(double volume_per_cube, double rho, ValueAndRate radius, ValueAndRate ramp) {
    const double per_radius_cubed = rho * volume_per_cube;
    const double square = radius.value * radius.value;
    const double included = per_radius_cubed * square * radius.value;
    const double included_rate = 3.0 * per_radius_cubed * square * radius.rate;
    const double share = 1.0 + 0.375 * ramp.value;
    return {included * share, included_rate * share + included * 0.375 * ramp.rate};
}

/// 2/3 pi R^3
ValueAndRate hemisphere(const AddedMassSpec&, double rho, ValueAndRate radius, ValueAndRate ramp, double) {
    return filled((2.0 / 3.0) * pi, rho, radius, ramp);
}

/// 2/3 pi R^2 h with the depth h = depth_ratio 2 R: the canopy keeps its shape while it grows.
ValueAndRate half_ellipsoid(const AddedMassSpec& spec, double rho, ValueAndRate radius, ValueAndRate ramp,
                            double) {
    return filled((2.0 / 3.0) * pi * 2.0 * spec.depth_ratio, rho, radius, ramp);
}

/// k_a(lambda) rho 4/3 pi R^2 h, of all the air in and around the canopy: it follows the radius alone.
ValueAndRate porous(const AddedMassSpec& spec, double rho, ValueAndRate radius, ValueAndRate, double p) {
    const double k = 1.068 * (1.0 + p * (-1.465 + p * (-0.25975 + p * 1.2626)));
    const double per_radius_cubed = k * rho * (4.0 / 3.0) * pi * 2.0 * spec.depth_ratio;
    const double square = radius.value * radius.value;
    return {per_radius_cubed * square * radius.value, 3.0 * per_radius_cubed * square * radius.rate};
}

constexpr std::array<AddedMassModel, 3> added_masses{{
    {"hemisphere", "paper Eqs 16 and 18, k' = 0.25 (solid flat circular canopy)", hemisphere},
    {"half-ellipsoid", "paper 3.3 and Eq. 18; at a depth ratio of 0.5 it is the hemisphere", half_ellipsoid},
    {"porosity",
     "k_a of a cubic in the porosity, by one transcription that lost its leading 1 (grade B): for slotted "
     "canopies, to compare with",
     porous, 0.5},
}};

}  // namespace

std::span<const AddedMassModel> added_mass_models() {
    return added_masses;
}

const AddedMassModel* find_added_mass(std::string_view name) {
    const auto row = std::ranges::find(added_masses, name, &AddedMassModel::name);
    return row == added_masses.end() ? nullptr : &*row;
}

}  // namespace twinchute
