#include "rom/sensitivity/sensitivity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "lib/scene/keys.hpp"
#include "lib/scene/scene_error.hpp"
#include "lib/solve/fidelity.hpp"
#include "rom/run_rom.hpp"

namespace twinchute::rom {
namespace {

constexpr double step =
    1e-3;  // [-] of the input; the truncation error after extrapolation goes with its fourth power
constexpr const char* tight = "rom.rtol=1e-11";  // what is left of it in a quotient is 1e-8
constexpr const char* judged_by[] = {"peak_force_N", "filling_time_s", "descent_rate_m_s",
                                     "max_deceleration_g"};

using Metrics = std::map<std::string, double, std::less<>>;

std::optional<RunRecord> record_of(const SceneWith& scene_with, std::vector<std::string> more) {
    more.emplace_back(tight);
    try {
        const Scene scene = scene_with(more);
        Run run;
        return run_rom(scene, run);
    } catch (const SceneError&) {
        return std::nullopt;  // out of its range, or no longer in keeping with another key
    }
}

std::optional<Metrics> metrics_with(const SceneWith& scene_with, std::vector<std::string> held,
                                    const std::string& key, double value) {
    held.push_back(fmt::format("{}={}", key, value));
    const auto record = record_of(scene_with, std::move(held));
    if (!record || record->status.code != StatusCode::completed) return std::nullopt;
    Metrics metrics;
    for (const Metric& metric : record->metrics)
        metrics[metric.key] = metric.value;
    return metrics;
}

/// The row of a key of the scene; those of one of several parachutes carry its name.
const Key* row_of(const Scene& scene, std::string key) {
    for (const Parachute& p : scene.parachutes)
        if (const std::string head = "parachute." + p.name + "."; key.starts_with(head))
            key = "parachute." + key.substr(head.size());
    return find_key(scene_keys(), key);
}

/// A quantity that the reduced-order model reads, set by a key of its own.
bool is_varied(const Scene& scene, const Input& input) {
    const auto* value = std::get_if<double>(&input.value);
    const Key* row = row_of(scene, input.key);
    if (value == nullptr || *value == 0.0 || row == nullptr) return false;
    if (!row->is_number() || row->kind == KeyKind::integer) return false;
    const bool setting = input.key.starts_with("rom.") || input.key.starts_with("full.");
    return !setting && row->user != KeyUser::full && row->user != KeyUser::compare;
}

/// Overrides that keep what a design says of a parachute's size while D0 is varied alone: it would go along.
std::vector<std::string> held_beside(const Scene& scene, const std::string& key) {
    constexpr std::string_view diameter = "nominal_diameter";
    std::vector<std::string> held;
    if (!key.ends_with(diameter)) return held;
    const std::string_view parachute = std::string_view(key).substr(0, key.size() - diameter.size());
    for (const Input& input : scene.inputs) {
        const auto* value = std::get_if<double>(&input.value);
        const Key* row = row_of(scene, input.key);
        const bool designed = input.origin == InputOrigin::design || input.origin == InputOrigin::scaled;
        if (value == nullptr || row == nullptr || !designed || !input.key.starts_with(parachute)) continue;
        if (row->is_number() && row->kind != KeyKind::integer && input.key != key)
            held.push_back(fmt::format("{}={}", input.key, *value));
    }
    return held;
}

/// Richardson's extrapolation of two central quotients of ln y over the relative step.
Elasticity extrapolated(double near, double far) {
    return {(4.0 * near - far) / 3.0, std::abs(near - far)};
}

}  // namespace

double InputSensitivity::largest() const {
    double largest = 0.0;
    for (const auto& e : of)
        if (e) largest = std::max(largest, std::abs(e->value));
    return largest;
}

Sensitivity sensitivity_of(const SceneWith& scene_with, std::stop_token stop) {
    const Scene scene = scene_with({});
    Sensitivity result;
    const auto base = record_of(scene_with, {});
    if (!base) return result;
    for (const char* key : judged_by)
        if (const auto value = base->metric(key); value && *value != 0.0) {
            result.metrics.emplace_back(key);
            result.values.push_back(*value);
        }
    for (const Input& input : scene.inputs) {
        if (!is_varied(scene, input)) continue;
        if (stop.stop_requested()) break;
        const double x = std::get<double>(input.value);
        const std::vector<std::string> held = held_beside(scene, input.key);
        const auto quotients = [&](double h) {
            const auto up = metrics_with(scene_with, held, input.key, x * (1.0 + h));
            const auto down = metrics_with(scene_with, held, input.key, x * (1.0 - h));
            std::vector<std::optional<double>> of;
            for (std::size_t m = 0; m < result.metrics.size(); ++m) {
                of.emplace_back();
                if (!up || !down || !up->contains(result.metrics[m]) || !down->contains(result.metrics[m]))
                    continue;
                const double y = result.values[m];
                of.back() = (up->at(result.metrics[m]) - down->at(result.metrics[m])) / (2.0 * h * y);
            }
            return of;
        };
        const auto near = quotients(step), far = quotients(2.0 * step);
        InputSensitivity row{input.key, x, input.unit, {}};
        for (std::size_t m = 0; m < near.size(); ++m)
            row.of.push_back(near[m] && far[m] ? std::optional(extrapolated(*near[m], *far[m]))
                                               : std::nullopt);
        result.inputs.push_back(std::move(row));
    }
    std::ranges::stable_sort(result.inputs, std::ranges::greater{}, &InputSensitivity::largest);
    return result;
}

}  // namespace twinchute::rom
