// Contact of two canopies of a cluster along a plane between them.
//
// Nodes behind the plane are pushed back in proportion to their depth and mass. The plane is at right angles to
// the line between the canopies' centres of mass, and where the pushes of both sides are as large as each other:
// it has no mass. All forces are the gradient of one energy, U = 1/2 sum m_i w^2 d_i^2, that turns and shifts of
// everything leave as it is; with what it does to the centres, momentum, angular momentum and energy of the two
// are kept whatever shape they have.
//
// Round canopies that press on each other do meet along a plane, as two soap bubbles of one size do. A canopy
// that half slips under another meets it along a plane here, too. Without friction.
#pragma once

#include <span>
#include <vector>

#include "fullsim/state.hpp"
#include "lib/record/archive.hpp"

namespace twinchute::fullsim {

/// The nodes of one canopy.
struct PressedNodes {
    std::span<const NodeRecord> node;
    std::span<const double> mass;  ///< [kg] material
    double stiffness = 0.0;        ///< w^2 [1/s^2], over mass
};

/// Contact of two canopies at one instant.
struct PlaneContact {
    double gap = 0.0;      ///< [m] along the line of centres; below zero where they touch
    double closing = 0.0;  ///< [m/s] rate at which it shrinks, if the fastest nodes of both are the nearest
    double force = 0.0;    ///< [N] by which each pushes the other
    double energy = 0.0;   ///< [J]
    double depth = 0.0;    ///< [m] deepest node behind the plane
};

/// Adds the forces [N] on the nodes of each to `on_a` and `on_b`, which have one for each node.
PlaneContact press_apart(const PressedNodes& a, const PressedNodes& b, std::span<Lanes> on_a,
                         std::span<Lanes> on_b);

/// A pair of a cluster's canopies, and when it has to be looked at again.
class CanopyPlane {
public:
    CanopyPlane(std::size_t first, std::size_t second, double near) : first_(first), second_(second), near_(near) {}

    std::size_t first() const { return first_; }
    std::size_t second() const { return second_; }
    /// Whether they may touch at `time` [s].
    bool is_due(double time, std::int64_t step) const {
        return step >= looked_at_ + longest_wait || last_.gap - last_.closing * (time - time_) < near_;
    }
    void note(const PlaneContact& contact, double time, std::int64_t step) {
        last_ = contact;
        time_ = time;
        looked_at_ = step;
        if (contact.force > largest_force_) largest_force_ = contact.force;
        if (contact.depth > deepest_) deepest_ = contact.depth;
        if (contact.force > 0.0 && first_touch_ < 0.0) first_touch_ = time;
    }
    const PlaneContact& last() const { return last_; }
    double largest_force() const { return largest_force_; }  ///< [N]
    double deepest() const { return deepest_; }              ///< [m]
    double first_touch() const { return first_touch_; }      ///< [s]; below zero: they never did

    void serialize(Archive& archive);

private:
    static constexpr std::int64_t longest_wait = 10;  // steps: fabric is seldom faster than some metres a second

    std::size_t first_, second_;
    double near_;  // [m]
    PlaneContact last_{};
    double time_ = 0.0;
    std::int64_t looked_at_ = -longest_wait;
    double largest_force_ = 0.0, deepest_ = 0.0, first_touch_ = -1.0;
};

}  // namespace twinchute::fullsim
