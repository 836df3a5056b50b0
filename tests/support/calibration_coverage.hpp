// How often 95 % intervals of calibrations hold the truth, over synthetic drops with random inputs.
#pragma once

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "compare/parallel.hpp"
#include "tests/support/synthetic_drop.hpp"

namespace twinchute::test {

struct Coverage {
    std::string parameter;
    int identified = 0, held_truth = 0;  ///< of those
    double bias = 0.0;                   ///< [-] mean error over the standard deviation
    double share() const { return static_cast<double>(held_truth) / identified; }
};

/// Drops of the demo with n from 3 to 9, a drag area of 34 to 52 m^2, a ratio of 0.02 to 0.15 and a clock
/// that is off by up to 1 s. They are as long as filling and a second of descent take. `step` [s]: from
/// reading to reading.
inline std::vector<Coverage> coverage_of(int drops, int threads, double step = 5e-3) {
    constexpr std::array names{"parachute.fill_time.n", "parachute.drag_area",
                               "parachute.initial_drag_area_ratio", study::clock_offset};
    struct One {
        std::array<bool, 4> identified{}, held{};
        std::array<double, 4> error{};
    };
    std::vector<One> all(static_cast<std::size_t>(drops));
    compare::in_parallel(all.size(), threads, [&](std::size_t i) {
        std::mt19937_64 random(1000 + i);
        const auto between = [&](double low, double high) {
            return std::uniform_real_distribution<double>(low, high)(random);
        };
        SyntheticDrop drop;
        drop.n = between(3.0, 9.0);
        drop.drag_area = between(34.0, 52.0);
        drop.ratio = std::exp(between(std::log(0.02), std::log(0.15)));
        drop.offset = between(-1.0, 1.0);
        drop.length = drop.n * 8.53 / 21.0 + 1.0;
        drop.seed = 5000 + i;
        drop.step = step;
        const std::array truth{drop.n, drop.drag_area, drop.ratio, drop.offset};
        study::CalibrationSettings settings;
        settings.predict = false;
        const study::Calibration calibration = calibrated({drop.test(false)}, settings);
        for (std::size_t k = 0; k < names.size(); ++k) {
            const study::Parameter& p = *calibration.find(names[k]);
            const study::FitVariable& v = p.unknown.variable;
            all[i].identified[k] = p.identified;
            all[i].held[k] = p.interval.low <= truth[k] && truth[k] <= p.interval.high;
            if (p.sigma > 0.0) all[i].error[k] = (v.to_scale(p.estimate) - v.to_scale(truth[k])) / p.sigma;
        }
    });
    std::vector<Coverage> coverage;
    for (std::size_t k = 0; k < names.size(); ++k) {
        Coverage& one = coverage.emplace_back();
        one.parameter = names[k];
        for (const One& drop : all) {
            if (!drop.identified[k]) continue;
            ++one.identified;
            one.held_truth += drop.held[k] ? 1 : 0;
            one.bias += drop.error[k];
        }
        if (one.identified > 0) one.bias /= one.identified;
    }
    return coverage;
}

inline std::string coverage_text(const std::vector<Coverage>& coverage) {
    std::string text = "input                              identified  95 % hold  bias [sigma]\n";
    for (const Coverage& one : coverage)
        text += fmt::format("{:<34} {:>10} {:>8.1f} % {:>12.3f}\n", one.parameter, one.identified,
                            100.0 * one.share(), one.bias);
    return text;
}

}  // namespace twinchute::test
