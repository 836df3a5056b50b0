// Added mass of the air in and around the canopy: mass and its rate together.
#pragma once

#include <span>
#include <string_view>

#include "lib/models/drag_area.hpp"

namespace twinchute {

/// A row of the table of canopy volumes.
struct AddedMassModel {
    std::string_view name;
    std::string_view source;
    /// Included plus apparent mass [kg] for air of density rho [kg/m^3], canopy radius R [m] and
    /// apparent-mass ramp phi' [-], each with its rate per second.
    ValueAndRate (*mass)(double rho, ValueAndRate radius, ValueAndRate ramp);
};

/// What becomes of the momentum of air that joins the canopy.
enum class AddedMassMomentum {
    inertia_only  ///< the paper: M_a adds to the inertia, (dM_a/dt) v is left out
};

struct AddedMassSpec {
    const AddedMassModel* model = nullptr;
    AddedMassMomentum momentum = AddedMassMomentum::inertia_only;
};

/// "hemisphere".
std::span<const AddedMassModel> added_mass_models();
const AddedMassModel* find_added_mass(std::string_view name);

}  // namespace twinchute
