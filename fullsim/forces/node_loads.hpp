// Loads that need no elements: what they do to a node follows from its mass or its share of the fabric. The
// node update of each layout adds them, so that a load of this kind acts in all of them.
#pragma once

#include "fullsim/forces/force_model.hpp"
#include "fullsim/mesh/mesh.hpp"

namespace twinchute::fullsim {

/// Sum of such loads at one time.
struct NodeLoads {
    Vec3 on_fabric = Vec3::Zero();    ///< [N] on the canopy by share, booked as drag
    double breathing = 0.0;           ///< [N s/m] of the canopy by share, about
    Vec3 canopy_mean = Vec3::Zero();  ///< [m/s]
    double accretion = 0.0;           ///< [kg/s] of the canopy by share, from the velocity of
    Vec3 wind = Vec3::Zero();         ///< [m/s]
    double mass_damping = 0.0;        ///< [1/s] of all nodes by mass, about
    Vec3 system_mean = Vec3::Zero();  ///< [m/s]

    /// [N s/m] of the canopy by share, for the critical time step; mass_damping is all that acts by mass.
    double damping_by_share() const { return breathing + accretion; }
};

class NodeLoad : public ForceModel {
public:
    explicit NodeLoad(const Mesh& mesh) : mesh_(mesh), fabric_area_(mesh.fabric_area()) {}

    const NodeLoad* node_load() const final { return this; }
    virtual void add_to(NodeLoads& loads, const State& state) const = 0;

    void add_forces(State& state) const final;
    void add_row_sums(const State& state, GershgorinSums& sums) const final;

protected:
    double fabric_area() const { return fabric_area_; }  ///< [m^2]

private:
    NodeLoads now(const State& state) const;
    double share(NodeIndex i) const { return mesh_.tributary_area[i] / fabric_area_; }

    const Mesh& mesh_;
    double fabric_area_;
};

}  // namespace twinchute::fullsim
