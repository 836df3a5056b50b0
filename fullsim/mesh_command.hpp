// `twinchute mesh`: the mesh that a full run of a scene starts from, to look at and to weigh.
#pragma once

#include "lib/cli/command.hpp"

namespace twinchute::fullsim {

Command mesh_command();

}  // namespace twinchute::fullsim
