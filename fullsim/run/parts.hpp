// Parts of a full run, and those that a scene leaves out: one list for records and plans.
#pragma once

#include <vector>

#include "lib/scene/scene.hpp"
#include "lib/solve/plan.hpp"

namespace twinchute::fullsim {

/// Dimensions, physics, every row of the table of force blocks, events that are watched for, outputs.
std::vector<PlanPart> parts_of(const Scene& scene);

}  // namespace twinchute::fullsim
