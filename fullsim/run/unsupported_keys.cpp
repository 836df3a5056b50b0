#include "fullsim/run/unsupported_keys.hpp"

#include <algorithm>
#include <string_view>

#include "fullsim/cluster.hpp"
#include "fullsim/mesh/attach_payload.hpp"
#include "fullsim/mesh/start.hpp"
#include "lib/scene/needs.hpp"

namespace twinchute::fullsim {
namespace {

/// Keys of the flight that stages lack, and those of each parachute on its own, with its name where there are
/// several.
std::vector<std::string> unsupported_in_stages(const Scene& scene) {
    std::vector<std::string> keys;
    if (const auto& body = scene.payload.body) {
        if (body->elasticity) keys.emplace_back("payload.body.elasticity");
        if (body->shape == PayloadBody::Shape::mesh) keys.emplace_back("payload.body.shape");
    }
    if (scene.full.symmetry == Symmetry::sector) keys.emplace_back("full.symmetry");
    const PayloadFlight start = released_payload(scene);
    for (std::size_t p = 0; p < scene.parachutes.size(); ++p) {
        std::vector<std::string> own = unsupported_keys(scene_in_flight(scene, p, start));
        const Parachute& chute = scene.parachutes[p];
        // It settles over a body that hangs straight; over one that does not, several risers do not fit.
        if (scene.payload.body && chute.deploy.by == DeployBy::inflated && chute.risers > 1 &&
            (chute.deploy_when || p > 0))
            own.emplace_back("parachute.deploy.by");
        for (std::string& key : own) {
            constexpr std::string_view head = "parachute.";
            if (scene.parachutes.size() > 1 && key.starts_with(head))
                key.insert(head.size(), scene.parachutes[p].name + ".");
            if (std::ranges::find(keys, key) == keys.end()) keys.push_back(std::move(key));
        }
    }
    return keys;
}

}  // namespace

std::vector<std::string> unsupported_keys(const Scene& scene) {
    if (has_stages(scene)) return unsupported_in_stages(scene);
    const Parachute& chute = scene.parachutes.front();
    std::vector<std::string> keys;
    if (chute.count > 1 && scene.payload.body) {
        if (scene.payload.body->elasticity) keys.emplace_back("payload.body.elasticity");
        if (scene.payload.body->shape == PayloadBody::Shape::mesh)
            keys.emplace_back("payload.body.shape");
        else if (chute.risers > 1)
            keys.emplace_back("parachute.risers");  // canopies lean, and meet at one point
    }
    if (chute.count > 1 && scene.full.symmetry == Symmetry::sector) keys.emplace_back("full.symmetry");
    if (!chute.lag.empty() && chute.filling.is_predicted()) keys.emplace_back("parachute.lag");
    if (chute.filling.is_predicted()) {
        // Wolf's momentum and the balance without inertia are reductions that a mesh does not make.
        if (chute.filling.model != find_filling("predicted")) keys.emplace_back("parachute.filling.model");
        // The balance of the air in the canopy knows mouth, fabric, gaps and a vent above them.
        if (has_open_middle(chute) || holds_vent_down(chute)) keys.emplace_back("parachute.filling");
    }
    for (const CrossRefusal& refusal : cross_refusals(scene))
        keys.push_back(refusal.key);
    if (!lacks_canopy(chute).empty()) keys.emplace_back("parachute.type");
    if (keys.empty()) keys = missing_structure(chute);
    // Scenes that cannot start are refused before anything runs.
    if (keys.empty() &&
        (chute.mesh || cross_arm_ratio(chute) > 0.0 || scene.payload.body || holds_vent_down(chute))) {
        Mesh mesh = unloaded_mesh(scene);
        if (scene.payload.body) attach_payload(scene, mesh, Hang::drawn_out);
    }
    if (keys.empty()) outward_lean(scene);
    return keys;
}

}  // namespace twinchute::fullsim
