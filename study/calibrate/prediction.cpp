#include "study/calibrate/prediction.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lib/math/vec.hpp"

namespace twinchute::study {
namespace {

constexpr double steps_a_time_constant = 0.8;  // of a filter: between them its input is a straight line
constexpr double settling = 6.0;               // time constants before the first reading
constexpr double fastest_scan = 100.0;         // [1/s] of the run that is shifted along a test
constexpr double scans_a_reading = 4.0;        // of it: finer than the test no clock has to be found

/// [s] of a filter of first order.
double time_constant(double bandwidth) {
    return 1.0 / (2.0 * std::numbers::pi * bandwidth);
}

/// A filter of first order over a channel that is straight between its points, at rest before them.
std::vector<double> filtered(const std::vector<double>& time, const std::vector<double>& value, double tau) {
    std::vector<double> out(value.size());
    if (value.empty()) return out;
    double y = out[0] = value[0];
    for (std::size_t i = 1; i < value.size(); ++i) {
        const double h = time[i] - time[i - 1], slope = (value[i] - value[i - 1]) / h;
        const double decay = std::exp(-h / tau);
        y = value[i] - slope * tau + (y - value[i - 1] + slope * tau) * decay;
        out[i] = y;
    }
    return out;
}

/// [m^2] over the drag area of the open canopy: D_p/D0 is that of the steady one.
double projected_over_drag_area(const Scene& scene) {
    const Parachute& chute = scene.parachutes.back();
    const double diameter = chute.projected_diameter_ratio * chute.nominal_diameter;
    return 0.25 * pi * diameter * diameter / chute.drag_area;
}

}  // namespace

Prediction::Prediction(const DropTest& test, const Fidelity& fidelity) : test_(test), fidelity_(fidelity) {
    std::vector<double> times;
    double finest = 0.0;  // time constant
    for (const MeasuredHistory& history : test.histories) {
        times.insert(times.end(), history.time.begin(), history.time.end());
        if (!history.bandwidth) continue;
        const double tau = time_constant(*history.bandwidth);
        finest = finest > 0.0 ? std::min(finest, tau) : tau;
    }
    std::ranges::sort(times);
    times.erase(std::unique(times.begin(), times.end()), times.end());
    if (times.empty()) return;
    double spacing = times.back() - times.front();
    for (std::size_t i = 1; i < times.size(); ++i)
        spacing = std::min(spacing, times[i] - times[i - 1]);
    if (spacing > 0.0) scan_rate_ = std::min(fastest_scan, scans_a_reading / spacing);
    const double step = finest / steps_a_time_constant;
    if (finest > 0.0)
        for (int i = static_cast<int>(settling * steps_a_time_constant); i > 0; --i)
            grid_.push_back(times.front() - i * step);
    for (std::size_t i = 0; i < times.size(); ++i) {
        if (i > 0 && finest > 0.0) {
            const double from = times[i - 1], gap = times[i] - from;
            const int pieces = std::min(1000, static_cast<int>(std::ceil(gap / step)));
            for (int k = 1; k < pieces; ++k)
                grid_.push_back(from + gap * k / pieces);
        }
        grid_.push_back(times[i]);
    }
    for (const MeasuredHistory& history : test.histories) {
        std::vector<std::size_t>& places = places_.emplace_back();
        for (const double t : history.time)
            places.push_back(static_cast<std::size_t>(std::ranges::lower_bound(grid_, t) - grid_.begin()));
    }
}

std::optional<Prediction::Sampled> Prediction::sampled(const Scene& scene,
                                                       const std::vector<double>& times) const {
    Run run;
    run.samples = times;
    ++runs_;
    RunRecord record = fidelity_.run(scene, run);
    if (is_numerical_failure(record.status.code) || record.status.code == StatusCode::refused) return {};
    Sampled found;
    const Channel* time = record.find_channel("time");
    if (time == nullptr || time->values.empty()) return {};
    found.time = time->values;
    for (const MeasuredHistory& history : test_.histories) {
        const bool projected = history.kind->channel == "projected_area";
        const Channel* channel = record.find_channel(projected ? "drag_area" : history.kind->channel);
        if (channel == nullptr) return {};
        std::vector<double>& values = found.channels.emplace_back(channel->values);
        const double factor = projected ? projected_over_drag_area(scene) : 1.0;
        for (double& value : values) {
            value *= factor;
            if (!std::isfinite(value)) return {};
        }
    }
    return found;
}

std::optional<Predicted> Prediction::at(const Scene& scene, double offset) const {
    Predicted predicted;
    Scene one = scene;
    one.then.clear();
    one.rom.rtol = std::min(one.rom.rtol, tight_tolerance);
    if (!test_.scalars.empty()) {
        Run run;
        ++runs_;
        const RunRecord record = fidelity_.run(one, run);
        if (is_numerical_failure(record.status.code)) return {};
        for (const MeasuredScalar& scalar : test_.scalars) {
            const auto value = record.metric(scalar.row->key);
            if (!value) return {};
            predicted.scalars.push_back(*value);
        }
    }
    if (test_.histories.empty()) return predicted;
    std::vector<double> times{0.0};
    for (const double t : grid_)
        if (t - offset > times.back()) times.push_back(t - offset);
    one.stop = {Trigger::Kind::time, times.back() + 1e-3, 0.0, {}};
    const auto run = sampled(one, times);
    if (!run) return {};
    // Where a run begins or ends in between, its first or last row stands for the rest of the clock.
    const std::size_t before = grid_.size() + 1 - times.size(), count = run->time.size();
    for (std::size_t h = 0; h < test_.histories.size(); ++h) {
        std::vector<double> values(grid_.size());
        for (std::size_t i = 0; i < grid_.size(); ++i)
            values[i] = run->channels[h][i < before ? 0 : std::min(i - before + 1, count - 1)];
        if (const auto bandwidth = test_.histories[h].bandwidth)
            values = filtered(grid_, values, time_constant(*bandwidth));
        std::vector<double>& out = predicted.histories.emplace_back();
        for (const std::size_t place : places_[h])
            out.push_back(values[place]);
    }
    return predicted;
}

std::optional<std::vector<Predicted>> Prediction::scan(const Scene& scene,
                                                       std::span<const double> offsets) const {
    Scene one = scene;
    one.then.clear();
    const double end = std::max(1.0 / scan_rate_, grid_.back() - std::ranges::min(offsets));
    std::vector<double> times;
    for (int i = 0; i <= std::ceil(end * scan_rate_); ++i)
        times.push_back(i / scan_rate_);
    one.stop = {Trigger::Kind::time, times.back() + 1e-3, 0.0, {}};
    const auto run = sampled(one, times);
    if (!run) return {};
    std::vector<Predicted> all;
    for (const double offset : offsets) {
        Predicted& predicted = all.emplace_back();
        for (std::size_t h = 0; h < test_.histories.size(); ++h) {
            std::vector<double>& out = predicted.histories.emplace_back();
            const std::vector<double>& values = run->channels[h];
            for (const double t : test_.histories[h].time) {
                const double at =
                    std::clamp((t - offset) * scan_rate_, 0.0, static_cast<double>(values.size() - 1));
                const auto left = std::min(static_cast<std::size_t>(at), values.size() - 1);
                const std::size_t right = std::min(left + 1, values.size() - 1);
                const double share = at - static_cast<double>(left);
                out.push_back((1.0 - share) * values[left] + share * values[right]);
            }
        }
    }
    return all;
}

std::pair<double, double> Prediction::filling(const Scene& scene) const {
    Run run;
    ++runs_;
    const RunRecord record = fidelity_.run(scene, run);
    const auto time = record.metric("filling_time_s");
    if (!time) return {};
    const Event* snatch = record.find_event("snatch");
    const double begin = snatch != nullptr ? snatch->time : 0.0;
    return {begin, begin + *time};
}

}  // namespace twinchute::study
