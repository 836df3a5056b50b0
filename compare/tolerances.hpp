// The tolerances of a comparison: asked for on the command line, or told by a record.
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "lib/cli/command.hpp"
#include "lib/record/run_record.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::compare {

/// --tolerance METRIC=VALUE.
Option tolerance_option(std::string_view reference);

/// --tolerance peak_force=10% is the scene's compare.tolerance.peak_force = "10%": one reader
/// for both. `option`: where the same is said of something else. Throws UsageError.
std::vector<std::string> tolerance_overrides(const Arguments& arguments,
                                             std::string_view option = "tolerance");

/// Tolerances asked for when a record was made, by metric: its inputs hold it. Metrics that this version does
/// not know are left out. `file` stands for the record in messages. Throws RecordError.
std::map<std::string, Tolerance> recorded_tolerances(const RunRecord& record, const std::string& file);

/// The metrics among them that the command line asked for, not the scene.
std::set<std::string, std::less<>> command_line_tolerances(const RunRecord& record);

}  // namespace twinchute::compare
