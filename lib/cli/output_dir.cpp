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

#include "lib/cli/command.hpp"
#include "lib/record/checkpoint.hpp"
#include "lib/record/file_batch.hpp"
#include "lib/record/write_error.hpp"
#include "lib/scene/data_files.hpp"

namespace twinchute {
namespace {

namespace fs = std::filesystem;

bool is_our_file(const fs::path& file) {
    std::error_code ignored;
    if (!fs::is_regular_file(file, ignored)) return false;  // a pipe would be waited for
    std::ifstream stream(file);
    const auto json = nlohmann::json::parse(stream, nullptr, false);
    if (!json.is_object()) return false;
    const auto generator = json.find("generator");
    return generator != json.end() && generator->is_string() && *generator == "twinchute";
}

bool holds_our_file(const fs::path& directory) {
    constexpr std::array names{"summary.json",     "gap.json",      "records.json",
                               "calibration.json", "ladder.json",   "stability.json",
                               "validate.json",    "campaign.json", "store.json"};
    return is_checkpoint(checkpoint_file(directory)) ||
           std::ranges::any_of(names, [&](const char* name) { return is_our_file(directory / name); });
}

/// Results lie at most so far below the directory of a series: case, fidelity.
constexpr int deepest = 2;

/// Names that the files of results have, beside a marker.
bool is_content(const std::string& name) {
    constexpr std::array names{"history.csv", "events.csv", "frames.bin",     "fields.pvd",
                               "force.svg",   "speed.svg",  "report.md",      "report.html",
                               "run.html",    "junit.xml",  "calibrated.toml"};
    return std::ranges::count(names, name) > 0 || (name.starts_with("frame-") && name.ends_with(".vtu"));
}

/// Files about all cases of a series: series.csv, of one fidelity series-rom.csv.
bool is_about_cases(const fs::path& file) {
    constexpr std::array types{".md", ".csv", ".svg", ".html"};
    const std::string stem = file.stem().string();
    return (stem == "series" || stem.starts_with("series-")) &&
           std::ranges::count(types, file.extension()) > 0;
}

/// Nothing but directories and what killed runs of this program left unfinished in them. One that was killed
/// while it gave its files their names has left some of these, and the marker that comes last without one.
bool is_abandoned_only(const fs::path& directory) {
    bool has_contents = false, has_marker = false;
    std::error_code error;
    fs::recursive_directory_iterator entry(directory, error), end;
    for (; !error && entry != end; entry.increment(error)) {
        std::error_code ignored;
        const std::string name = entry->path().filename().string();
        if (entry->is_directory(ignored)) {
            if (entry.depth() > deepest) return false;
        } else if (is_abandoned(entry->path())) {
            has_marker = has_marker || name.starts_with(".summary.json.");
        } else if (is_content(name)) {
            has_contents = true;
        } else {
            return false;
        }
    }
    return !error && (has_marker || !has_contents);
}

/// Results that are a directory's own, or those of the fidelities and cases below it and nothing else: of a
/// folder with work of somebody's in it, results below make no output directory.
bool is_ours(const fs::path& directory, int depth) {
    if (holds_our_file(directory)) return true;
    bool results = false, contents = false, leftovers = false;
    std::error_code error, ignored;
    if (depth == 0) return false;
    for (fs::directory_iterator entry(directory, error), end; !error && entry != end;
         entry.increment(error)) {
        const fs::path& path = entry->path();
        if (entry->is_directory(ignored) && !entry->is_symlink(ignored)) {
            if (is_ours(path, depth - 1))
                results = true;
            else if (!is_abandoned_only(path))
                return false;
        } else if (is_abandoned(path)) {
            leftovers = true;
        } else if (is_content(path.filename().string())) {
            contents = true;  // of a run that was killed before its marker, which it left under another name
        } else if (!is_about_cases(path)) {
            return false;
        }
    }
    return results && !error && (leftovers || !contents);
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
    return is_ours(directory, deepest);
}

void check_output_dir(const fs::path& given) {
    // The resolved path counts, not its spelling: "" is the current directory, and so is "new/..".
    std::error_code error;
    fs::path directory = given;
    if (given.empty() || std::ranges::find(given, "..") != given.end())
        directory = fs::weakly_canonical(given.empty() ? "." : given, error);
    if (error) throw WriteError(given, error.value());
    const fs::path existing = nearest_existing(directory);
    if (!fs::is_directory(existing, error)) throw WriteError(existing, ENOTDIR);
    if (::access(existing.c_str(), W_OK | X_OK) != 0) throw WriteError(existing, errno);
    struct stat state {};
    // A current directory that was removed is still there and open to all, only nothing can be made in it.
    if (::stat(existing.c_str(), &state) == 0 && state.st_nlink == 0) throw WriteError(existing, ENOENT);
    if (existing != directory) return;

    const bool empty = fs::is_empty(directory, error);
    if (error) throw WriteError(directory, error.value());
    if (!empty && !is_our_output(directory) && !is_abandoned_only(directory)) {
        throw UsageError(
            fmt::format("'{}' is not empty and holds more than results of twinchute, or none (nothing there "
                        "is overwritten), name another directory with --out",
                        given.string()));
    }
}

void check_output_file(const fs::path& file, std::initializer_list<const char*> notes,
                       std::string_view what) {
    std::error_code ignored;
    if (!fs::exists(file, ignored)) return;
    std::string head(512, '\0');
    if (fs::is_regular_file(file, ignored)) {  // a pipe would be waited for
        std::ifstream stream(file, std::ios::binary);
        stream.read(head.data(), static_cast<std::streamsize>(head.size()));
        if (head.starts_with("%PDF-")) {  // which lists its pages before it says who made it
            stream.seekg(0);
            head.resize(std::size_t{1} << 20);
            stream.read(head.data(), static_cast<std::streamsize>(head.size()));
        }
        for (const char* note : notes)
            if (fs::is_empty(file, ignored) || head.find(note) != std::string::npos) return;
    }
    throw UsageError(
        fmt::format("'{}' is no {} of twinchute (nothing else is overwritten), name another file with --out",
                    file.string(), what));
}

}  // namespace twinchute
