// Added mass of the air in and around the canopy: mass and its rate together.
#pragma once

#include <span>
#include <string_view>

#include "lib/models/drag_area.hpp"

namespace twinchute {

struct AddedMassSpec;

/// A row of the table of canopy volumes.
struct AddedMassModel {
    std::string_view name;
    std::string_view source;
    /// Included plus apparent mass [kg] for air of density rho [kg/m^3], canopy radius R [m] and
    /// apparent-mass ramp phi' [-], each with its rate per second. porosity: open over total area [-].
    ValueAndRate (*at)(const AddedMassSpec&, double rho, ValueAndRate radius, ValueAndRate ramp,
                       double porosity);
    double largest_porosity = 1.0;  ///< up to which it holds [-]
};

/// Treatment of the momentum of air that joins the canopy.
enum class AddedMassMomentum {
    inertia_only,  ///< the paper: M_a adds to the inertia, (dM_a/dt) v is left out
    accreting      ///< air at rest is brought to the canopy's speed: (dM_a/dt) v while M_a grows
};

/// Whose radius the added mass has once the canopy is open. While it fills, it follows the drag area.
enum class AddedMassRadius {
    shape_once_open,  ///< the paper: that of the canopy's own shape, in a model that has one
    drag_area         ///< the steady radius R_0 that the drag area stands for
};

/// A choice of row with its parameters.
struct AddedMassSpec {
    const AddedMassModel* model = nullptr;
    AddedMassMomentum momentum = AddedMassMomentum::inertia_only;
    AddedMassRadius open_radius = AddedMassRadius::shape_once_open;
    double depth_ratio = 0.41;  ///< h_p/D_p [-] (Ewing, quoted in the paper, 5.2)

    ValueAndRate mass(double rho, ValueAndRate radius, ValueAndRate ramp, double porosity) const {
        return model->at(*this, rho, radius, ramp, porosity);
    }
    bool operator==(const AddedMassSpec&) const = default;
};

std::span<const AddedMassModel> added_mass_models();
const AddedMassModel* find_added_mass(std::string_view name);

}  // namespace twinchute
