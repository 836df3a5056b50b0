// Deployment, from release to snatch: payload and parachute separate until the lines come taut, then the
// lines bring them to one velocity.
#pragma once

#include <optional>

#include "rom/motion.hpp"
#include "rom/openings.hpp"

namespace twinchute::rom {

template <int dimensions>
struct Deployed {
    /// The payload's place and the common velocity at lock-up, which is snatch; absent when it did not come
    /// to that.
    std::optional<Motion<dimensions>> locked = {};
    double snatch_time = 0.0;  ///< [s]
    RunStatus status = {};     ///< why the run ends here otherwise
    bool payload_landed = false;

    std::optional<double> line_stretch_time = {};  ///< [s]
    double payload_speed = 0.0;                    ///< [m/s] through the air at line stretch
    double separation_speed = 0.0;                 ///< [m/s] along the lines at line stretch
    double stretch = 0.0;                          ///< [-] largest strain of lines and risers
    double separation = 0.0;                       ///< [m] of payload and parachute at lock-up
};

/// The state of a release, as the integrators begin with it.
template <int dimensions>
Motion<dimensions> released(const Scene& scene);

/// Runs the deployment of the parachute that leaves its pack (OpeningSequence::leaves_pack()), from the
/// payload's motion at `time` [s]; others go on with what they do.
template <int dimensions>
Deployed<dimensions> deploy(const Scene& scene, RunContext& context, OpeningSequence& sequence,
                            Openings& openings, double time, const Motion<dimensions>& motion);

/// Distance [m] from the payload at which the lines come taut, measured to the anchor of a static line or to
/// the skirt, where a pack stays until then.
double taut_distance(const Parachute& chute);

}  // namespace twinchute::rom
