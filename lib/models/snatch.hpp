// Forces of taut lines on the two bodies at their ends: stiffness, and the snatch force in closed form.
#pragma once

#include <cmath>

namespace twinchute {

/// Mass [kg] of two bodies in their motion relative to each other.
inline double reduced_mass(double a, double b) {
    return a * b / (a + b);
}

/// Largest force [N] of massless lines of stiffness [N/m] that bring bodies with the relative speed dv [m/s]
/// and the reduced mass [kg] to one speed: 1/2 m dv^2 = F^2/(2 k).
inline double snatch_force_mass_spring(double dv, double stiffness, double mass) {
    return dv * std::sqrt(stiffness * mass);
}

/// Force [N] that a step of dv [m/s] at the end of lines of axial stiffness EA [N] and mass per length [kg/m]
/// sends along them as a wave, before it is reflected: F = dv sqrt(EA mu).
inline double snatch_force_wave(double dv, double axial_stiffness, double linear_density) {
    return dv * std::sqrt(axial_stiffness * linear_density);
}

}  // namespace twinchute
