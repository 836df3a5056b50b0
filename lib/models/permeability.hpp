// Flow of air through fabric and through openings in it.
#pragma once

#include <cmath>

namespace twinchute {

/// [Pa] half an inch of water, at which fabric is tested.
inline constexpr double permeability_pressure = 0.5 * 249.08891;

/// Fabric by Forchheimer's law, dp = alpha u + beta u^2: viscous at low speeds, by inertia at high ones.
struct Permeability {
    double alpha = 0.0;  ///< [Pa s/m]
    double beta = 0.0;   ///< [Pa s^2/m^2]; both zero: nothing passes

    bool is_tight() const { return alpha == 0.0 && beta == 0.0; }
    /// dp [Pa] that drives the speed u [m/s]; odd in u.
    double pressure(double u) const { return u * (alpha + beta * std::abs(u)); }
    /// u [m/s] through the fabric under dp [Pa], the inverse of pressure(); odd in dp. 0 of tight fabric.
    double speed(double dp) const {
        if (is_tight()) return 0.0;
        // The root of the quadratic without its cancellation, and right for beta = 0.
        return 2.0 * dp / (alpha + std::sqrt(alpha * alpha + 4.0 * beta * std::abs(dp)));
    }
    bool operator==(const Permeability&) const = default;
};

/// The fabric that lets through `speed` [m/s] at half an inch of water, with the share of viscosity and
/// inertia in MIL-C-7020 type III: 254.4 and 37.6 (a published fit of 48 laboratory points, 101 Pa to 11 kPa,
/// grade B). One point leaves the shape of the law open; this one is measured. Tight of 0.
inline Permeability permeability_at_half_inch(double speed) {
    if (!(speed > 0.0)) return {};
    constexpr Permeability fitted{254.4, 37.6};
    const double slower = fitted.speed(permeability_pressure) / speed;
    return {fitted.alpha * slower, fitted.beta * slower * slower};
}

/// Discharge coefficient [-] of a sharp-edged opening: Kirchhoff's free jet from a slit, pi/(pi + 2).
inline constexpr double discharge_coefficient = 3.14159265358979323846 / (3.14159265358979323846 + 2.0);

/// Speed [m/s] over the open area of slots and vent under dp [Pa] in air of density rho [kg/m^3]; odd in dp.
inline double opening_speed(double dp, double rho) {
    return std::copysign(discharge_coefficient * std::sqrt(2.0 * std::abs(dp) / rho), dp);
}

}  // namespace twinchute
