// Materials as the structural model needs them. Plain data in SI.
#pragma once

#include <string>

namespace twinchute {

/// A fabric: isotropic St. Venant-Kirchhoff membrane in plane stress.
struct Fabric {
    std::string name;
    double density = 0.0;         ///< [kg/m^3]
    double youngs_modulus = 0.0;  ///< [Pa]
    double poisson_ratio = 0.0;   ///< [-]
    double thickness = 0.0;       ///< [m]

    bool operator==(const Fabric&) const = default;
};

/// A cord or tape: a tension-only cable of solid circular cross-section.
struct Cord {
    std::string name;
    double density = 0.0;         ///< [kg/m^3]
    double youngs_modulus = 0.0;  ///< [Pa]
    double diameter = 0.0;        ///< [m]; also the width that the air sees

    double section() const { return 0.25 * 3.14159265358979323846 * diameter * diameter; }  ///< [m^2]
    double axial_stiffness() const { return youngs_modulus * section(); }                   ///< EA [N]
    double linear_density() const { return density * section(); }                           ///< [kg/m]
    bool operator==(const Cord&) const = default;
};

}  // namespace twinchute
