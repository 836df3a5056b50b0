// The records of comparisons as they lie in directories.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "compare/gap.hpp"
#include "lib/record/run_record.hpp"
#include "lib/solve/fidelity.hpp"

namespace twinchute::compare {

/// The summary of that fidelity's record in the directory of a comparison, as messages call it.
std::string summary_of(const std::filesystem::path& place, const Fidelity& fidelity);

/// Reads it. Throws RecordError, also where it is a record of another fidelity.
RunRecord record_of(const std::filesystem::path& place, const Fidelity& fidelity);

/// Attribution in an earlier gap.json; runs that it took are not made again. Throws RecordError.
std::optional<Attribution> attribution_in(const std::filesystem::path& place, const Comparison& comparison);

}  // namespace twinchute::compare
