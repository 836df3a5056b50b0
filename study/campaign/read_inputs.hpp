// The inputs of a campaign file: which keys, how they are distributed, how they go together.
#pragma once

#include <filesystem>

#include "compare/validate/suite_table.hpp"
#include "study/campaign/spec.hpp"

namespace twinchute::study {

/// [[vary]] and [[correlation]]; throws SceneError.
void read_inputs(compare::SuiteTable& top, const std::filesystem::path& directory, CampaignSpec& spec);

/// Checks and completes the inputs for the design: points of a table, or a distribution of each. Throws
/// SceneError.
void finish_inputs(const std::filesystem::path& directory, CampaignSpec& spec);

}  // namespace twinchute::study
