// Forecast of the needs and cost of a full run, from its own tables and a short sample of its own steps.
#pragma once

#include "lib/scene/scene.hpp"
#include "lib/solve/plan.hpp"

namespace twinchute::fullsim {

/// Tries steps for basis.probe seconds, shared by the stages of the run. Throws SceneError as a run does.
Plan plan_full(const Scene& scene, const PlanBasis& basis);

}  // namespace twinchute::fullsim
