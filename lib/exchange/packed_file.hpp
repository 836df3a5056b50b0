// Text in a file that may be packed: zip, gzip or as it is.
#pragma once

#include <filesystem>
#include <string>

namespace twinchute::exchange {

/// [bytes] that a packed file, and what it holds, may have.
inline constexpr std::size_t largest_packed = 32u << 20, largest_unpacked = 64u << 20;

/// The file's text: of a zip archive its first member whose name ends in `member` (".ork"), of a gzip file
/// its content, else the file itself. Throws SceneError: unreadable, damaged, without such a member, too
/// large.
std::string read_packed_file(const std::filesystem::path& file, std::string_view member);

}  // namespace twinchute::exchange
