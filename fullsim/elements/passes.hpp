// Arguments and results of the loops over elements, the same for every storage.
#pragma once

#include <array>

#include "fullsim/forces/membrane.hpp"
#include "fullsim/state.hpp"
#include "lib/models/cylinder_drag.hpp"

namespace twinchute::fullsim {

/// Sums over elements.
struct ElementSums {
    double positive_area = 0.0, signed_area = 0.0;  ///< [m^2] along e_r
    double dissipated = 0.0;                        ///< [W]
    /// Largest elastic tension [N] of the elements, or first principal stress resultant at full stiffness
    /// [N/m]. Not a number where that of one is none.
    double largest_load = 0.0;
    std::array<double, 3> area{};  ///< [m^2] of triangles, outwards
    double swept = 0.0;            ///< [m^3/s] that triangles move through, outwards
    /// Derivatives of what pairs in contact hold, by the arm from the axis and by its direction [N], [N m].
    std::array<double, 3> by_arm{}, by_turning{};

    ElementSums& operator+=(const ElementSums& other) {
        positive_area += other.positive_area;
        signed_area += other.signed_area;
        dissipated += other.dissipated;
        largest_load = nan_max(largest_load, other.largest_load);
        swept += other.swept;
        for (int c = 0; c < 3; ++c) {
            area[c] += other.area[c];
            by_arm[c] += other.by_arm[c];
            by_turning[c] += other.by_turning[c];
        }
        return *this;
    }
};

/// Sum and maximum over all elements of a kind.
struct EnergyAndStrain {
    double energy = 0.0;  ///< [J]
    double strain = 0.0;  ///< [-] largest tensile strain, as StrainExtremum
};

/// Air on triangles: none; pressure along e_r and across it (paper, Eqs 11 and 12); or one pressure in the
/// canopy, normal to the fabric, with the volume that the fabric sweeps.
enum class AirOnFabric { none, pushes, fills };

/// Membranes, and the pressure on them.
struct MembranePass {
    MembraneLaw law;
    std::array<double, 3> direction{};  ///< e_r
    double radial_pressure = 0.0;       ///< phi
    double weight = 1.0;                ///< share of their stiffness that membranes have
};

/// Drag of fabric until the canopy fills.
struct FabricDragPass {
    double factor = 0.0;           ///< 1/2 rho C_D [kg/m^3]
    std::array<double, 3> wind{};  ///< [m/s]
};

/// Fabric as springs, and folds.
struct SpringPass {
    double repulsion = 0.0;  ///< of folded fabric over its stiffness in tension [-]
    bool springs = false;    ///< these act,
    bool folds = false;      ///< and these
    bool folded = false;     ///< as State: for the critical time step
};

/// Pairs of nodes of neighbouring gores.
struct ContactPass {
    std::array<double, 3> centre{}, direction{};  ///< of the axis: a point of it [m], a unit vector
};

/// The air around lines, and their diameter.
struct LineAir {
    const CylinderDragTable* coefficient = nullptr;
    double diameter = 0.0, density = 0.0, viscosity = 0.0;  ///< [m], [kg/m^3], [Pa s]
    std::array<double, 3> wind{};                           ///< [m/s]
};

}  // namespace twinchute::fullsim
