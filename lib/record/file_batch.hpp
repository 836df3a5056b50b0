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

    /// Writes `text` to a temporary name beside `target`, making directories as needed, and returns that
    /// name. Throws WriteError.
    std::filesystem::path add(const std::filesystem::path& target, std::string_view text,
                              Kind kind = Kind::content);

    /// A file that another process has written to a temporary name beside `target` is of this batch from here
    /// on.
    void adopt(const std::filesystem::path& target, const std::filesystem::path& temporary);
    /// A file added or adopted earlier is not to get its name after all. Its temporary file stays as long as
    /// others do: a checkpoint may name it.
    void drop(const std::filesystem::path& target);
    /// Lets the files added so far keep their temporary names when the batch is destroyed without commit(): a
    /// checkpoint names them.
    void spare() { spared_ = pending_.size(); }

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
        bool dropped = false;
    };
    struct Removal {
        std::filesystem::path target, aside;
    };
    void make_directories(const std::filesystem::path& directory);

    std::vector<Pending> pending_;
    std::size_t spared_ = 0;  ///< of these, from the first on
    std::vector<Removal> removals_;
    std::vector<std::filesystem::path> made_;  ///< directories, outermost first
};

/// One file under its name, whole or as it was before. Throws WriteError.
void replace_file(const std::filesystem::path& target, std::string_view text);

/// Whether a file's name is one that these give to what is not complete, and its process is gone: it was
/// killed.
bool is_abandoned(const std::filesystem::path& file);

}  // namespace twinchute
