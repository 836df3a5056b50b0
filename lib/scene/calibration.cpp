#include "lib/scene/calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <type_traits>

#include "lib/scene/line_stretch.hpp"

namespace twinchute {
namespace {

/// One case for each of calibrated_keys().
template <class P>
auto* input_of(P& p, std::string_view key) {
    using Number = std::conditional_t<std::is_const_v<P>, const double, double>;
    Number* number = nullptr;
    const bool predicted = p.filling.is_predicted();
    if (key == "drag_area")
        number = p.uncorrected_drag_area ? &*p.uncorrected_drag_area : &p.drag_area;
    else if (key == "fill_time.n" && !predicted && p.fill_time.n > 0.0)
        number = &p.fill_time.n;
    else if (key == "initial_drag_area_ratio" && !predicted && !p.drag_area_table)
        number = &p.initial_drag_area_ratio;
    else if (key == "drag_area_exponent" && p.drag_area_exponent)
        number = &*p.drag_area_exponent;
    else if (key == "filling.initial_mouth" && predicted)
        number = &p.filling.initial_mouth;
    else if (key == "filling.entrance_loss" && predicted)
        number = &p.filling.entrance_loss;
    return number;
}

std::string key_head(const Scene& scene, const Parachute& p) {
    return scene.parachutes.size() == 1 ? std::string("parachute.") : "parachute." + p.name + ".";
}

void tell_input(Input& input, const CalibrationTable& table, double factor) {
    auto* value = std::get_if<double>(&input.value);
    if (value == nullptr) return;
    *value *= factor;
    input.origin = InputOrigin::calibrated;
    input.source = fmt::format("{:.4g} times the scene's, {}{}{}", factor, table.file(),
                               input.source.empty() ? "" : "; ", input.source);
}

void warn_outside(std::vector<Warning>& warnings, const std::string& whose, const CalibrationTable& table,
                  const DropConditions& at) {
    constexpr double rounding = 1e-6;  // [-] by which an end of the range may be missed
    for (std::size_t k = 0; k < condition_rows().size(); ++k) {
        const ConditionRow& row = condition_rows()[k];
        const auto [low, high] = table.range(k);
        const double value = at.values()[k];
        if (value >= low * (1.0 - rounding) && value <= high * (1.0 + rounding)) continue;
        warnings.push_back(
            {fmt::format("{}: {} {:.4g} {} is outside of its calibration", whose, row.title, value, row.unit),
             low == high ? fmt::format("'{}' was made at {:.4g} alone", table.file(), low)
                         : fmt::format("'{}' reaches from {:.4g} to {:.4g}; the nearer end is taken",
                                       table.file(), low, high),
             "add runs at these conditions to the calibration"});
    }
}

}  // namespace

DropConditions drop_conditions(const Scene& scene) {
    return {scene.payload.mass, release_airspeed(scene).norm(),
            scene.environment.atmosphere.at(scene.release.altitude).density};
}

const double* calibrated_input(const Parachute& chute, std::string_view key) {
    return input_of(chute, key);
}

Parachute calibrated(const Parachute& chute, const DropConditions& at) {
    Parachute p = chute;
    for (std::size_t i = 0; i < chute.calibration->inputs().size(); ++i) {
        const std::string& key = chute.calibration->inputs()[i].key;
        const double factor = chute.calibration->factor(i, at);
        if (key == "drag_area" && p.uncorrected_drag_area) p.drag_area *= factor;
        *input_of(p, key) *= factor;
    }
    p.calibration.reset();
    return p;
}

bool has_calibration(const Scene& scene) {
    return std::ranges::any_of(scene.parachutes,
                               [](const Parachute& p) { return p.calibration.has_value(); });
}

std::vector<CalibratedInput> calibrated_inputs(const Scene& scene) {
    const DropConditions at = drop_conditions(scene);
    std::vector<CalibratedInput> inputs;
    for (const Parachute& p : scene.parachutes)
        if (p.calibration)
            for (std::size_t i = 0; i < p.calibration->inputs().size(); ++i)
                inputs.push_back(
                    {key_head(scene, p) + p.calibration->inputs()[i].key, p.calibration->factor(i, at)});
    return inputs;
}

Scene calibrated(const Scene& scene) {
    Scene own = scene;
    const DropConditions at = drop_conditions(scene);
    for (Parachute& p : own.parachutes) {
        if (!p.calibration) continue;
        const CalibrationTable& table = *p.calibration;
        for (std::size_t i = 0; i < table.inputs().size(); ++i) {
            const std::string& key = table.inputs()[i].key;
            for (Input& input : own.inputs)
                if (input.key == key_head(scene, p) + key ||
                    (key == "drag_area" && input.key == key_head(scene, p) + "drag_coefficient"))
                    tell_input(input, table, table.factor(i, at));
        }
        warn_outside(own.warnings, p.name, table, at);
        p = calibrated(p, at);
    }
    return own;
}

Scene uncalibrated(const Scene& scene) {
    Scene own = scene;
    for (Parachute& p : own.parachutes)
        p.calibration.reset();
    return own;
}

}  // namespace twinchute
