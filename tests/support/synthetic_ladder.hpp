// A ladder of synthetic models whose errors are known exactly.
#pragma once

#include <array>
#include <cmath>

#include "compare/ladder.hpp"
#include "tests/support/c9_scene.hpp"

namespace twinchute::compare {

inline const Fidelity rom_row{"rom", "synthetic quick model", nullptr, nullptr};
inline const Fidelity full_row{"full", "synthetic dear model", nullptr, nullptr};
inline const std::array<const Fidelity*, 2> both{&rom_row, &full_row};

inline constexpr double rom_limit = 5000.0, full_limit = 4000.0;

/// The quick model is wrong by its tolerance, the dear one by 0.08 (h/h_0)^2, half of that in time; without
/// added mass both pull 10 % harder.
inline RunRecord synthetic(const Fidelity& fidelity, const Scene& scene) {
    RunRecord record;
    record.fidelity = fidelity.name;
    record.status = {StatusCode::completed, "steady descent"};
    const double harder = scene.aerodynamics.added_mass ? 1.0 : 1.1;
    if (fidelity.name == "rom") {
        record.add_metric("peak_force_N", rom_limit * harder * (1.0 + scene.rom.rtol));
        record.cost.wall_s = 1e-3 * std::pow(scene.rom.rtol, -0.2);
        record.cost.steps = 10;
    } else {
        const double h = mesh_size(scene) / mesh_size(test::c9_scene());
        const double noise = scene.full.noise ? 1e-3 * static_cast<double>(scene.full.noise->seed) : 0.0;
        record.add_metric("peak_force_N", full_limit * harder * (1.0 + 0.08 * h * h + noise));
        record.cost.wall_s = 1.0 / (h * h * h);
        record.cost.steps = 1000;
    }
    record.add_metric("filling_time_s", 1.6, MetricKind::input);
    return record;
}

inline Ladder synthetic_ladder(const LadderOptions& options = {}, const Scene& scene = test::c9_scene(),
                               const RunOne& run = synthetic) {
    return climb(scene, both, options, run);
}

}  // namespace twinchute::compare
