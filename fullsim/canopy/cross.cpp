#include "fullsim/canopy/cross.hpp"

#include <algorithm>
#include <cmath>

#include "lib/scene/needs.hpp"

namespace twinchute::fullsim {

CrossOutline cross_outline(const Parachute& chute) {
    constexpr double tie_over_diameter = 1.0 / 6.0;
    const double ratio = cross_arm_ratio(chute), length = cross_length(chute.nominal_diameter, ratio);
    const double tie = chute.corner_tie > 0.0 ? chute.corner_tie : tie_over_diameter * chute.nominal_diameter;
    return {ratio * length, length, chute.gores / 4, tie};
}

std::vector<Vec3> folded_cross(const CrossOutline& outline, std::span<const Vec3> node, double mouth_area) {
    // Widths over those as cut, and how far an arm leads outward over its length.
    double across = std::sqrt(std::min(1.0, mouth_area / outline.mouth())), outward = across;
    const double half = 0.5 * outline.width, arm = 0.5 * (outline.length - outline.width);
    if (std::sqrt(2.0) * outward * arm > outline.tie) {
        // An octagon of sides 2 h along the arms and sqrt(2) c, the ties: 4 h^2 + 8 h c + 2 c^2.
        const double c = outline.tie / std::sqrt(2.0), h = std::sqrt(0.25 * mouth_area + 0.5 * c * c) - c;
        outward = c / arm;
        across = std::clamp(h / half, 0.0, 1.0);
    }
    const double down = std::sqrt(1.0 - across * across), arm_down = std::sqrt(1.0 - outward * outward);
    std::vector<Vec3> folded;
    folded.reserve(node.size());
    for (const Vec3& x : node) {
        const double in_square = std::min(half, std::max(std::abs(x.x()), std::abs(x.y())));
        const auto place = [&](double a) {
            return std::copysign(
                across * std::min(half, std::abs(a)) + outward * std::max(0.0, std::abs(a) - half), a);
        };
        const double on_arm = std::max({0.0, std::abs(x.x()) - half, std::abs(x.y()) - half});
        folded.emplace_back(place(x.x()), place(x.y()), down * in_square + arm_down * on_arm);
    }
    return folded;
}

}  // namespace twinchute::fullsim
