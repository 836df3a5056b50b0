// A payload that is a body on the risers: what carries its attachments along. Its centre of mass is the
// payload's node and moves like any other node.
#pragma once

#include <memory>
#include <vector>

#include "fullsim/forces/force_model.hpp"
#include "fullsim/state.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::fullsim {

class Body {
public:
    virtual ~Body() = default;

    /// As it hangs along `axis` at the start, at rest: what of it is in state.body.
    virtual void start(State& state, const Vec3& axis) const = 0;

    /// Gathers the forces on its attachments [N] to the payload's node as well; state.riser_force is the
    /// risers' sum. Called after all forces are in the state.
    virtual void gather(State& state, NodeIndex payload, NodeIndex first_attachment) const = 0;

    /// From t to t + dt after the payload's node has moved there. kick: [s] from the middle of the step
    /// before to that of this one.
    virtual void advance(State& state, NodeIndex payload, NodeIndex first_attachment, double kick,
                         double dt) const = 0;

    /// Kinetic [J], beyond that of the payload's node, at the time of the velocities in the node records.
    virtual double inner_energy(const State& state, NodeIndex payload, NodeIndex first_attachment) const = 0;

    /// [s] bound on the step where risers of that stiffness [N/m] hold its attachments.
    virtual double critical_step(const State& state, const ForceModels& structure, NodeIndex first_attachment,
                                 double riser) const = 0;
};

/// Body of the scene's payload; null where it is a point mass. Throws SceneError where it is deformable and
/// its tetrahedra are too few for that.
std::unique_ptr<const Body> make_body(const Scene& scene, const Mesh& mesh);

/// A body's own x, y and z as columns, along its principal axes.
Eigen::Matrix3d principal_axes(const Lumped& body);

/// Unit vector from the foot of a body to its head, as its attitude [unit quaternion] has turned it.
Vec3 body_axis(const BodyState& state, const Eigen::Matrix3d& principal_axes);

}  // namespace twinchute::fullsim
