// Shortfalls of a run, for every fidelity: parachutes that never opened, metrics without a value.
#pragma once

#include <string>
#include <vector>

#include "lib/record/run_record.hpp"
#include "lib/scene/scene.hpp"
#include "lib/solve/opening_sequence.hpp"

namespace twinchute {

/// A parachute, or some of a cluster, that the scene means to open and that did not.
struct NeverOpened {
    std::size_t parachute = 0;  ///< in the scene
    int count = 1;              ///< canopies
    std::string why;
    std::string remedy = {};  ///< empty: what a parachute that waits needs
    bool in_the_air = false;  ///< whatever ended the run, not on the ground alone
};

/// Canopies of `sequence` that have not opened by the end of a run.
std::vector<NeverOpened> never_opened(const OpeningSequence& sequence);

/// How far a run came, beside its status.
struct Reached {
    bool ground = false;               ///< the payload, or a pack, is on the ground
    bool full_open = false;            ///< every canopy that is out is full, and none is still to come out
    bool filling = false;              ///< a canopy had begun to fill and is not full
    std::string no_filling_time = {};  ///< why there is none although the canopy is full; empty: no reason
    bool filling_cut_short = false;    ///< that reason is the end of the run
};

/// On the ground whatever has never opened has failed, since nothing will open it any more, and so has what
/// fails in the air: a warning, the metric unopened_parachutes and the status not_opened say so. A run that
/// the scene stops in the air may stop before a deployment. A run that broke off keeps its status.
void note_never_opened(RunRecord& record, const Scene& scene, const std::vector<NeverOpened>& unopened,
                       const Reached& reached);

/// Warns of each parachute that left its pack later than it should have, since another was on its way out; of
/// each that was cut while it was still filling, or behind a reefing line: its peak is of
/// no full canopy; and of a payload that comes to the ground when the last of them has been cut.
void warn_of_sequence(RunRecord& record, const Scene& scene, const OpeningSequence& sequence);

/// Says of filling time, peak force and descent rate, by which two fidelities are judged, why the record
/// lacks them: because the scene's own stop came before (not_reached), or because something went wrong. The
/// ground is no excuse for a canopy that is not full. Call it once metrics and status are known.
void note_missing_metrics(RunRecord& record, const Scene& scene, const Reached& reached);

}  // namespace twinchute
