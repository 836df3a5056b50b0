#include "fullsim/canopy/cross.hpp"

#include <algorithm>
#include <cmath>

#include "lib/scene/needs.hpp"

namespace twinchute::fullsim {

CrossOutline cross_outline(const Parachute& chute) {
    const double ratio = cross_arm_ratio(chute), length = cross_length(chute.nominal_diameter, ratio);
    return {ratio * length, length, chute.gores / 4};
}

std::vector<Vec3> folded_cross(const CrossOutline& outline, std::span<const Vec3> node, double mouth_area) {
    const double across = std::sqrt(std::min(1.0, mouth_area / outline.mouth()));
    const double down = std::sqrt(1.0 - across * across);
    std::vector<Vec3> folded;
    folded.reserve(node.size());
    for (const Vec3& x : node)
        folded.emplace_back(across * x.x(), across * x.y(),
                            down * std::max(std::abs(x.x()), std::abs(x.y())));
    return folded;
}

}  // namespace twinchute::fullsim
