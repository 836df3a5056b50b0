// The ladder that lies where a comparison does, for its page.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "compare/ladder.hpp"
#include "lib/record/run_record.hpp"

namespace twinchute::compare {

/// Nothing in it: there is none.
struct LadderBeside {
    std::optional<Ladder> ladder;
    std::string why_not;  ///< where there is one that is not shown: why
};

/// The ladder.json of `place`, where it is one of the scene that `record` is of: the same file, by its
/// SHA-256, and the same inputs, but for tolerances and the fields that only a comparison asks for. Throws
/// RecordError where it cannot be read, or was edited.
LadderBeside ladder_beside(const std::filesystem::path& place, const RunRecord& record,
                           std::span<const std::string_view> fidelities);

/// A line for the terminal, or nothing.
std::string ladder_line(const LadderBeside& beside, const std::filesystem::path& place);

}  // namespace twinchute::compare
