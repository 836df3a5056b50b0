// Materials as the structural model needs them. Plain data in SI.
#pragma once

#include <optional>
#include <string>

#include "lib/models/permeability.hpp"

namespace twinchute {

/// A fabric: isotropic St. Venant-Kirchhoff membrane in plane stress.
struct Fabric {
    std::string name;
    double density = 0.0;                 ///< [kg/m^3]
    double youngs_modulus = 0.0;          ///< [Pa]
    double poisson_ratio = 0.0;           ///< [-]
    double thickness = 0.0;               ///< [m]
    std::optional<double> strength = {};  ///< [N/m] at which a strip breaks, over its width; absent: unknown
    std::optional<Permeability> permeability = {};  ///< absent: unknown

    bool operator==(const Fabric&) const = default;
};

/// A cord or tape: a tension-only cable of solid circular cross-section.
struct Cord {
    std::string name;
    double density = 0.0;                 ///< [kg/m^3]
    double youngs_modulus = 0.0;          ///< [Pa]
    double diameter = 0.0;                ///< [m]; also the width that the air sees
    std::optional<double> strength = {};  ///< [N] at which it breaks; absent: unknown

    double section() const { return 0.25 * 3.14159265358979323846 * diameter * diameter; }  ///< [m^2]
    double axial_stiffness() const { return youngs_modulus * section(); }                   ///< EA [N]
    double linear_density() const { return density * section(); }                           ///< [kg/m]
    bool operator==(const Cord&) const = default;
};

/// Reductions of a material's strength by design practice: the seams hold less than the material does, and
/// loads are multiplied before they are compared with it.
struct StrengthFactors {
    double joint_efficiency = 1.0;  ///< strength of seams and joints over the material's [-]
    double design_factor = 1.0;     ///< safety, uneven load, wear, moisture, fatigue, all in one [-]

    bool operator==(const StrengthFactors&) const = default;
};

/// Margin [-]: how much more than `load` is allowed, over `load`; below 0 the design does not hold. strength
/// and load in the same unit, load > 0.
constexpr double strength_margin(double strength, const StrengthFactors& factors, double load) {
    return strength * factors.joint_efficiency / (factors.design_factor * load) - 1.0;
}

}  // namespace twinchute
