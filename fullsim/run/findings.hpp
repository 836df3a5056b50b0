// Findings of the events of a full run, and the parts of a run that results and warnings read.
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "fullsim/cluster.hpp"
#include "fullsim/run/observer.hpp"
#include "lib/record/archive.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/solve/opening.hpp"
#include "lib/solve/opening_sequence.hpp"
#include "lib/solve/steady_descent.hpp"

namespace twinchute::fullsim {

struct Findings {
    std::optional<double> line_stretch_time;  ///< [s]
    double snatch = 0.0;                      ///< [s] of a packed canopy infinite until it comes to it
    double snatch_speed = 0.0, payload_snatch_speed = 0.0;  ///< [m/s] through the air
    double snatch_path_angle = 0.0;                         ///< [rad] below the horizon
    double snatch_density = 0.0;                            ///< [kg/m^3]
    bool switched_late = false;                             ///< finite elements took over at full open only
    std::optional<double> met_payload;                      ///< [s] came as near as fabric and it could not
    std::vector<ParachuteResult::Stage> stages = {{}};      ///< of the opening
    std::optional<DescentWindow> descent, last_window;      ///< found steady; judged last
    std::optional<double> descent_altitude, landing_time;   ///< [m], [s]

    void serialize(Archive& archive);
};

/// A run, as results and warnings read it.
struct RunView {
    const Scene& scene;
    double stated_mass;  ///< [kg] of a parachute, by the scene; it weighs what its mesh does
    const Cluster& canopies;
    std::size_t first, count;  ///< of them: one, or all of a cluster together
    const Observer& observer;
    const Findings& findings;
    const OpeningSequence* sequence;  ///< of a reefed parachute; otherwise null

    /// The canopy, of several the last one to open.
    const Simulation& simulation() const { return canopies[last_to_open()]; }
    std::size_t last_to_open() const { return canopies.last_to_open(first, count); }
    /// The canopy in which something is largest.
    template <class Of>
    const Simulation& worst(Of&& of) const {
        std::size_t worst = first;
        for (std::size_t k = first + 1; k < first + count; ++k)
            if (of(canopies[k].system()) > of(canopies[worst].system())) worst = k;
        return canopies[worst];
    }
    /// Whether all of its canopies that begin open had settled.
    bool has_settled() const {
        for (std::size_t k = first; k < first + count; ++k)
            if (!canopies[k].has_settled()) return false;
        return true;
    }
    const Parachute& parachute() const { return scene.parachutes.front(); }
    bool packed() const { return parachute().deploy.starts_packed(); }
    bool inflated() const { return parachute().deploy.by == DeployBy::inflated; }
    /// The payload fell into the canopy, which contact between gores does not know: that ends the run.
    bool fell_in() const { return findings.met_payload && scene.full.contact == Contact::gores; }
    bool snatched() const { return std::isfinite(findings.snatch); }
    bool reefed() const { return simulation().is_reefed(); }
    /// [s] of the open canopy; infinite as long as it is reefed.
    double full_open() const { return simulation().full_open(); }
    /// [s] from which on the drag area is steady; infinite as long as the canopy is reefed.
    double drag_area_steady() const {
        return reefed() ? infinity : simulation().inflation().end_of(Phase::overshoot);
    }
    /// [m], [m/s] through the air, [kg/m^3]: at snatch.
    double snatch_altitude() const {
        if (!packed()) return scene.release.altitude;
        const auto& rows = observer.rows();
        const auto at = std::ranges::lower_bound(rows, findings.snatch, {}, &HistoryRow::time);
        return (at == rows.end() ? rows.back() : *at).position.z();
    }
    double snatch_speed() const { return packed() ? findings.snatch_speed : release_airspeed(scene).norm(); }
    double snatch_density() const {
        return packed() ? findings.snatch_density : observer.rows().front().density;
    }
    /// Largest peak of all stages.
    Observer::Peak largest_peak() const { return observer.largest_peak(); }
};

}  // namespace twinchute::fullsim
