// What a scene may leave out of a parachute, and who needs it.
#pragma once

#include <string>
#include <vector>

#include "lib/scene/scene.hpp"

namespace twinchute {

/// Keys of the lines that a packed start draws out, which the scene does not give.
std::vector<std::string> missing_lines(const Parachute& chute);

/// Keys that a model of the structure needs, those of the lines among them, which the scene does not give.
std::vector<std::string> missing_structure(const Parachute& chute);

}  // namespace twinchute
