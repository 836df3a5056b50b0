// A payload that turns: a rigid body on the risers. It moves like the payload's node and turns about it; the
// points that risers are tied to go along.
#pragma once

#include <array>
#include <vector>

#include "fullsim/solid.hpp"
#include "fullsim/state.hpp"

namespace twinchute::fullsim {

class RigidBody {
public:
    /// The body of a scene, with as many places for risers: one in the middle of its upper face, four on the
    /// corners of a box, else evenly around the upper rim of a cylinder (the first half a step after x).
    /// Throws SceneError where a box has another number.
    RigidBody(const Scene& scene, int risers);
    /// Any body: principal moments of inertia [kg m^2] about its own axes, places [m] from its centre of
    /// mass.
    RigidBody(double mass, const Vec3& moments, std::vector<Vec3> places)
        : mass_(mass), moments_(moments), places_(std::move(places)) {}

    /// Of the risers' ends from the centre of mass, along the body's own axes [m].
    const std::vector<Vec3>& places() const { return places_; }
    const Vec3& moments() const { return moments_; }

    /// The body's z axis along `axis`, x along its unitOrthogonal, as meshes are drawn out; at rest.
    static BodyState upright(const Vec3& axis);

    /// What risers pull at its places is taken from them [N] to the payload's node, and to state.body as a
    /// torque; state.riser_force is their sum. After all structural forces are in state.force.
    void gather(State& state, NodeIndex payload, NodeIndex first_place) const;

    /// From t to t + dt after the payload's node has moved there: the angular momentum as velocities by the
    /// midpoint rule, L += kick torque, and the attitude by turns about the principal axes one after the
    /// other, forth and back (Dullweber, Leimkuhler and McLachlan 1997, J. Chem. Phys. 107, 5840): of second
    /// order, exact in L, without drift in energy. The quaternion is brought to length 1 after each step.
    void advance(State& state, NodeIndex payload, NodeIndex first_place, double kick, double dt) const;

    /// The places and their velocities from the payload's node and state.body.
    void place(State& state, NodeIndex payload, NodeIndex first_place) const;

    /// [J] of the turning, at the time of the velocities in the node records.
    double turning_energy(const BodyState& body) const;

    /// [s] bound on the step where risers of that stiffness [N/m] hold each place: 2 sqrt(m'/K) with the
    /// inertia m' that a place has across its arm, from below 1/m' = 1/m + r^2/I_min.
    double stable_step(double stiffness) const;

private:
    double mass_;   // [kg]
    Vec3 moments_;  // [kg m^2]
    std::vector<Vec3> places_;
};

}  // namespace twinchute::fullsim
