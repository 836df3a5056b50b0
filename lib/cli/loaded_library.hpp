// Libraries of our own that are loaded when they are asked for: what few runs need costs the others nothing.
#pragma once

#include <string>

namespace twinchute {

/// A function of such a library, or why there is none.
struct LoadedFunction {
    void* function = nullptr;
    std::string complaint;
};

/// Looks for `file` beside the program or the Python module that this is part of: in `folder` of a build, in
/// its own folder of an installation; else where the system's loader looks. It is never unloaded.
LoadedFunction load_function(const std::string& file, const std::string& folder, const std::string& symbol);

}  // namespace twinchute
