// Contact of two canopies of a cluster along a plane between them.
//
// Nodes behind the plane are pushed back in proportion to their depth and mass. The plane is parallel to the
// one halfway between the directions in which the payload sees the canopies' centres of mass, and where the
// pushes of both sides are as large as each other: it has no mass. All forces are the gradient of one energy,
// U = 1/2 sum m_i w^2 d_i^2, that turns and shifts of everything leave as it is; with what it does to the
// centres and the payload, momentum, angular momentum and energy are kept whatever shape canopies have.
//
// Round canopies that press on each other do meet along a plane, as two soap bubbles of one size do, and
// canopies that are drawn out side by side of whatever length stay on their sides of it. A canopy that half
// slips under another meets it along a plane here, too. Without friction.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "fullsim/state.hpp"
#include "lib/record/archive.hpp"

namespace twinchute::fullsim {

/// Nodes of one canopy, or those of them that may be behind the plane.
struct PressedNodes {
    std::span<const NodeRecord> node;
    std::span<const double> mass;  ///< [kg] material, of each
    double stiffness = 0.0;        ///< w^2 [1/s^2], over mass
    Lanes centre = splat(0.0);     ///< [m] of mass, of the whole canopy
    double canopy_mass = 0.0;      ///< [kg] likewise
    Lanes payload = splat(0.0);    ///< [m] that the canopies hang from: of both the same
};

/// Contact of two canopies at one instant.
struct PlaneContact {
    double gap = 0.0;     ///< [m] at right angles to the plane; below zero where they touch
    double force = 0.0;   ///< [N] by which each pushes the other
    double energy = 0.0;  ///< [J]
    double depth = 0.0;   ///< [m] deepest node behind the plane
    /// [N] on each canopy as a whole, spread over its nodes by their masses, and on the payload: nothing in
    /// sum.
    Lanes on_first = splat(0.0), on_second = splat(0.0), on_payload = splat(0.0);
};

/// Adds the forces [N] on the nodes of each to `on_a` and `on_b`, which have one for each node.
PlaneContact press_apart(const PressedNodes& a, const PressedNodes& b, std::span<Lanes> on_a,
                         std::span<Lanes> on_b);

/// Which of all nodes of either canopy are within `reach` [m] of the other's nearest: the only ones that may
/// touch soon.
std::array<std::vector<NodeIndex>, 2> near_nodes(const PressedNodes& a, const PressedNodes& b, double reach);

/// A pair of a cluster's canopies: nodes that may touch, and what contact has been so far.
class CanopyPlane {
public:
    CanopyPlane(std::size_t first, std::size_t second) : first_(first), second_(second) {}

    std::size_t first() const { return first_; }
    std::size_t second() const { return second_; }
    /// Fabric is seldom faster than some metres a second: every so many steps all nodes are looked at.
    static constexpr std::int64_t steps_between_searches = 20;

    /// Notes who may touch until the next search; `meanwhile`: [s] until then, `least`: [m] within which
    /// nodes always count.
    void search(const PressedNodes& a, const PressedNodes& b, double meanwhile, double least);
    const std::vector<NodeIndex>& near_first() const { return near_[0]; }
    const std::vector<NodeIndex>& near_second() const { return near_[1]; }
    bool may_touch() const { return !near_[0].empty() && !near_[1].empty(); }

    void note(const PlaneContact& contact) {
        largest_force_ = std::max(largest_force_, contact.force);
        deepest_ = std::max(deepest_, contact.depth);
    }
    double largest_force() const { return largest_force_; }  ///< [N]
    double deepest() const { return deepest_; }              ///< [m]

    /// nodes_of: how many either canopy has.
    void serialize(Archive& archive, const std::array<NodeIndex, 2>& nodes_of);

private:
    std::size_t first_, second_;
    std::array<std::vector<NodeIndex>, 2> near_;
    double largest_force_ = 0.0, deepest_ = 0.0;
};

}  // namespace twinchute::fullsim
