// Plan of a reduced-order run: its parts, those that a scene leaves out, and its cost.
#pragma once

#include <vector>

#include "lib/scene/scene.hpp"
#include "lib/solve/plan.hpp"

namespace twinchute::rom {

/// 1: straight down in still air; 2: in the plane of the release; 3: in wind.
int dimensions_of(const Scene& scene);

/// Dimensions, physics, events and outputs: one list for records and plans.
std::vector<PlanPart> parts_of(const Scene& scene);

/// From some whole runs: one takes no longer than steps that are tried of a costlier model.
Plan plan_rom(const Scene& scene, const PlanBasis& basis);

}  // namespace twinchute::rom
