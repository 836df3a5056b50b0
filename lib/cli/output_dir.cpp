#include "lib/cli/output_dir.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

#include "lib/cli/verb.hpp"
#include "lib/record/write_error.hpp"
#include "lib/scene/data_files.hpp"

namespace twinchute {
namespace {

namespace fs = std::filesystem;

bool is_our_file(const fs::path& file) {
    std::ifstream stream(file);
    if (!stream) return false;
    const auto json = nlohmann::json::parse(stream, nullptr, false);
    if (!json.is_object()) return false;
    const auto generator = json.find("generator");
    return generator != json.end() && generator->is_string() && *generator == "twinchute";
}

bool holds_our_file(const fs::path& directory) {
    constexpr std::array names{"summary.json", "gap.json",       "records.json",
                               "ladder.json",  "stability.json", "validate.json"};
    return std::ranges::any_of(names, [&](const char* name) { return is_our_file(directory / name); });
}

/// The directory itself, or the nearest one above it that is there.
fs::path nearest_existing(fs::path path) {
    std::error_code ignored;
    while (!fs::exists(fs::symlink_status(path, ignored))) {
        fs::path parent = path.parent_path();
        if (parent.empty()) return ".";
        if (parent == path) break;
        path = std::move(parent);
    }
    return path;
}

}  // namespace

fs::path default_output_dir(const fs::path& scene_file) {
    return fs::path(".") / (file_stem_of(scene_file.stem().string()) + ".out");
}

bool is_our_output(const fs::path& directory) {
    if (holds_our_file(directory)) return true;
    std::error_code error;
    for (fs::directory_iterator entry(directory, error), end; !error && entry != end;
         entry.increment(error)) {
        std::error_code ignored;
        if (entry->is_directory(ignored) && holds_our_file(entry->path())) return true;
    }
    return false;
}

void check_output_dir(const fs::path& directory) {
    const fs::path existing = nearest_existing(directory);
    std::error_code error;
    if (!fs::is_directory(existing, error)) throw WriteError(existing, ENOTDIR);
    if (::access(existing.c_str(), W_OK | X_OK) != 0) throw WriteError(existing, errno);
    struct stat state {};
    // A current directory that was removed is still there and open to all, only nothing can be made in it.
    if (::stat(existing.c_str(), &state) == 0 && state.st_nlink == 0) throw WriteError(existing, ENOENT);
    if (existing != directory) return;

    const bool empty = fs::is_empty(directory, error);
    if (error) throw WriteError(directory, error.value());
    if (!empty && !is_our_output(directory)) {
        throw UsageError(
            fmt::format("'{}' is not empty and holds no results of twinchute (nothing there is "
                        "overwritten), name another directory with --out",
                        directory.string()));
    }
}

}  // namespace twinchute
