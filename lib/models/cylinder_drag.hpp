// Drag coefficient of a smooth circular cylinder in cross flow against Reynolds number.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "lib/math/lanes.hpp"

namespace twinchute {

/// C_d [-] on diameter times length, log-log interpolation of Wieselsberger's measurements
/// (1922; NACA TN 84), 0.116 <= Re <= 8.1e5. Below, the first segment's power law goes on (the
/// force vanishes there all the same); above, the last value holds.
double cylinder_drag_coefficient(double reynolds);

/// Drag coefficient tabulated at 16 points per octave and linear in between: within 0.2 % of
/// cylinder_drag_coefficient from Re = 1/16 to 1e5 and within 3 % in the drag crisis above, without a
/// logarithm. Below, C_d Re is constant, so that the force is linear in the speed (Stokes). For inner loops.
class CylinderDragTable {
public:
    CylinderDragTable();

    /// reynolds >= 0
    double operator()(double reynolds) const {
        // Sign, exponent and four leading bits of the mantissa of a double are a ready-made
        // index of cells that are 1/16 octave wide and within which Re is linear in the rest.
        // Written so that a NaN takes this way, and comes out as one.
        if (!(reynolds >= lowest)) return at_lowest_ * lowest / (reynolds + 1e-300);
        if (reynolds >= highest) return cell_.back().value;
        const auto bits = std::bit_cast<std::uint64_t>(reynolds);
        const std::uint64_t cell = (bits >> 48) - static_cast<std::uint64_t>(first_cell);
        const double start = std::bit_cast<double>(bits & 0xffff'0000'0000'0000ULL);
        return cell_[cell].value + (reynolds - start) * cell_[cell].slope;
    }

    // For loops that look up several at once: the cell of a Reynolds number from lowest to below highest is
    // the upper 16 bits of its double less first_cell, and begins where the lower 48 are zero.
    static constexpr double lowest = 0.0625;      ///< 2^-4
    static constexpr double highest = 1048576.0;  ///< 2^20
    static constexpr std::int64_t first_cell = std::bit_cast<std::int64_t>(lowest) >> 48;
    struct alignas(16) Cell {
        double value, slope;  ///< where it begins
    };
    const Cell* cells() const { return cell_.data(); }

private:
    std::array<Cell, 24 * 16> cell_{};
    double at_lowest_ = 0.0;
};

/// The table at four Reynolds numbers, all from lowest to below highest.
inline Lanes between_ends(const CylinderDragTable& table, Lanes reynolds) {
    return Lanes{table(reynolds[0]), table(reynolds[1]), table(reynolds[2]), table(reynolds[3])};
}

}  // namespace twinchute
