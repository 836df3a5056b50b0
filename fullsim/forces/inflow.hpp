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

/// Surfaces without fabric: the skirt's polygon, and those that close gaps.
struct Openings {
    Vec3 mouth = Vec3::Zero();     ///< [m^2] into the canopy
    Vec3 velocity = Vec3::Zero();  ///< [m/s] mean of the mouth's nodes
    Vec3 gaps = Vec3::Zero();      ///< [m^2] out of the canopy
    double gaps_sweep = 0.0;       ///< [m^3/s]
};

/// Balance of the air in one canopy; holds its constants alone.
class InflowBalance {
public:
    /// The balance of the scene's parachute; nothing where its filling is prescribed.
    static std::optional<InflowBalance> of(const Scene& scene, const Mesh& mesh);

    /// Nodes around the skirt, each beside the next, and those of gaps.
    std::span<const NodeIndex> edges() const { return edges_; }
    /// at(k): the record of the k-th of them.
    template <class At>
    Openings openings(At&& at) const {
        Openings open;
        const Vec3 first = to_vec3(at(0).x);
        Vec3 here = Vec3::Zero();  // from the first, so that altitude does not cost digits
        for (std::size_t k = 0; k < skirt_; ++k) {
            open.velocity += to_vec3(at(k).v) / static_cast<double>(skirt_);
            const Vec3 next = to_vec3(at((k + 1) % skirt_).x) - first;
            open.mouth += 0.5 * here.cross(next);
            here = next;
        }
        for (const auto& corner : gaps_) {
            const NodeRecord a = at(corner[0]), b = at(corner[1]), c = at(corner[2]);
            const Vec3 area = 0.5 * to_vec3(b.x - a.x).cross(to_vec3(c.x - a.x));
            open.gaps += area;
            open.gaps_sweep += area.dot(to_vec3(a.v + b.v + c.v)) / 3.0;
        }
        return open;
    }

    /// Solves the balance at state.time: sets areas, pressure and drag area of state.air, and state.inflow.
    /// of_canopy: sums over its triangles. Returns the force [N] that has to act uniformly on the fabric as
    /// well. It takes away what is across the air: a pressure on folded fabric would have lift without the
    /// drag that lift costs, and glide. And it takes away the sum of what the air around does, which resists
    /// growth, not motion.
    Vec3 set_pressure(SystemState& state, const ElementSums& of_canopy, const Openings& open) const;

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
    std::vector<NodeIndex> edges_, vent_;
    std::size_t skirt_;                             // so many edges_ are around the mouth
    std::vector<std::array<std::size_t, 3>> gaps_;  // corners among edges_
    Filling filling_;
    Permeability fabric_;
    double geometric_porosity_;              // [-] of what closes the canopy: fabric and gaps
    double area_, full_area_, full_volume_;  // [m^2] of that, unstrained, [m^2], [m^3]
    double smallest_mouth_;                  // [m^2] that counts
};

/// The reference for layouts, in place of make_canopy_pressure.
std::unique_ptr<const ForceModel> make_inflow_pressure(const Mesh& mesh, const InflowBalance& balance);

}  // namespace twinchute::fullsim
