#include "study/campaign/sampler.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lib/scene/assemble.hpp"
#include "lib/scene/read_scene.hpp"
#include "lib/scene/write_scene.hpp"

namespace twinchute::study {
namespace {

bool is_wind(const CampaignInput& input) {
    return std::ranges::count(wind_names, input.key) > 0;
}

}  // namespace

SceneWith base_of(const CampaignSpec& spec) {
    return [text = fmt::format("base = '{}'\n", spec.base),
            file = spec.file](const std::vector<std::string>& more) {
        return read_scene_text(text, file.string(), file.parent_path(), more);
    };
}

Sampler::Sampler(const CampaignSpec& spec, const SceneWith& scene_with) : spec_(spec) {
    nominal_ = scene_with({});
    nominal_.sha256 = spec.sha256;
    std::vector<std::string> keys;
    for (std::size_t i = 0; i < spec.inputs.size(); ++i) {
        if (is_wind(spec.inputs[i])) {
            if (!nominal_.environment.wind)
                throw SceneError({spec.file.string(), 1, 1}, spec.inputs[i].key, "the scene has no wind",
                                 "nothing can be varied", "add environment.wind to the scene");
            continue;
        }
        keyed_.push_back(i);
        keys.push_back(spec.inputs[i].key);
    }
    through_air_ = std::ranges::any_of(nominal_.inputs, [](const Input& input) {
        return input.key == "release.airspeed" && input.origin != InputOrigin::fallback;
    });
    // Putting values in is held against reading: in the middle, and where inputs are near their ends.
    std::vector<double> middle;
    for (std::size_t i = 0; i < spec.inputs.size(); ++i)
        middle.push_back(spec.point_rows.empty() ? spec.inputs[i].distribution->at(0.45)
                                                 : spec.point_rows.front()[i]);
    varied_ = std::make_unique<VariedScene>(scene_with, keys, key_values(middle));
    const auto [low, high] = ends();
    varied_->check_corners(key_values(low), key_values(high));
    check_effects(low, high);
}

std::array<std::vector<double>, 2> Sampler::ends() const {
    std::array<std::vector<double>, 2> ends;
    for (std::size_t i = 0; i < spec_.inputs.size(); ++i) {
        if (spec_.point_rows.empty()) {
            ends[0].push_back(spec_.inputs[i].distribution->at(0.001));
            ends[1].push_back(spec_.inputs[i].distribution->at(0.999));
            continue;
        }
        const auto of_input = [i](const std::vector<double>& row) { return row[i]; };
        const auto [least, most] = std::ranges::minmax_element(spec_.point_rows, {}, of_input);
        ends[0].push_back((*least)[i]);
        ends[1].push_back((*most)[i]);
    }
    return ends;
}

void Sampler::check_effects(const std::vector<double>& low, const std::vector<double>& high) const {
    for (const std::size_t i : keyed_) {
        std::vector<double> other = low;
        other[i] = high[i];
        if (low[i] == high[i]) continue;
        try {
            if (!same_scene(varied_->read(key_values(low)), varied_->read(key_values(other)))) continue;
        } catch (const SceneError&) {
            continue;  // something changes
        }
        throw SceneError({spec_.file.string(), 1, 1}, spec_.inputs[i].key, "varies without effect",
                         "another key that varies sets the same quantity, or nothing uses it",
                         "vary one of them");
    }
}

std::vector<KeyValue> Sampler::key_values(std::span<const double> values) const {
    std::vector<KeyValue> all;
    all.reserve(keyed_.size());
    for (const std::size_t i : keyed_) {
        const CampaignInput& input = spec_.inputs[i];
        const auto* words = input.distribution ? &input.distribution->words() : nullptr;
        if (words && !words->empty())
            all.emplace_back((*words)[static_cast<std::size_t>(values[i])]);
        else if (input.kind == KeyKind::integer)
            all.emplace_back(static_cast<std::int64_t>(std::llround(values[i])));
        else
            all.emplace_back(values[i]);
    }
    return all;
}

void Sampler::put(Scene& scene, std::span<const double> values) const {
    if (keyed_.size() < values.size()) {
        scene.environment.wind = varied_->base().environment.wind;
        scene.release = varied_->base().release;
    }
    if (!keyed_.empty()) varied_->put(scene, key_values(values));
    disperse_wind(scene, values);
}

Scene Sampler::scene_at(std::span<const double> values) const {
    Scene scene = varied_->read(key_values(values));
    scene.sha256 = spec_.sha256;
    disperse_wind(scene, values);
    return scene;
}

void Sampler::disperse_wind(Scene& scene, std::span<const double> values) const {
    if (keyed_.size() == values.size()) return;
    const Vec3 before = scene.environment.wind->at(scene.release.altitude);
    double scale = 1.0, turn = 0.0;
    bool another = false;
    std::size_t gusts = values.size();
    for (std::size_t i = 0; i < values.size(); ++i) {
        const CampaignInput& input = spec_.inputs[i];
        if (input.key == wind_scale) scale = values[i];
        if (input.key == wind_turn) turn = values[i];
        if (input.key == wind_gusts) gusts = i;
        if (input.key == wind_table) {
            scene.environment.wind = input.winds[static_cast<std::size_t>(values[i])];
            another = true;
        }
    }
    if (!another && scale == 1.0 && turn == 0.0 && gusts == values.size()) return;
    const double c = std::cos(turn), s = std::sin(turn);
    for (WindLevel& level : scene.environment.wind->levels) {
        const Vec3 v = level.velocity;  // headings count clockwise
        level.velocity = scale * Vec3(c * v.x() + s * v.y(), c * v.y() - s * v.x(), v.z());
    }
    if (gusts < values.size())
        scene.environment.wind = with_gusts(*scene.environment.wind, *spec_.inputs[gusts].gusts, spec_.seed,
                                            values[gusts], scene.environment.ground, scene.release.altitude);
    if (!through_air_) return;
    const Vec3 after = scene.environment.wind->at(scene.release.altitude);
    scene.release = carried_by(after - before, scene.release);
}

}  // namespace twinchute::study
