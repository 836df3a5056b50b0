#include "lib/models/attitude_drag.hpp"

#include <algorithm>
#include <utility>

#include "lib/math/interpolation.hpp"
#include "lib/math/vec.hpp"

namespace twinchute {

AttitudeDrag::AttitudeDrag(std::string file, std::vector<double> angle, std::vector<double> area)
    : file_(std::move(file)), angle_(std::move(angle)), area_(std::move(area)) {}

double AttitudeDrag::drag_area(double angle) const {
    const bool mirrored = angle_.back() < 0.75 * pi && angle > 0.5 * pi;
    return Between(angle_, std::min(mirrored ? pi - angle : angle, angle_.back())).linear(area_);
}

}  // namespace twinchute
