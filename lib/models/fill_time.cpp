#include "lib/models/fill_time.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "lib/math/interpolation.hpp"
#include "lib/math/vec.hpp"
#include "lib/models/atmosphere.hpp"

namespace twinchute {
namespace {

/// (rho/rho_0)^k where an exponent is given (paper, 5.2).
double density_factor(const FillTime& choice, const FillTimeInputs& in) {
    return choice.density_exponent == 0.0 ? 1.0
                                          : std::pow(in.density / sea_level_density, choice.density_exponent);
}

/// n D0/v_s (paper, Eq. 13).
double fill_constant(const FillTime& choice, const FillTimeInputs& in) {
    return choice.n * in.nominal_diameter / in.snatch_speed * density_factor(choice, in);
}

/// n D0/v_s^power with D0 in feet and v_s in feet per second.
double in_feet(const FillTime& choice, const FillTimeInputs& in, double power) {
    constexpr double foot = 0.3048;  // [m]
    return choice.n * (in.nominal_diameter / foot) / std::pow(in.snatch_speed / foot, power) *
           density_factor(choice, in);
}

double knacke_085(const FillTime& choice, const FillTimeInputs& in) {
    return in_feet(choice, in, 0.85);
}

double knacke_09(const FillTime& choice, const FillTimeInputs& in) {
    return in_feet(choice, in, 0.9);
}

/// 0.65 lambda_g D0/v_s with lambda_g in percent.
double ribbon(const FillTime&, const FillTimeInputs& in) {
    return 65.0 * in.geometric_porosity * in.nominal_diameter / in.snatch_speed;
}

/// Straight between the points; beyond the first and last their n.
double tabulated(const FillTime& choice, const FillTimeInputs& in) {
    const FillTable& table = *choice.table;
    const double at = std::clamp(table.abscissa(in), table.at.front(), table.at.back());
    return Between(table.at, at).linear(table.n) * in.nominal_diameter / in.snatch_speed;
}

/// The canopy is full once its mouth has taken in V_0 more than its fabric has let through, while mouth,
/// fabric and drag area grow with t^6 and nothing but drag brakes:
///   t_f = 14 m/(rho v_s (C_D S)_0) {exp[rho V_0 (C_D S)_0/(2 m A)] - 1},  A = A_M0 - S_0 k sqrt(C_p rho/2),
/// with the permeability v = k sqrt(pressure). Infinite where the fabric lets through all that enters.
double ludtke(const FillTime& choice, const FillTimeInputs& in) {
    const FillBalance& balance = *choice.balance;
    const double R = in.steady_radius;
    const double volume = balance.volume.value_or(2.0 / 3.0 * pi * R * R * R);
    const double mouth = balance.mouth_area.value_or(pi * R * R);
    const double fabric = 0.25 * pi * in.nominal_diameter * in.nominal_diameter;
    const double k = in.permeability / std::sqrt(permeability_pressure);
    const double taking = mouth - fabric * k * std::sqrt(0.5 * balance.pressure_coefficient * in.density);
    if (!(taking > 0.0)) return std::numeric_limits<double>::infinity();
    const double braking = in.density * in.drag_area / (2.0 * in.mass);  // [1/m]
    return 7.0 / (braking * in.snatch_speed) * std::expm1(braking * volume / taking);
}

double given(const FillTime& choice, const FillTimeInputs&) {
    return choice.given;
}

constexpr std::array<FillTimeModel, 7> fill_times{{
    {"fill-constant", "paper Eq. 13; Knacke NWC TP 6575, Table 5-6", "subsonic, n of the canopy's type",
     fill_constant, false, true},
    {"knacke-0.85", "Knacke NWC TP 6575, solid flat circular canopies, by two transcriptions that agree",
     "field tests; n = 4 for standard porosity, 2.5 for low, in feet and feet per second", knacke_085, true},
    {"knacke-0.9", "cross canopies, one transcription that leaves open which length it takes; here D0",
     "n = 8.7, in feet and feet per second", knacke_09, true},
    {"ribbon", "Knacke NWC TP 6575, ribbon canopies, by two transcriptions that agree",
     "preliminary design; geometric porosity lambda_g", ribbon, false, true, true},
    {"ludtke", "balance of mass in the manner of Ludtke (NOLTR 72-146), derived anew",
     "solid fabric; drag area growing with t^6, gravity left out", ludtke},
    {"table", "a CSV file of the scene", "between its points", tabulated},
    {"given", "a measured or otherwise known time", "any", given},
}};

}  // namespace

std::span<const FillTimeModel> fill_time_models() {
    return fill_times;
}

const FillTimeModel* find_fill_time(std::string_view name) {
    const auto row = std::ranges::find(fill_times, name, &FillTimeModel::name);
    return row == fill_times.end() ? nullptr : &*row;
}

}  // namespace twinchute
