#include "lib/models/fill_time.hpp"

#include <algorithm>
#include <array>
#include <cmath>

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

/// n D0/v_s^0.85 with D0 in feet and v_s in feet per second.
double knacke_085(const FillTime& choice, const FillTimeInputs& in) {
    constexpr double foot = 0.3048;  // [m]
    return choice.n * (in.nominal_diameter / foot) / std::pow(in.snatch_speed / foot, 0.85) *
           density_factor(choice, in);
}

/// 0.65 lambda_g D0/v_s with lambda_g in percent.
double ribbon(const FillTime& choice, const FillTimeInputs& in) {
    return 65.0 * choice.porosity * in.nominal_diameter / in.snatch_speed;
}

double given(const FillTime& choice, const FillTimeInputs&) {
    return choice.given;
}

constexpr std::array<FillTimeModel, 4> models{{
    {"fill-constant", "paper Eq. 13; Knacke NWC TP 6575, Table 5-6", "subsonic, n of the canopy's type",
     fill_constant},
    {"knacke-0.85", "Knacke NWC TP 6575, solid flat circular canopies, by two transcriptions that agree",
     "field tests; n = 4 for standard porosity, 2.5 for low, in feet and feet per second", knacke_085, true},
    {"ribbon", "Knacke NWC TP 6575, ribbon canopies, by two transcriptions that agree",
     "preliminary design; geometric porosity lambda_g", ribbon},
    {"given", "a measured or otherwise known time", "any", given},
}};

}  // namespace

std::span<const FillTimeModel> fill_time_models() {
    return models;
}

const FillTimeModel* find_fill_time(std::string_view name) {
    const auto row = std::ranges::find(models, name, &FillTimeModel::name);
    return row == models.end() ? nullptr : &*row;
}

}  // namespace twinchute
