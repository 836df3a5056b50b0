// The inputs of a campaign file: which keys, how they are distributed, how they go together.
#pragma once

#include <filesystem>

#include "compare/validate/suite_table.hpp"
#include "study/campaign/spec.hpp"

namespace twinchute::study {

/// Where the files lie that a campaign names.
struct NamedFiles {
    std::filesystem::path directory;
    Bases bases;

    /// Throws SceneError for one that may not be named.
    std::filesystem::path at(const std::string& name, const SourcePlace& place, std::string_view key) const;
};

/// [[vary]] and [[correlation]]; throws SceneError.
void read_inputs(compare::SuiteTable& top, const NamedFiles& files, CampaignSpec& spec);

/// Checks and completes the inputs for the design: points of a table, or a distribution of each. Throws
/// SceneError.
void finish_inputs(const NamedFiles& files, CampaignSpec& spec);

}  // namespace twinchute::study
