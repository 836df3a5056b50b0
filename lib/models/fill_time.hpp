// Filling time: from line stretch until the drag area first reaches its steady value.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lib/models/permeability.hpp"

namespace twinchute {

/// Inputs that a filling-time correlation may depend on; of one canopy and its share of the payload.
struct FillTimeInputs {
    double nominal_diameter = 0.0;    ///< D0 [m]
    double snatch_speed = 0.0;        ///< v_s [m/s], airspeed
    double density = 0.0;             ///< [kg/m^3] at snatch
    double payload_mass = 0.0;        ///< m_l [kg]
    double mass = 0.0;                ///< [kg] of payload and canopy
    double gravity = 0.0;             ///< [m/s^2]
    double drag_area = 0.0;           ///< (C_D S)_0 [m^2]
    double steady_radius = 0.0;       ///< D_p/2 [m]; 0 where the scene has none
    double permeability = 0.0;        ///< [m/s] through the fabric at `permeability_pressure`
    double geometric_porosity = 0.0;  ///< lambda_g [-]

    double froude_number() const { return snatch_speed * snatch_speed / (gravity * nominal_diameter); }
    double mass_ratio() const {
        return payload_mass / (density * nominal_diameter * nominal_diameter * nominal_diameter);
    }
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
    /// t_f v_s/D0 is the same at any snatch speed.
    bool by_diameters = false;
    /// Nothing but the canopy's geometric porosity gives its constant.
    bool by_porosity = false;
};

/// Measured fill constants n = t_f v_s/D0 against one number of the opening.
struct FillTable {
    enum class By { froude_number, mass_ratio };

    std::string file;  ///< as the scene names it
    By by = By::froude_number;
    std::vector<double> at;  ///< [-] rising
    std::vector<double> n;   ///< [-]

    double abscissa(const FillTimeInputs& in) const {
        return by == By::froude_number ? in.froude_number() : in.mass_ratio();
    }
    bool covers(const FillTimeInputs& in) const {
        return abscissa(in) >= at.front() && abscissa(in) <= at.back();
    }
    bool operator==(const FillTable&) const = default;
};

/// Inputs of Ludtke's balance of mass beside the opening. Sizes of the open canopy; those that are absent
/// follow from the steady radius.
struct FillBalance {
    std::optional<double> volume;       ///< V_0 [m^3]; absent: half a sphere, 2/3 pi R_0^3
    std::optional<double> mouth_area;   ///< A_M0 [m^2]; absent: pi R_0^2
    double pressure_coefficient = 1.0;  ///< C_p [-] of the pressure across the fabric

    bool operator==(const FillBalance&) const = default;
};

/// A choice of row with its parameters.
struct FillTime {
    const FillTimeModel* model = nullptr;
    double n = 0.0;                 ///< fill constant [-], [ft, ft/s] with the correlations that have a unit
    double density_exponent = 0.0;  ///< k of (rho/rho_0)^k [-], beside n
    double given = 0.0;             ///< [s], for "given"
    std::optional<FillTable> table = {};      ///< for "table"
    std::optional<FillBalance> balance = {};  ///< for "ludtke"

    double seconds(const FillTimeInputs& inputs) const { return model->seconds(*this, inputs); }
    bool operator==(const FillTime&) const = default;
};

std::span<const FillTimeModel> fill_time_models();
const FillTimeModel* find_fill_time(std::string_view name);

}  // namespace twinchute
