#include "lib/cli/loaded_library.hpp"

#include <dlfcn.h>

#include <filesystem>
#include <system_error>

namespace twinchute {
namespace {

namespace fs = std::filesystem;

constexpr int levels = 6;  // a Python module lies so deep below the prefix

/// A run path would do as well, but then the system's loader looks there for every library at every start.
fs::path place_of(const std::string& file, const std::string& folder) {
    std::error_code ignored;
    Dl_info part{};
    const bool known = dladdr(reinterpret_cast<void*>(&load_function), &part) != 0;
    for (fs::path start : {known ? fs::canonical(part.dli_fname, ignored) : fs::path(),
                           fs::canonical("/proc/self/exe", ignored)})
        for (int level = 0; level < levels && start.has_relative_path(); ++level) {
            start = start.parent_path();
            for (const std::string& below : {folder, std::string(TWINCHUTE_LIBDIR)})
                if (fs::path found = start / below / file; fs::exists(found, ignored)) return found;
        }
    return file;
}

}  // namespace

LoadedFunction load_function(const std::string& file, const std::string& folder, const std::string& symbol) {
    void* const library = dlopen(place_of(file, folder).c_str(), RTLD_NOW | RTLD_LOCAL);
    void* const function = library ? dlsym(library, symbol.c_str()) : nullptr;
    if (function) return {function, ""};
    const char* const why = dlerror();
    return {nullptr, why ? why : "it is not there"};
}

}  // namespace twinchute
