#include "lib/models/mach_drag.hpp"

#include <algorithm>
#include <utility>

#include "lib/math/interpolation.hpp"

namespace twinchute {

MachDrag::MachDrag(std::string file, std::vector<double> mach, std::vector<double> factor)
    : file_(std::move(file)), mach_(std::move(mach)), factor_(std::move(factor)) {}

double MachDrag::factor(double mach) const {
    return Between(mach_, std::clamp(mach, mach_.front(), mach_.back())).linear(factor_);
}

}  // namespace twinchute
