// `twinchute size`.
#pragma once

#include "lib/cli/command.hpp"

namespace twinchute::rom {

/// Exit code 0 where the limits are met and 1 where they cannot be.
Command size_command();

}  // namespace twinchute::rom
