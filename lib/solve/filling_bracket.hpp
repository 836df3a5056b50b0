// A predicted filling with its bracket: how far it hangs on the one input that is calibrated.
#pragma once

#include <functional>

#include "lib/record/run_record.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute {

/// Adds the filling of a record, and the same drop from the lowest and the highest initial mouth; every
/// predicted filling time says what they make of it. `density` [kg/m^3]: at snatch. `run_again`: runs a scene
/// that differs in its mouth, past its peak force at least; its record has the metrics of a filling that it
/// came to. Does nothing where no filling is predicted, and runs nothing where the record stopped before one.
void add_filling_bracket(RunRecord& record, const Scene& scene, double density,
                         const std::function<RunRecord(const Scene&)>& run_again);

}  // namespace twinchute
