// `twinchute list`: what there is, from the same tables that run.
#pragma once

#include <string>

#include "lib/cli/command.hpp"

namespace twinchute {

Command list_command();

/// Every key of a scene as `twinchute list keys --json` prints it.
std::string keys_json();

}  // namespace twinchute
