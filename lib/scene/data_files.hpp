// Where designs, materials and scenes lie: beside the scene, in $TWINCHUTE_DATA, beside the program, in
// the source, installed.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace twinchute {

/// Directories in the order in which they are searched; each may hold parachutes/, materials/, ... Throws
/// SceneError when $TWINCHUTE_DATA names none.
std::vector<std::filesystem::path> data_directories(const std::filesystem::path& scene_directory);

/// FOLDER/NAME.toml in the first directory that has it. `name` must be a plain name, see is_data_name.
std::optional<std::filesystem::path> find_data_file(std::string_view folder, std::string_view name,
                                                    const std::filesystem::path& scene_directory);

/// NAME, with its extension, in the first of these directories that has it.
std::optional<std::filesystem::path> find_table_file(std::string_view name,
                                                     const std::filesystem::path& scene_directory);

/// Every name that find_data_file would find in a folder and the folders in it, sorted, each once; of
/// parachutes the designs, without the types of canopies, which are a folder and a kind of file of their own.
std::vector<std::string> data_names(std::string_view folder,
                                    const std::filesystem::path& scene_directory = {});

/// Letters, digits, '-', '_' and '.', and '/' between such names; none starts with a '.': it cannot leave its
/// folder.
bool is_data_name(std::string_view name);

/// A name that is safe as a file or directory name on any system, for a scene's name or any other
/// text: letters, digits, '-', '_' and '.' are kept, runs of anything else become one '-', at most
/// 80 bytes; "scene" when nothing is left.
std::string file_stem_of(std::string_view name);

/// [bytes] that a scene, design, material or table may have.
inline constexpr std::size_t largest_scene_file = 4u << 20;

/// Standard input: how messages name it.
inline constexpr std::string_view stdin_name = "<stdin>";

/// All of standard input, which is read once and kept: a command may read its scene several times. Throws
/// SceneError where it cannot be read or is larger than a scene.
const std::string& stdin_text();

/// The whole file, or what comes through a pipe without a name (/dev/stdin, a process substitution).
/// Throws SceneError (place: the file as given) when it cannot be read, is a directory, a named pipe or
/// larger than `largest` [bytes].
std::string read_text_file(const std::filesystem::path& file, std::size_t largest = largest_scene_file);

}  // namespace twinchute
