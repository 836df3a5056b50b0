// An attribution of the gap as JSON, written and read: a report is made again without running anything.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "compare/gap.hpp"

namespace twinchute::compare {

/// The key "attribution" of gap.json.
nlohmann::ordered_json attribution_json(const Attribution& attribution);

/// Reads what a gap.json says of the two records of `comparison`; nothing where it has no attribution.
/// Metrics that this version does not know are left out. `file` stands for it in messages. Throws
/// RecordError: no JSON, a value of the wrong kind, values that are not those of the records, a sum that does
/// not add up, a file that was edited.
std::optional<Attribution> read_attribution(std::string_view gap, const std::string& file,
                                            const Comparison& comparison);

}  // namespace twinchute::compare
