// Permissions that hold for root as well.
#pragma once

#include <linux/capability.h>
#include <sys/prctl.h>
#include <unistd.h>

namespace twinchute::test {

/// Root writes wherever it likes, unless the program starts without that power: a last step before it does,
/// see Process. Whether permissions hold.
inline bool without_override() {
    return ::geteuid() != 0 || ::prctl(PR_CAPBSET_DROP, CAP_DAC_OVERRIDE, 0, 0, 0) == 0;
}

}  // namespace twinchute::test
