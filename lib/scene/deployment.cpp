#include "lib/scene/deployment.hpp"

#include <algorithm>
#include <array>

namespace twinchute {
namespace {

constexpr std::array<DeploymentRow, 7> ways_to_deploy{{
    {"static-line", DeployBy::static_line, "a static line from the apex pays out and lets go at snatch"},
    {"free", DeployBy::free, "drag and inertia alone draw it out"},
    {"extraction", DeployBy::extraction, "a prescribed force pulls it out"},
    {"pilot", DeployBy::pilot, "a pilot chute draws it out"},
    {"mortar", DeployBy::mortar, "a gun throws it out"},
    {"line-stretch", DeployBy::line_stretch, "the scene starts with lines and canopy drawn out"},
    {"inflated", DeployBy::inflated, "the scene starts with the canopy open"},
}};

}  // namespace

std::span<const DeploymentRow> deployment_rows() {
    return ways_to_deploy;
}

std::string_view deployment_name(DeployBy by) {
    return std::ranges::find(ways_to_deploy, by, &DeploymentRow::by)->name;
}

double ForceHistory::at(double t) const {
    if (time.empty() || t < time.front() || t > std::min(time.back(), duration)) return 0.0;
    const auto above = std::ranges::upper_bound(time, t);
    if (above == time.end()) return force.back();
    const auto i = static_cast<std::size_t>(above - time.begin());
    const double x = (t - time[i - 1]) / (time[i] - time[i - 1]);
    return force[i - 1] + x * (force[i] - force[i - 1]);
}

}  // namespace twinchute
