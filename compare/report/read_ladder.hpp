// A ladder from the file that `twinchute ladder` left.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "compare/ladder.hpp"

namespace twinchute::compare {

/// Reads a ladder.json, but for the metrics of each level and the test it was held against: enough for
/// the plot, the tables of levels and references, and the advice. `fidelities`: those that are known; the
/// ladder refers to their names. `file` stands for it in messages. Throws RecordError: no JSON, a value of
/// the wrong kind, a fidelity, a judged metric or a family of levels that this version does not know, a file
/// that was edited.
Ladder read_ladder(std::string_view text, const std::string& file,
                   std::span<const std::string_view> fidelities);

}  // namespace twinchute::compare
