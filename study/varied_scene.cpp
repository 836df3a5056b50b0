#include "study/varied_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "lib/math/vec.hpp"
#include "lib/scene/scene_error.hpp"
#include "lib/scene/write_scene.hpp"

namespace twinchute::study {
namespace {

using SetKey = std::function<void(Scene&, const KeyValue&)>;

std::vector<KeyValue> as_values(std::span<const double> numbers) {
    return {numbers.begin(), numbers.end()};
}

/// Setting a key of one parachute; nothing where the reader alone can.
SetKey setter_of_parachute(const Scene& base, std::size_t index, const std::string& path) {
    const bool is_area = path == "parachute.drag_area";
    if (is_area || path == "parachute.drag_coefficient") {
        if (base.parachutes[index].uncorrected_drag_area) return {};
        return [index, is_area](Scene& scene, const KeyValue& value) {
            Parachute& chute = scene.parachutes[index];
            const double number = std::get<double>(value), D0 = chute.nominal_diameter;
            chute.drag_area = is_area ? number : number * 0.25 * pi * D0 * D0;
        };
    }
    const Key* row = find_key(scene_keys(), path);
    if (row == nullptr || row->path != path) return {};  // a member of a list is set by reading
    if (const auto* of_chute = std::get_if<BindingOf<Parachute>>(&row->binding); of_chute && of_chute->set)
        return [index, set = of_chute->set](Scene& scene, const KeyValue& value) {
            set(scene.parachutes[index], value);
        };
    const auto* of_time = std::get_if<BindingOf<FillTime>>(&row->binding);
    if (!of_time || !of_time->set || !path.starts_with("parachute.fill_time.")) return {};
    return [index, set = of_time->set](Scene& scene, const KeyValue& value) {
        set(scene.parachutes[index].fill_time, value);
    };
}

SetKey setter_of(const Scene& base, const std::string& key) {
    constexpr std::string_view head = "parachute.";
    if (key.starts_with(head)) {
        for (std::size_t i = 0; i < base.parachutes.size(); ++i) {
            const std::string own = fmt::format("parachute.{}.", base.parachutes[i].name);
            if (key.starts_with(own))
                return setter_of_parachute(base, i, std::string(head) + key.substr(own.size()));
        }
        return base.parachutes.size() == 1 ? setter_of_parachute(base, 0, key) : SetKey{};
    }
    const Key* row = find_key(scene_keys(), key);
    const auto* of_scene = row && row->path == key ? std::get_if<BindingOf<Scene>>(&row->binding) : nullptr;
    if (!of_scene || !of_scene->set) return {};
    return [set = of_scene->set](Scene& scene, const KeyValue& value) { set(scene, value); };
}

KeyRange range_of(const Scene& base, const std::string& key) {
    constexpr std::string_view head = "parachute.";
    const Key* row = find_key(scene_keys(), key);
    for (const Parachute& chute : base.parachutes)
        if (const std::string own = fmt::format("parachute.{}.", chute.name); key.starts_with(own))
            row = find_key(scene_keys(), std::string(head) + key.substr(own.size()));
    return row ? row->range : KeyRange{};
}

std::string toml(const KeyValue& value) {
    if (const auto* word = std::get_if<std::string>(&value)) return fmt::format("\"{}\"", *word);
    if (const auto* whole = std::get_if<std::int64_t>(&value)) return fmt::format("{}", *whole);
    return fmt::format("{}", std::get<double>(value));
}

}  // namespace

VariedScene::VariedScene(SceneWith scene_with, std::vector<std::string> keys,
                         const std::vector<double>& probe)
    : VariedScene(std::move(scene_with), std::move(keys), as_values(probe)) {}

VariedScene::VariedScene(SceneWith scene_with, std::vector<std::string> keys,
                         const std::vector<KeyValue>& probe)
    : scene_with_(std::move(scene_with)), keys_(std::move(keys)), base_(scene_with_({})) {
    if (auto found = setters()) {
        setters_ = std::move(*found);
        quick_ = true;
    }
    base_.inputs.clear();
    base_.warnings.clear();
    check(probe);
}

std::optional<std::vector<VariedScene::Setter>> VariedScene::setters() const {
    std::vector<Setter> all;
    for (const std::string& key : keys_) {
        SetKey set = setter_of(base_, key);
        if (!set) return std::nullopt;
        all.push_back({range_of(base_, key), std::move(set)});
    }
    return all;
}

bool VariedScene::Setter::takes(const KeyValue& value) const {
    if (const auto* number = std::get_if<double>(&value)) return range.contains(*number);
    if (const auto* whole = std::get_if<std::int64_t>(&value))
        return range.contains(static_cast<double>(*whole));
    return true;
}

bool VariedScene::check(const std::vector<KeyValue>& values) {
    Scene wanted;
    try {
        wanted = read(values);
    } catch (const SceneError&) {
        // Checks that go beyond the range of one key are made by reading alone.
        for (std::size_t i = 0; quick_ && i < keys_.size(); ++i)
            if (!setters_[i].takes(values[i])) throw;
        quick_ = false;
        throw;
    }
    if (!quick_) return false;
    Scene tried = base_;
    put(tried, values);
    return quick_ = same_scene(tried, wanted);
}

void VariedScene::check_corners(const std::vector<KeyValue>& low, const std::vector<KeyValue>& high) {
    const auto check_at = [&](const auto& is_high) {
        std::vector<KeyValue> corner = low;
        for (std::size_t i = 0; i < corner.size(); ++i)
            if (is_high(i)) corner[i] = high[i];
        try {
            check(corner);
        } catch (const SceneError&) {
            // Such values are refused one by one.
        }
    };
    // Two different numbers differ in a binary digit.
    for (const bool other : {false, true}) {
        check_at([&](std::size_t) { return other; });
        for (std::size_t digit = 1; quick_ && digit < keys_.size(); digit *= 2)
            check_at([&](std::size_t i) { return ((i & digit) != 0) != other; });
    }
}

void VariedScene::put(Scene& scene, std::span<const KeyValue> values) const {
    if (!quick_) {
        scene = read(values);
        return;
    }
    for (std::size_t i = 0; i < keys_.size(); ++i) {
        if (!setters_[i].takes(values[i]))
            throw SceneError({}, keys_[i], fmt::format("{} is out of range", toml(values[i])), "", "");
        setters_[i].set(scene, values[i]);
    }
}

Scene VariedScene::at(std::span<const double> values) const {
    if (!quick_) return read(values);
    Scene scene = base_;
    for (std::size_t i = 0; i < keys_.size(); ++i)
        setters_[i].set(scene, values[i]);
    return scene;
}

Scene VariedScene::read(std::span<const double> values) const {
    return read(as_values(values));
}

Scene VariedScene::read(std::span<const KeyValue> values) const {
    std::vector<std::string> more;
    for (std::size_t i = 0; i < keys_.size(); ++i)
        more.push_back(fmt::format("--vary {}={}", keys_[i], toml(values[i])));
    return scene_with_(more);
}

}  // namespace twinchute::study
