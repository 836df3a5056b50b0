// Exit codes of the program. Scripts rely on these numbers.
#pragma once

#include <span>
#include <string_view>

#include "lib/record/run_record.hpp"

namespace twinchute {

enum class ExitCode : int {
    done = 0,
    verdict = 1,     ///< done, but a tolerance is exceeded or a parachute never opened
    usage = 2,       ///< bad input or usage; nothing was written
    numerical = 3,   ///< the record up to there is written
    unwritable = 4,  ///< the results could not be written
    interrupted = 130,
};

struct ExitMeaning {
    ExitCode code;
    std::string_view meaning;  ///< for manuals
};

/// Every exit code.
std::span<const ExitMeaning> exit_meanings();

/// The exit code of a run that ended so.
ExitCode exit_code(StatusCode status);

}  // namespace twinchute
