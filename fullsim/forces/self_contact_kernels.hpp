// Inner loops over pairs of a node and a triangle of fabric: written once (self_contact_kernels.cpp),
// compiled for every instruction set, chosen when the program starts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "fullsim/laws/linear_motion.hpp"

namespace twinchute::fullsim::self_contact {

constexpr double thickness_now = 0.25;  // at most, of a triangle's longest edge as it is: a pack is small
constexpr double touching = 1e-3;       // of the thickness: nearer than that a node has no side yet

/// Numbers known of a pair, in their order.
enum PairNumber {
    fullness,        ///< [-] double area over longest edge squared; a sliver has less
    most_thickness,  ///< [m] that a triangle of this size ever has
    slow_viscosity,  ///< [N s/m] of friction where slip is slow
    kept_side,       ///< 1, -1; 0: not decided yet
    kept_thickness,  ///< [m] gap below which both push each other off
    pair_numbers
};

/// Pairs in groups as wide as the kernels. The last one is filled up with pairs of one node alone.
struct Pairs {
    std::size_t groups = 0;
    /// [group][node, corners 0 to 2][lane]: 32 times the number of a node, where its row of forces begins [B]
    const std::int32_t* node = nullptr;
    const double* number = nullptr;  ///< [group][PairNumber][lane]
};

struct Law {
    double stiffness;  ///< [N/m]
    double friction;   ///< [-]
};

struct Pushed {
    double dissipated;  ///< [W]
    double deepest;  ///< [-] farthest that a node is on the wrong side, over the triangle's largest thickness
};

struct Kernels {
    std::string_view instruction_set;
    int lanes;  ///< of a group
    /// Adds the forces of pairs that push. attention: a bit for each lane of a group whose side or thickness
    /// has to change, which carries no force yet. record [m], [m/s]: 8 a node; force [N]: 4.
    Pushed (*push)(const double* record, double* force, Pairs, const Law&, std::uint32_t* attention);
    /// For each pair at least how far the node is from the triangle over which its window is open, and from
    /// its plane on which side [m]: both zero over a sliver.
    void (*measure)(const double* record, Pairs, double* distance, double* gap);
    /// The square of the farthest [m^2] that a node is from where it is expected, times its weight. before:
    /// all x, all y, all z, all weights of `count` nodes, as many as fill up lanes, but no node after `last`
    /// is read.
    double (*farthest)(const double* record, const double* before, std::size_t count, std::size_t last,
                       const LinearMotion&);
};

/// One for each instruction set that is compiled in and that this machine has, the best first.
std::span<const Kernels> all_kernels();

}  // namespace twinchute::fullsim::self_contact
