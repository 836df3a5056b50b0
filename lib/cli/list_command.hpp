// `twinchute list`: what there is, from the same tables that run.
#pragma once

#include "lib/cli/command.hpp"

namespace twinchute {

Command list_command();

}  // namespace twinchute
