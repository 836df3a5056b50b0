// Pressure in a canopy whose filling is predicted: the air that comes in at its mouth, the volume that its
// fabric sweeps and what leaks out have to balance (docs/theory/filling.md, full model).
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <span>

#include "fullsim/elements/passes.hpp"
#include "fullsim/forces/force_model.hpp"
#include "fullsim/mesh/mesh.hpp"
#include "fullsim/time/central_difference.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::fullsim {

/// The skirt's polygon.
struct Mouth {
    Vec3 area = Vec3::Zero();      ///< [m^2] into the canopy
    Vec3 velocity = Vec3::Zero();  ///< [m/s] mean of its nodes
};

/// Balance of the air in one canopy; holds its constants alone.
class InflowBalance {
public:
    /// The balance of the scene's parachute; nothing where its filling is prescribed.
    static std::optional<InflowBalance> of(const Scene& scene, const Mesh& mesh);

    /// Nodes around the skirt, each beside the next.
    std::span<const NodeIndex> skirt() const { return skirt_; }
    /// at(k): the record of the k-th of them.
    template <class At>
    Mouth mouth(At&& at) const {
        Mouth mouth;
        const std::size_t count = skirt_.size();
        const Vec3 first = to_vec3(at(0).x);
        Vec3 here = Vec3::Zero();  // from the first, so that altitude does not cost digits
        for (std::size_t k = 0; k < count; ++k) {
            mouth.velocity += to_vec3(at(k).v) / static_cast<double>(count);
            const Vec3 next = to_vec3(at((k + 1) % count).x) - first;
            mouth.area += 0.5 * here.cross(next);
            here = next;
        }
        return mouth;
    }

    /// Solves the balance at state.time: sets areas, pressure and drag area of state.air, and state.inflow.
    /// of_canopy: sums over its triangles. Returns the force [N] that has to act uniformly on the fabric as
    /// well. It takes away what is across the air: a pressure on folded fabric would have lift without the
    /// drag that lift costs, and glide. And it takes away the sum of what the air around does, which resists
    /// growth, not motion.
    Vec3 set_pressure(SystemState& state, const ElementSums& of_canopy, const Mouth& mouth) const;

    /// Volume and mobility of state.inflow, from the nodes as they are. Between two measurements the volume
    /// goes on with what the fabric sweeps.
    void measure(State& state, const NodeConstants& constants) const;

    /// [m^2] projected area at which the canopy is full.
    double full_area() const { return full_area_; }

private:
    InflowBalance(const Scene& scene, const Mesh& mesh);

    /// Inertia of the air around: kinetic energy 1/2 I Q^2 where the canopy displaces Q [m^3/s].
    struct Inertance {
        double value, rate;  ///< I [kg/m^4] and dI/dt
    };
    /// Half a pulsating sphere with the volume of a bulb: I = rho/(2 pi R), which is 1/2 (2 pi rho R^3) R'^2.
    Inertance inertance(const InflowState& inflow, double density) const;

    /// [m^3/s] through the fabric and its openings under dp [Pa]. wetted: area [m^2] that the air reaches.
    double leak(double dp, double wetted, double density) const;

    const Mesh& mesh_;
    std::vector<NodeIndex> skirt_, vent_;
    Filling filling_;
    Permeability fabric_;
    double geometric_porosity_;                     // [-]
    double fabric_area_, full_area_, full_volume_;  // [m^2], [m^2], [m^3]
    double smallest_mouth_;                         // [m^2] that counts
};

/// The reference for layouts, in place of make_canopy_pressure.
std::unique_ptr<const ForceModel> make_inflow_pressure(const Mesh& mesh, const InflowBalance& balance);

}  // namespace twinchute::fullsim
