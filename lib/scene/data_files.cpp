#include "lib/scene/data_files.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/magic.h>
#include <poll.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <set>
#include <system_error>

#include "lib/scene/scene_error.hpp"

namespace twinchute {
namespace {

namespace fs = std::filesystem;

bool is_name_character(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '_' || c == '.';
}

fs::path file_name(std::string_view name) {
    return std::string(name) + ".toml";
}

}  // namespace

std::vector<fs::path> data_directories(const fs::path& scene_directory) {
    std::vector<fs::path> places{scene_directory.empty() ? fs::path(".") : scene_directory};
    std::error_code error;
    if (const char* data = std::getenv("TWINCHUTE_DATA"); data && *data) {
        if (!fs::is_directory(data, error))
            throw SceneError({data, 0, 0}, "", "TWINCHUTE_DATA names no directory",
                             error ? error.message() : "it is a file",
                             "set it to a folder with parachutes/, materials/ or scenes/ in it, or unset it");
        places.emplace_back(data);
    }
    // Beside the program, so that an installed tree may be moved; a build tree has no such folder and
    // takes its own sources, before any copy that was installed earlier.
    const fs::path program = fs::read_symlink("/proc/self/exe", error);
    if (!error) places.push_back(program.parent_path().parent_path() / "share" / "twinchute");
#ifdef TWINCHUTE_SOURCE_DATA
    places.emplace_back(TWINCHUTE_SOURCE_DATA);
#endif
#ifdef TWINCHUTE_INSTALL_DATA
    places.emplace_back(TWINCHUTE_INSTALL_DATA);
#endif
    return places;
}

/// In the first data directory that has it.
static std::optional<fs::path> first_file(const fs::path& name, const fs::path& scene_directory) {
    for (const fs::path& place : data_directories(scene_directory)) {
        fs::path file = place / name;
        std::error_code error;
        if (fs::is_regular_file(file, error)) return file;
    }
    return std::nullopt;
}

bool is_data_name(std::string_view name) {
    for (;;) {
        const std::size_t slash = std::min(name.find('/'), name.size());
        const std::string_view part = name.substr(0, slash);
        if (part.empty() || part.front() == '.' || !std::ranges::all_of(part, is_name_character))
            return false;
        if (slash == name.size()) return true;
        name.remove_prefix(slash + 1);
    }
}

std::optional<fs::path> find_data_file(std::string_view folder, std::string_view name,
                                       const fs::path& scene_directory) {
    if (!is_data_name(name)) return std::nullopt;
    return first_file(fs::path(folder) / file_name(name), scene_directory);
}

std::optional<fs::path> find_table_file(std::string_view name, const fs::path& scene_directory) {
    if (!is_data_name(name)) return std::nullopt;
    return first_file(name, scene_directory);
}

std::vector<std::string> data_names(std::string_view folder, const fs::path& scene_directory) {
    std::set<std::string> names;
    for (const fs::path& place : data_directories(scene_directory)) {
        std::error_code error;
        const fs::path root = place / folder;
        fs::recursive_directory_iterator entry(root, error);
        while (!error && entry != fs::recursive_directory_iterator()) {
            const fs::path inside = entry->path().lexically_relative(root);
            const std::string name = (inside.parent_path() / inside.stem()).generic_string();
            const bool type = folder == "parachutes" && name.starts_with("types/");
            if (inside.extension() == ".toml" && is_data_name(name) && !type) names.insert(name);
            entry.increment(error);
        }
    }
    return {names.begin(), names.end()};
}

std::string file_stem_of(std::string_view name) {
    std::string stem;
    for (const char c : name) {
        if (is_name_character(c)) {
            if (!stem.empty() || (c != '.' && c != '-')) stem += c;
        } else if (!stem.empty() && stem.back() != '-') {
            stem += '-';
        }
    }
    stem.resize(std::min<std::size_t>(stem.size(), 80));
    while (!stem.empty() && (stem.back() == '-' || stem.back() == '.'))
        stem.pop_back();
    return stem.empty() ? "scene" : stem;
}

/// All that comes from a file or pipe. Throws SceneError (place: `name`) where it cannot be read or is larger
/// than `largest` [bytes].
static std::string read_all(int handle, const std::string& name, std::size_t largest) {
    std::string text, chunk(1 << 16, '\0');
    ssize_t count = 0;
    do {  // bounded: a device has no size and no end
        count = ::read(handle, chunk.data(), chunk.size());
        if (count > 0) text.append(chunk, 0, static_cast<std::size_t>(count));
        pollfd more{handle, POLLIN, 0};
        if (count < 0 && errno == EAGAIN) ::poll(&more, 1, -1);
    } while (text.size() <= largest && (count > 0 || (count < 0 && (errno == EAGAIN || errno == EINTR))));
    if (count < 0)
        throw SceneError(
            {name, 0, 0}, "", "cannot be read", std::strerror(errno),
            name == stdin_name ? "pipe a scene into it, or name a file" : "check its permissions");
    if (text.size() > largest)
        throw SceneError({name, 0, 0}, "", "is too large", fmt::format("more than {} MiB", largest >> 20),
                         largest == largest_scene_file ? "is it a scene?" : "is it the right file?");
    return text;
}

const std::string& stdin_text() {
    static const std::string text = read_all(STDIN_FILENO, std::string(stdin_name), largest_scene_file);
    return text;
}

std::string read_text_file(const fs::path& file, std::size_t largest) {
    const auto refuse = [&](const std::string& problem, const std::string& why, const std::string& hint) {
        return SceneError({file.string(), 0, 0}, "", problem, why, hint);
    };
    std::error_code error;
    const fs::file_status status = fs::status(file, error);
    if (!fs::exists(status))
        throw refuse("no such file", "",
                     file == "-" ? "here standard input is /dev/stdin" : "check the path");
    if (fs::is_directory(status)) throw refuse("is a directory", "a file is wanted", "name the file in it");
    // Process substitutions are pipes without a name, and read to their end. One with a name may have nobody
    // who writes: whether it can be read would hang on who comes first, or for ever.
    const int handle = ::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (handle < 0) throw refuse("cannot be read", std::strerror(errno), "check its permissions");
    const struct Closed {
        int handle;
        ~Closed() { ::close(handle); }
    } closed{handle};
    struct statfs where {};
    if (fs::is_fifo(status) && ::fstatfs(handle, &where) == 0 && where.f_type != PIPEFS_MAGIC)
        throw refuse("is a named pipe", "a file is wanted", "name a file, or pipe it into /dev/stdin");
    return read_all(handle, file.string(), largest);
}

}  // namespace twinchute
