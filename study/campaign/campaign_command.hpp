// `twinchute campaign`.
#pragma once

#include "lib/cli/command.hpp"
#include "lib/solve/fidelity.hpp"

namespace twinchute::study {

/// Exit code 0 where all limits are met, 1 where one is not, or not known to be. Without HDF5 or Random123 in
/// the build every call is refused.
Command campaign_command(const Fidelity& rom, const Fidelity& full);

}  // namespace twinchute::study
