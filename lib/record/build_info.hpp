// Version, commit and compiler that this library was built with. The definition is written by the build
// (cmake/build_info.cmake).
#pragma once

#include <string_view>

namespace twinchute {

struct BuildInfo {
    std::string_view version;   ///< of the project, e.g. "0.1.0"
    std::string_view commit;    ///< abbreviated, "-dirty" when the tree had changes; "unknown" without git
    std::string_view compiler;  ///< e.g. "GNU 12.2.0"
    std::string_view flags;     ///< that shape the code; warnings left out
};

BuildInfo build_info();

}  // namespace twinchute
