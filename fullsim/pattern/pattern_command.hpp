// `twinchute pattern`: the gore of a scene's canopy as it is cut, and a list of parts.
#pragma once

#include "lib/cli/command.hpp"

namespace twinchute::fullsim {

Command pattern_command();

}  // namespace twinchute::fullsim
