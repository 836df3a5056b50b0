// A directory for files that nobody needs for long.
#pragma once

#include <filesystem>

namespace twinchute {

/// A new directory among the system's temporary files, which only this user may read; it is removed with all
/// that is in it.
class ShortLivedDirectory {
public:
    /// Throws WriteError.
    ShortLivedDirectory();
    ~ShortLivedDirectory();
    ShortLivedDirectory(const ShortLivedDirectory&) = delete;
    ShortLivedDirectory& operator=(const ShortLivedDirectory&) = delete;
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

}  // namespace twinchute
