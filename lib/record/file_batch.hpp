// Several files that appear together or not at all.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "lib/record/write_error.hpp"

namespace twinchute {

/// Writes each file to a temporary name in its own directory, flushed to disk, and renames all of
/// them in commit(): a full disk is met before any earlier result is touched. Without commit() the
/// destructor removes the temporary files and the directories that add() made.
class FileBatch {
public:
    /// A marker says that the files beside it are complete, e.g. summary.json.
    enum class Kind { content, marker };

    FileBatch() = default;
    ~FileBatch();
    FileBatch(const FileBatch&) = delete;
    FileBatch& operator=(const FileBatch&) = delete;

    /// Writes `text` to a temporary name beside `target`, making directories as needed.
    /// Throws WriteError.
    void add(const std::filesystem::path& target, std::string_view text, Kind kind = Kind::content);

    /// Makes commit() take a file away that nothing of this batch replaces, and the directory that is empty
    /// after that; there may be no such file.
    void remove(const std::filesystem::path& target);

    /// Gives every file its name: contents first, then markers in the order they were added. Old
    /// markers go before, so that new contents never stand beside an old marker. Throws WriteError; then
    /// every file that stood there before is back under its name.
    void commit();

private:
    struct Pending {
        std::filesystem::path target, temporary;
        Kind kind;
    };
    struct Removal {
        std::filesystem::path target, aside;
    };
    void make_directories(const std::filesystem::path& directory);

    std::vector<Pending> pending_;
    std::vector<Removal> removals_;
    std::vector<std::filesystem::path> made_;  ///< directories, outermost first
};

}  // namespace twinchute
