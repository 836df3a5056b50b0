// Readers of other programs' files, into a scene to be written.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "lib/exchange/imported_scene.hpp"

namespace twinchute::exchange {

/// Part of a file that a scene is made of.
struct ImportChoice {
    std::vector<std::string>
        devices;             ///< recovery devices by their names in the file; none: all that fall together
    std::string simulation;  ///< by its name in the file; empty: the first that has results
};

/// From the XML of an OpenRocket design (file format 1.0 to 1.10, unpacked). `file` stands for it in
/// messages. Throws SceneError.
ImportedScene read_open_rocket(std::string_view xml, const std::string& file, const ImportChoice& choice);

/// From JSON of RocketPy: a saved flight or rocket (.rpy), a parachute's parameters, or a list of these.
/// Throws SceneError.
ImportedScene read_rocketpy(std::string_view json, const std::string& file, const ImportChoice& choice);

}  // namespace twinchute::exchange
