#include "lib/solve/fidelity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lib/scene/needs.hpp"

namespace twinchute {

std::string unsupported_text(const Scene& scene, const std::vector<std::string>& keys) {
    const Parachute& chute = scene.parachutes.front();
    const std::vector<std::string> missing = missing_structure(chute);
    std::vector<std::string> physics, absent;
    for (const std::string& key : keys) {
        const bool needed = std::ranges::count(missing, key) > 0;
        const bool given = !needed && std::ranges::any_of(scene.inputs, [&](const Input& input) {
            return input.key == key || input.key.starts_with(key + ".");
        });
        std::string named = fmt::format("'{}'", key);
        if (const std::string why = lacks_canopy(chute); key == "parachute.type" && !why.empty())
            named += fmt::format(" ({})", why);
        if (key == "parachute.filling" && (has_open_middle(chute) || holds_vent_down(chute)))
            named += " (predicted: its balance of air knows no open middle and no vent that is held down)";
        for (const CrossRefusal& refusal : cross_refusals(scene))
            if (refusal.key == key) named += fmt::format(" ({})", refusal.why);
        if (key == "payload.body.elasticity" || key == "payload.body.shape")
            named += " (parachutes in turn, and canopies of a cluster, share a rigid box or cylinder)";
        if (!needed && key.ends_with(".risers"))
            named += " (canopies of a cluster meet at one point of payload.body: write 1)";
        if (scene.payload.body && key.ends_with(".deploy.by"))
            named += " (over a payload.body that has turned a canopy starts open on one riser alone)";
        if (needed && key == "parachute.geometric_porosity")
            named += fmt::format(" (of vent and slots of a {} canopy; the vent alone has {:.3g} %)",
                                 chute.type->title,
                                 100.0 * std::pow(chute.vent_diameter / chute.nominal_diameter, 2));
        (given ? physics : absent).push_back(std::move(named));
    }
    std::string text;
    if (!physics.empty()) text = fmt::format("it lacks the physics of {}", fmt::join(physics, ", "));
    if (!absent.empty())
        text += fmt::format("{} needs {}", text.empty() ? "it" : " and", fmt::join(absent, ", "));
    return text;
}

}  // namespace twinchute
