// A drop that was never measured: the reduced-order model with inputs that are known, through a filter of
// first order and with normal noise.
#pragma once

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "lib/scene/read_scene.hpp"
#include "rom/fidelity.hpp"
#include "study/calibrate/calibration.hpp"

namespace twinchute::test {

/// The demo, of the reduced-order model.
inline Scene demo_scene_with(const std::vector<std::string>& overrides = {}) {
    return read_scene(TWINCHUTE_SOURCE_DIR "/data/scenes/c9-inflation.toml", overrides);
}

struct SyntheticDrop {
    double n = 5.5, drag_area = 39.0, ratio = 0.06;  ///< [-], [m^2], [-]
    double noise = 0.03;                             ///< [-] of the peak
    double bandwidth = 50.0;                         ///< [Hz]
    double step = 5e-3, length = 3.0;                ///< [s]
    double offset = 0.0, scale = 1.0;                ///< [s] of the clock, [-] of the sensor
    unsigned long seed = 1;
    std::vector<std::string> more = {};  ///< overrides of the scene that it is dropped with

    std::vector<std::string> truth() const {
        std::vector<std::string> all = more;
        all.push_back("parachute.fill_time.n=" + std::to_string(n));
        all.push_back("parachute.drag_area=" + std::to_string(drag_area));
        all.push_back("parachute.initial_drag_area_ratio=" + std::to_string(ratio));
        return all;
    }

    /// Its readings. The filter is integrated here by itself, in steps of a sixth of a millisecond.
    study::MeasuredHistory readings() const {
        const int fine = std::max(30, static_cast<int>(step / 1.5e-4));
        Scene scene = demo_scene_with(truth());
        scene.stop = {Trigger::Kind::time, length + step, 0.0, {}};
        scene.rom.rtol = 1e-11;
        std::vector<double> times;
        const int count = static_cast<int>(std::lround(length / step));
        for (int i = 0; i <= fine * count; ++i)
            times.push_back(i * step / fine);
        Run run;
        run.samples = times;
        const RunRecord record = rom::rom_fidelity().run(scene, run);
        const std::vector<double>& force = record.find_channel("force")->values;
        const double peak = *std::ranges::max_element(force);
        std::mt19937_64 random(seed);
        std::normal_distribution<double> normal(0.0, noise * peak);
        study::MeasuredHistory history{study::find_history_kind("force"), {}, {}, noise * peak, bandwidth};
        const double decay = -std::expm1(-2.0 * std::numbers::pi * bandwidth * step / fine);
        double reading = force[0];
        for (std::size_t i = 0; i < force.size(); ++i) {
            reading += (force[i] - reading) * decay;
            if (i % fine > 0) continue;
            history.time.push_back(times[i] + offset);
            history.value.push_back(scale * (reading + normal(random)));
        }
        return history;
    }

    study::DropTest test(bool clock_known = true) const {
        study::DropTest test;
        test.name = "synthetic";
        test.clock_known = clock_known;
        test.histories.push_back(readings());
        return test;
    }
};

inline study::Calibration calibrated(const std::vector<study::DropTest>& tests,
                                     study::CalibrationSettings settings = {}) {
    return study::calibrate([](const std::vector<std::string>& more) { return demo_scene_with(more); }, tests,
                            rom::rom_fidelity(), settings);
}

}  // namespace twinchute::test
