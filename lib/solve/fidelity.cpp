#include "lib/solve/fidelity.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "lib/scene/needs.hpp"

namespace twinchute {

std::string unsupported_text(const Scene& scene, const std::vector<std::string>& keys) {
    std::vector<std::string> physics, absent;
    for (const std::string& key : keys) {
        const bool given = std::ranges::any_of(scene.inputs, [&](const Input& input) {
            return input.key == key || input.key.starts_with(key + ".");
        });
        std::string named = fmt::format("'{}'", key);
        if (const std::string why = lacks_canopy(scene.parachutes.front());
            key == "parachute.type" && !why.empty())
            named += fmt::format(" ({})", why);
        (given ? physics : absent).push_back(std::move(named));
    }
    std::string text;
    if (!physics.empty()) text = fmt::format("it lacks the physics of {}", fmt::join(physics, ", "));
    if (!absent.empty())
        text += fmt::format("{} needs {}", text.empty() ? "it" : " and", fmt::join(absent, ", "));
    return text;
}

}  // namespace twinchute
