// Peak opening force by formula: what handbooks give in place of an integration, each with the range in
// which it holds.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "lib/models/drag_area.hpp"

namespace twinchute {

/// Inputs of the formulas, at snatch. SI.
struct OpeningForceInputs {
    double speed = 0.0;         ///< v_s [m/s] through the air
    double density = 0.0;       ///< [kg/m^3]
    double altitude = 0.0;      ///< [m] above sea level
    double gravity = 0.0;       ///< [m/s^2]
    double mass = 0.0;          ///< [kg] of payload and parachute
    double drag_area = 0.0;     ///< (C_D S)_0 [m^2]
    double filling_time = 0.0;  ///< t_f [s]
    double initial_time = 0.0;  ///< t_i [s]
    double eta = 0.0;           ///< sqrt((C_D S)_i/(C_D S)_0) [-]
    double added_mass = 0.0;    ///< [kg] of the open canopy; 0 where the scene has none
    const DragAreaLaw* law = nullptr;
    const DragAreaTable* table = nullptr;  ///< in place of the law
    double exponent = 0.0;                 ///< of a power in place of the law; 0: none
    std::optional<double> coefficient;     ///< C_x [-] of the canopy's type
};

/// A row of the table of formulas.
struct OpeningForceForm {
    std::string_view name, title, source;
    /// Peak drag [N]: what pulls payload and parachute together. Not a number where an input is missing.
    double (*force)(const OpeningForceInputs& in);
    /// Why it does not hold for these inputs; empty where it does.
    std::string (*outside)(const OpeningForceInputs& in);
};

std::span<const OpeningForceForm> opening_force_forms();

/// A = 2 m/((C_D S)_0 rho v_s t) [-] for an opening that takes t [s]: Knacke's ballistic parameter, and
/// Ludtke's M where t is the time of filling. Large for a payload that does not slow down meanwhile.
double ballistic_parameter(const OpeningForceInputs& in, double t);

/// Largest D/((C_D S)_0 q_s) [-] until the fill fraction `last` of an opening that nothing but drag brakes:
/// v/v_s = 1/(1 + I(tau)/A), I the integral of the growth. Exact.
double drag_only_peak(const DragAreaGrowth& growth, double ballistic, double last);
/// Largest D/((C_D S)_0 q_s) [-] of an opening by `law` from eta^2 on, until it is full.
double drag_only_peak(const DragAreaLaw& law, double eta, double ballistic);

/// C_k = F/((C_D S)_0 q_s) [-] against the mass ratio R_m = rho (C_D S)_0^1.5/m, of a canopy that fills over
/// `diameters` of sqrt((C_D S)_0): two curves of the momentum-impulse theorem (Potvin), as fitted by a third
/// hand to a digitised figure. R_m from 1e-4 to 10.
double momentum_impulse_coefficient(double mass_ratio, double diameters);

/// X_1 [-] by canopy loading W/(C_D S)_0 [Pa]: Knacke, Fig. 5-48, straight between its readings at grid
/// lines over the logarithm of the loading.
double force_reduction_by_loading(double loading);

}  // namespace twinchute
