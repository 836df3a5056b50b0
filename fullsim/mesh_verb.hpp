// `twinchute mesh`: the mesh that a full run of a scene starts from, to look at and to weigh.
#pragma once

#include "lib/cli/verb.hpp"

namespace twinchute::fullsim {

Verb mesh_verb();

}  // namespace twinchute::fullsim
