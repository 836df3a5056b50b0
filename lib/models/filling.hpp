// Filling that is predicted: how fast a canopy takes in air, from its shape, its mouth and its fabric. One
// degree of freedom, the radius of the bulb (docs/theory/filling.md, whose equations the comments number).
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include "lib/models/isotensoid.hpp"
#include "lib/models/permeability.hpp"

namespace twinchute {

struct FillingModel;

/// A choice of row with its parameters; without a row the filling is prescribed.
struct Filling {
    const FillingModel* model = nullptr;
    double initial_mouth = 0.0;  ///< eta^2 [-]: area of the bulb at snatch over that of the steady canopy
    double entrance_loss = 0.0;  ///< K [-] of the mouth, on the dynamic pressure of the air that enters
    double lowest_mouth = 0.0, highest_mouth = 0.0;  ///< [-] bracket of initial_mouth for the results
    // Assumed, each worth at most 5 % of n; no scene says them.
    double apparent_mass = 1.0;   ///< k_r [-] on half the added mass of a sphere that pulsates
    double radial_damping = 0.2;  ///< [-] on rho w times the area of half a sphere

    bool is_predicted() const { return model != nullptr; }
    bool operator==(const Filling&) const = default;
};

/// Radius of the bulb over D0, a [-], and its rate [1/s].
struct FillingMotion {
    double radius = 0.0, rate = 0.0;
};

/// Air that the canopy flies through along its axis.
struct FillingAir {
    double density = 0.0;  ///< [kg/m^3]
    double speed = 0.0;    ///< w [m/s] of the confluence
};

/// Loads of the air on a canopy in one state of its filling. SI; forces along the axis.
struct FillingLoads {
    FillingShape shape = {};     ///< lengths in D0
    double pressure = 0.0;       ///< q [Pa], dynamic, at the mouth's own speed
    double inflow = 0.0;         ///< s [-], speed of the air in the mouth over that of the mouth
    double tube_pressure = 0.0;  ///< Cp_t [-], over q
    double bulb_pressure = 0.0;  ///< dp_b [Pa] across the fabric of the bulb, outside suction included
    double drag = 0.0;           ///< D [N]
    double leak = 0.0;           ///< [m^3/s] through fabric and openings
    double volume = 0.0;         ///< [m^3]
    double volume_rate = 0.0;    ///< [m^3/s]
    double mouth_area = 0.0;     ///< [m^2]
};

/// Sizes of one canopy as filling needs them.
struct FillingSizes {
    double nominal_diameter = 0.0;  ///< D0 [m]
    double line_length = 0.0;       ///< [m] from skirt to confluence
    double drag_area = 0.0;         ///< (C_D S)_0 [m^2] of the steady canopy
    Permeability fabric = {};
    double geometric_porosity = 0.0;  ///< lambda_g [-], open over total area: vent and slots
};

/// A canopy that fills by itself. Immutable.
class FillingCanopy {
public:
    FillingCanopy(const Filling& filling, const FillingSizes& sizes);

    /// Balance of the air: inflow, leak and pressures follow from state and air, by one bracketed root.
    FillingLoads loads(const FillingMotion& motion, const FillingAir& air) const;
    /// d^2 a/dt^2 [1/s^2] by the model's equation of motion. `pull_excess`: T - D [N], pull of the lines less
    /// drag, which is the axial inertia of canopy and air.
    double acceleration(const FillingMotion& motion, const FillingAir& air, const FillingLoads& loads,
                        double pull_excess) const;
    /// da/dt [1/s] on the slow manifold: pressure in the tube is spent on the inflow, Cp_t = 0, so that the
    /// mouth takes in all it can; its own speed, next to that of a growing bulb, is left out. Below zero the
    /// fabric lets out more than that: the canopy squids.
    double balanced_rate(double radius, const FillingAir& air) const;
    /// The motion that the model begins from at a radius: on the slow manifold, or at rest.
    FillingMotion start(double radius, const FillingAir& air) const;

    /// [m/s] The fastest speed at which the mouth takes in more than the fabric lets out at every radius up
    /// to the full canopy; 0 where it never does, nothing where it does at any speed below that of sound.
    std::optional<double> critical_speed(double density) const;

    double initial_radius() const { return initial_radius_; }          ///< a_0 [-]
    double steady_radius() const { return family_->steady_radius(); }  ///< a_eq [-]
    /// [-] where a reefing line of this length [m] around the skirt is taut; a_eq of one that never is.
    double reefed_radius(double line_length) const;
    const Filling& filling() const { return filling_; }
    const FillingSizes& sizes() const { return sizes_; }
    const IsotensoidFamily& family() const { return *family_; }
    /// sigma [-]: suction outside the full canopy over q, which makes its drag (C_D S)_0.
    double suction() const { return suction_; }

private:
    /// [m^3/s] through the bulb under dp [Pa], and its slope with dp.
    struct Leak {
        double flow, slope;
    };
    Leak leak(double fabric_area, double dp, double density) const;
    double bulb_pressure(const FillingShape& shape, double radius, double inflow, double pressure) const;
    double inflow(const FillingShape& shape, double radius, double volume_rate, double density,
                  double speed) const;

    Filling filling_;
    FillingSizes sizes_;
    std::shared_ptr<const IsotensoidFamily> family_;
    double initial_radius_ = 0.0, suction_ = 0.0;
};

/// A row of the table of filling models.
struct FillingModel {
    std::string_view name;
    std::string_view source;
    std::string_view range;  ///< where it holds, in words
    /// [1/s^2], see FillingCanopy::acceleration(); null: the bulb has no inertia and stays on the slow
    /// manifold.
    double (*acceleration)(const FillingCanopy&, const FillingMotion&, const FillingAir&, const FillingLoads&,
                           double pull_excess);
    /// The balance of the air says how it fills and what it drags; otherwise it starts at rest and drags by
    /// its projected area alone.
    bool has_balance = true;
};

std::span<const FillingModel> filling_models();
const FillingModel* find_filling(std::string_view name);

}  // namespace twinchute
