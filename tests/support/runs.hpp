// One run of each model, as tests want it.
#pragma once

#include "fullsim/run_fullsim.hpp"
#include "rom/run_rom.hpp"

namespace twinchute::test {

inline constexpr double g = standard_gravity;  ///< [m/s^2]

inline RunRecord run_rom(const Scene& scene) {
    Run control;
    return rom::run_rom(scene, control);
}

inline RunRecord run_full(const Scene& scene, std::stop_token stop = {}) {
    Run control;
    control.stop = std::move(stop);
    return fullsim::run_fullsim(scene, control);
}

/// The last value of a channel.
inline double last(const RunRecord& record, const char* channel) {
    return record.find_channel(channel)->values.back();
}

}  // namespace twinchute::test
