// The one exception for results that could not be written.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace twinchute {

/// what() reads "cannot write 'path' (reason), suggestion".
class WriteError : public std::runtime_error {
public:
    WriteError(const std::filesystem::path& path, const std::string& reason);
    WriteError(const std::filesystem::path& path, int error_number);

    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

}  // namespace twinchute
