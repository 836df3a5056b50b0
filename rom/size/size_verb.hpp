// `twinchute size`.
#pragma once

#include "lib/cli/verb.hpp"

namespace twinchute::rom {

/// Exit code 0 where the limits are met and 1 where they cannot be.
Verb size_verb();

}  // namespace twinchute::rom
