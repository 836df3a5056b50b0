// Estimates of an opening by handbook formulas.
#pragma once

#include "lib/record/run_record.hpp"
#include "lib/scene/scene.hpp"
#include "lib/solve/opening.hpp"

namespace twinchute::rom {

/// Adds the peak opening force [N] by each formula that the scene has the inputs of, all at the snatch that
/// the run came to: the payload's share m_l/(m_l + m_p) of the formula's drag, which is what its risers pull.
/// Nothing where nothing was snatched.
void add_estimates(RunRecord& record, const Scene& scene, const OpeningResult& result);

}  // namespace twinchute::rom
