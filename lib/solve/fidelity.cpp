#include "lib/solve/fidelity.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace twinchute {

std::string lacking_text(const Scene& scene, const std::vector<std::string>& keys) {
    std::vector<std::string> physics, absent;
    for (const std::string& key : keys)
        (std::ranges::count(scene.inputs, key, &Input::key) != 0 ? physics : absent).push_back(key);
    std::string text;
    if (!physics.empty()) text = fmt::format("it lacks the physics of '{}'", fmt::join(physics, "', '"));
    if (!absent.empty())
        text += fmt::format("{} needs '{}'", text.empty() ? "it" : " and", fmt::join(absent, "', '"));
    return text;
}

}  // namespace twinchute
