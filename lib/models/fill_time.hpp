// Filling time: from line stretch until the drag area first reaches its steady value.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace twinchute {

/// What a filling-time correlation may depend on.
struct FillTimeInputs {
    double nominal_diameter = 0.0;  ///< D0 [m]
    double snatch_speed = 0.0;      ///< v_s [m/s], airspeed
    double density = 0.0;           ///< [kg/m^3] at snatch
};

struct FillTime;

/// A row of the table of filling-time models.
struct FillTimeModel {
    std::string_view name;
    std::string_view source;
    std::string_view range;  ///< where the source says it holds, in words
    double (*seconds)(const FillTime&, const FillTimeInputs&);
    /// Its constant has a unit: the correlation does not scale as times of lengths over speeds do.
    bool dimensional = false;
};

/// A choice of row with its parameters.
struct FillTime {
    const FillTimeModel* model = nullptr;
    double n = 0.0;                 ///< fill constant, for "fill-constant" [-] and "knacke-0.85" [ft, ft/s]
    double density_exponent = 0.0;  ///< k of (rho/rho_0)^k [-], for the same two
    double given = 0.0;             ///< [s], for "given"
    double porosity = 0.0;          ///< lambda_g [-], geometric, for "ribbon"

    double seconds(const FillTimeInputs& inputs) const { return model->seconds(*this, inputs); }
    bool operator==(const FillTime&) const = default;
};

std::span<const FillTimeModel> fill_time_models();
const FillTimeModel* find_fill_time(std::string_view name);

}  // namespace twinchute
