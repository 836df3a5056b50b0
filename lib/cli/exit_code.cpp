#include "lib/cli/exit_code.hpp"

namespace twinchute {

ExitCode exit_code(StatusCode status) {
    if (is_numerical_failure(status)) return ExitCode::numerical;
    if (status == StatusCode::interrupted) return ExitCode::interrupted;
    if (status == StatusCode::refused) return ExitCode::usage;
    if (failed_to_open(status)) return ExitCode::verdict;
    return ExitCode::done;
}

}  // namespace twinchute
