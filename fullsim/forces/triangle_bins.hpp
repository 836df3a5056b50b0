// Which boxes hold a point: bins of equal size, each with the boxes that overlap it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lib/math/vec.hpp"

namespace twinchute::fullsim {

/// Around a triangle and what belongs to it [m].
struct Box {
    Vec3 low, high;

    bool holds(const Vec3& x) const {
        return (x.array() >= low.array()).all() && (x.array() <= high.array()).all();
    }
};

class TriangleBins {
public:
    /// Boxes by number of their triangle, all of them finite; they have to outlive the bins.
    explicit TriangleBins(std::span<const Box> boxes);

    /// visit(triangle) for each whose box holds the point, in their order.
    template <class Visit>
    void each_that_holds(const Vec3& x, Visit&& visit) const {
        if (!around_.holds(x)) return;
        const Eigen::Vector3i at = bin_of(x);
        const std::size_t b = index(at.x(), at.y(), at.z());
        for (std::int32_t k = first_[b]; k < first_[b + 1]; ++k)
            if (boxes_[in_bins_[k]].holds(x)) visit(in_bins_[k]);
    }

private:
    Eigen::Vector3i bin_of(const Vec3& x) const;
    std::size_t index(int i, int j, int k) const {
        return (static_cast<std::size_t>(i) * static_cast<std::size_t>(counts_.y()) +
                static_cast<std::size_t>(j)) *
                   static_cast<std::size_t>(counts_.z()) +
               static_cast<std::size_t>(k);
    }
    template <class Visit>
    void each_bin(const Box& box, Visit&& visit) const;

    std::span<const Box> boxes_;
    Box around_;
    double size_ = 0.0;                          // [m] of a bin
    Eigen::Vector3i counts_;                     // of bins along x, y, z
    std::vector<std::int32_t> first_, in_bins_;  // of each bin; triangles, bin by bin
};

}  // namespace twinchute::fullsim
