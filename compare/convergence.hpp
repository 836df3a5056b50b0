// Estimates of the exact answer from a sequence of ever finer ones, and which answers are worth their time.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace twinchute::compare {

/// Whether every value lies further in the same direction than the one before.
bool is_monotone(std::span<const double> values);

struct Extrapolation {
    double value = 0.0;
    double order = 0.0;  ///< [-] observed
};

/// Orders between which three meshes are taken to converge. Membranes of constant strain are of order 1 in
/// strain and 2 in displacement; what comes out far from that is chance, not convergence.
inline constexpr double lowest_order = 0.8, highest_order = 4.0;

/// Richardson extrapolation to size 0 from three mesh sizes, the coarsest first, whose ratios may differ: f =
/// f_0 + C h^p. Nothing where the values are not monotone or the order is out of bounds.
std::optional<Extrapolation> richardson(const std::array<double, 3>& size,
                                        const std::array<double, 3>& value);

struct CostAndError {
    double cost = 0.0, error = 0.0;
};

/// Tells of each point whether none is as good in one and better in the other. What is not finite is never on
/// the front.
std::vector<bool> pareto_front(std::span<const CostAndError> points);

}  // namespace twinchute::compare
