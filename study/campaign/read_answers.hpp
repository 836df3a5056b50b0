// The questions of a campaign file.
#pragma once

#include "compare/validate/suite_table.hpp"
#include "study/campaign/spec.hpp"

namespace twinchute::study {

/// [[answer]]; throws SceneError.
void read_answers(compare::SuiteTable& top, CampaignSpec& spec);

}  // namespace twinchute::study
