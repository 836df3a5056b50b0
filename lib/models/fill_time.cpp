#include "lib/models/fill_time.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/models/atmosphere.hpp"

namespace twinchute {
namespace {

/// n D0/v_s (paper, Eq. 13), times (rho/rho_0)^k where an exponent is given (paper, 5.2).
double fill_constant(const FillTime& choice, const FillTimeInputs& in) {
    const double opening_distance = choice.n * in.nominal_diameter;
    const double density_factor = choice.density_exponent == 0.0
                                      ? 1.0
                                      : std::pow(in.density / sea_level_density, choice.density_exponent);
    return opening_distance / in.snatch_speed * density_factor;
}

double given(const FillTime& choice, const FillTimeInputs&) {
    return choice.given;
}

constexpr std::array<FillTimeModel, 2> models{{
    {"fill-constant", "paper Eq. 13; Knacke NWC TP 6575, Table 5-6", "subsonic, n of the canopy's type",
     fill_constant},
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
