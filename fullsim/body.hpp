// A payload that is a body on the risers: what carries its attachments along. Its centre of mass is the
// payload's node and moves like any other node, in subcycles as well.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "fullsim/forces/force_model.hpp"
#include "fullsim/state.hpp"
#include "fullsim/time/critical_step.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::fullsim {

/// Nodes of a body in the state.
struct BodyNodes {
    NodeIndex payload = 0;           ///< its centre of mass
    NodeIndex first_attachment = 0;  ///< of its attachments, one after the other
};

class Body {
public:
    virtual ~Body() = default;

    /// As it hangs at the start, at rest: what of it is in state.body. The columns of `frame` are its own x,
    /// y and z.
    virtual void start(State& state, const Eigen::Matrix3d& frame) const = 0;
    /// The attachments of a rigid one, and their velocities, from the payload's node and state.body.
    virtual void place(State&) const {}

    /// Adds what the risers pull at its attachments [N] to the force on the payload's node, right after they
    /// have pulled.
    virtual void pull(State& state) const = 0;

    // From t to t + dt, after the payload's node has moved likewise: the impulse of everything but risers,
    // one subcycle or more under these, the end of the step. kick: [s] from the middle of the step before to
    // that of this one; in subcycles that of each.
    virtual void impulse(State&, double) const {}
    virtual void move(State& state, double kick, double dt) const = 0;
    virtual void finish(State& state, double dt) const = 0;
    /// The three at once.
    void advance(State& state, double kick, double dt) const {
        impulse(state, kick);
        move(state, kick, dt);
        finish(state, dt);
    }

    /// [rad/s] at the time of the velocities in the node records; none of one whose nodes move by themselves.
    virtual Vec3 spin(const State&) const { return Vec3::Zero(); }

    /// Kinetic [J], beyond that of the payload's node, at the time of the velocities in the node records.
    virtual double inner_energy(const State& state) const = 0;

    /// Bounds on the step where risers of that stiffness [N/m] hold its attachments.
    virtual CriticalSteps critical_steps(const State& state, const ForceModels& structure,
                                         double riser) const = 0;

protected:
    explicit Body(BodyNodes nodes) : nodes_(nodes) {}
    const BodyNodes& nodes() const { return nodes_; }
    /// Node of the state that is attachment number k.
    std::size_t attachment(std::size_t k) const {
        return static_cast<std::size_t>(nodes_.first_attachment) + k;
    }

private:
    BodyNodes nodes_;
};

/// Body of the scene's payload; null where it is a point mass. Throws SceneError where it is deformable and
/// its tetrahedra are too few for that.
std::unique_ptr<const Body> make_body(const Scene& scene, const Mesh& mesh);

/// A body's own x, y and z as columns, along its principal axes.
Eigen::Matrix3d principal_axes(const Lumped& body);

/// Unit vector from the foot of a body to its head, as its attitude [unit quaternion] has turned it.
/// Principal axes of a box or a cylinder are its own.
Vec3 body_axis(const BodyState& state, const Eigen::Matrix3d& principal_axes = Eigen::Matrix3d::Identity());

/// [rad] between the axis of a body and the vertical: 0 where its head is up.
double tilt(const Vec3& axis);

/// [rad] between the axis of a body and the air that goes past it, which it moves through at `airspeed`.
double attitude_in_air(const Vec3& axis, const Vec3& airspeed);

/// [kg m^2] of a scene's box or cylinder, along its own axes, with the mass of the payload alone; none where
/// the payload does not turn as a rigid one of these.
std::optional<Vec3> moments_of_payload(const Scene& scene);

}  // namespace twinchute::fullsim
