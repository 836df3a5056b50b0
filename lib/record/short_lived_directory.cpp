#include "lib/record/short_lived_directory.hpp"

#include <cerrno>
#include <cstdlib>
#include <string>
#include <system_error>

#include "lib/record/write_error.hpp"

namespace twinchute {

ShortLivedDirectory::ShortLivedDirectory() {
    std::string name = (std::filesystem::temp_directory_path() / "twinchute-XXXXXX").string();
    if (!mkdtemp(name.data())) throw WriteError(name, errno);
    path_ = name;
}

ShortLivedDirectory::~ShortLivedDirectory() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

}  // namespace twinchute
