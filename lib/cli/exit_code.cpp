#include "lib/cli/exit_code.hpp"

namespace twinchute {

std::span<const ExitMeaning> exit_meanings() {
    static constexpr ExitMeaning rows[] = {
        {ExitCode::done, "done, and within tolerance where one was asked for"},
        {ExitCode::verdict,
         "done, but a tolerance is exceeded, a limit cannot be met or a parachute never opened"},
        {ExitCode::usage, "bad input or usage; nothing was written"},
        {ExitCode::numerical, "numerical failure; the record up to there is written"},
        {ExitCode::unwritable, "the results could not be written"},
        {ExitCode::interrupted, "interrupted; what was computed is written"},
    };
    return rows;
}

ExitCode exit_code(StatusCode status) {
    if (is_numerical_failure(status)) return ExitCode::numerical;
    if (status == StatusCode::interrupted) return ExitCode::interrupted;
    if (status == StatusCode::refused) return ExitCode::usage;
    if (failed_to_open(status)) return ExitCode::verdict;
    return ExitCode::done;
}

}  // namespace twinchute
