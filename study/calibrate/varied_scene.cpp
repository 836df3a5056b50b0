#include "study/calibrate/varied_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "lib/scene/keys.hpp"
#include "lib/scene/write_scene.hpp"

namespace twinchute::study {
namespace {

/// Sets a key of one parachute; false where the reader alone can.
bool set_of_parachute(Parachute& chute, const std::string& path, double value) {
    if (path == "parachute.drag_area") {
        if (chute.uncorrected_drag_area) return false;
        chute.drag_area = value;
        return true;
    }
    const Key* row = find_key(scene_keys(), path);
    if (row == nullptr) return false;
    if (const auto* of_chute = std::get_if<BindingOf<Parachute>>(&row->binding); of_chute && of_chute->set) {
        of_chute->set(chute, value);
        return true;
    }
    const auto* of_time = std::get_if<BindingOf<FillTime>>(&row->binding);
    if (!of_time || !of_time->set || !path.starts_with("parachute.fill_time.")) return false;
    of_time->set(chute.fill_time, value);
    return true;
}

bool set_key(Scene& scene, const std::string& key, double value) {
    constexpr std::string_view head = "parachute.";
    if (key.starts_with(head)) {
        for (Parachute& chute : scene.parachutes) {
            const std::string own = fmt::format("parachute.{}.", chute.name);
            if (key.starts_with(own))
                return set_of_parachute(chute, std::string(head) + key.substr(own.size()), value);
        }
        return scene.parachutes.size() == 1 && set_of_parachute(scene.parachutes.front(), key, value);
    }
    const Key* row = find_key(scene_keys(), key);
    const auto* of_scene = row ? std::get_if<BindingOf<Scene>>(&row->binding) : nullptr;
    if (!of_scene || !of_scene->set) return false;
    of_scene->set(scene, value);
    return true;
}

bool set_keys(Scene& scene, const std::vector<std::string>& keys, std::span<const double> values) {
    for (std::size_t i = 0; i < keys.size(); ++i)
        if (!set_key(scene, keys[i], values[i])) return false;
    return true;
}

}  // namespace

VariedScene::VariedScene(SceneWith scene_with, std::vector<std::string> keys,
                         const std::vector<double>& probe)
    : scene_with_(std::move(scene_with)), keys_(std::move(keys)), base_(scene_with_({})) {
    const Scene wanted = read(probe);
    Scene tried = base_;
    quick_ = set_keys(tried, keys_, probe) && same_scene(tried, wanted);
    base_.inputs.clear();
    base_.warnings.clear();
}

Scene VariedScene::at(std::span<const double> values) const {
    if (!quick_) return read(values);
    Scene scene = base_;
    set_keys(scene, keys_, values);
    return scene;
}

Scene VariedScene::read(std::span<const double> values) const {
    std::vector<std::string> more;
    for (std::size_t i = 0; i < keys_.size(); ++i)
        more.push_back(fmt::format("--vary {}={}", keys_[i], values[i]));
    return scene_with_(more);
}

}  // namespace twinchute::study
