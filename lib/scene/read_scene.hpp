// From a scene file to a Scene. The only place where units and ranges are checked.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "lib/scene/scene.hpp"

namespace twinchute {

/// Reads a scene file, with the design and material files it names.
///
/// Data files are looked for beside the scene, then in $TWINCHUTE_DATA, then in the installed
/// share/twinchute (or the source tree's data/ when run from a build directory).
/// `overrides`: "key=value" with value in TOML, e.g. "payload.mass='150 kg'", applied before validation; an
/// option before it, as in "--fields full.fields_rate=50", is named by messages in place of --set.
/// Throws SceneError for everything that is wrong with the input, a series of cases included.
Scene read_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides = {});

/// The scenes of a file: one for each [[case]], in their order, or the one scene when there is none. Laid
/// over each other are, from below: a design, the file that `base` names, the file, the case, `overrides`.
/// Messages about a case name it. The cases of a file take the place of those of its base. The file "-" is
/// standard input, as if it lay in the current directory.
std::vector<Scene> read_scenes(const std::filesystem::path& file,
                               const std::vector<std::string>& overrides = {});
/// Where the files lie that a scene may name by a path, as `base` does; what else it names is looked for
/// beside it and in the data alone.
enum class Bases {
    anywhere,
    beneath  ///< the directory of the scene or the data; for text of others. Links are followed first
};
/// Reads a scene, or the cases of a series, from text; `name` stands for the file in messages, `directory` is
/// where it would lie.
Scene read_scene_text(std::string_view text, const std::string& name, const std::filesystem::path& directory,
                      const std::vector<std::string>& overrides = {}, Bases bases = Bases::anywhere);
std::vector<Scene> read_scenes_text(std::string_view text, const std::string& name,
                                    const std::filesystem::path& directory,
                                    const std::vector<std::string>& overrides = {},
                                    Bases bases = Bases::anywhere);

/// Source of an input that an override gives, before the source that the override itself names.
inline constexpr std::string_view command_line_source = "command line";

/// The tolerances among such overrides, by metric: {"compare.tolerance.peak_force=10 %"}. Any other key is
/// unknown here. Throws SceneError.
std::map<std::string, Tolerance> read_tolerances(const std::vector<std::string>& overrides);

}  // namespace twinchute
