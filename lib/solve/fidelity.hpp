// Interface of a model that can be run and compared. The comparison sees rows of this table and
// nothing else, so that a third fidelity (a CFD code, a flight-test file) is one more row.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "lib/record/frames.hpp"
#include "lib/record/run_record.hpp"
#include "lib/record/vtu.hpp"
#include "lib/scene/scene.hpp"
#include "lib/solve/plan.hpp"

namespace twinchute {

struct Progress {
    std::string_view stage;                 ///< e.g. "inflation"
    double time = 0.0;                      ///< [s] simulated, since release; not a number: none is said
    double share = 0.0;                     ///< [-] of the run, an estimate in 0..1
    std::optional<double> resumed_at = {};  ///< [s] simulated: the checkpoint that the run went on from
};

/// Checkpoints of a long run: now and then it gives away all that it needs to go on.
struct Checkpoints {
    /// Takes a state of the run (lib/record/archive.hpp), again and again. Empty: none are made.
    std::function<void(std::string)> save;
    std::string from = {};  ///< one of these states, to go on from; empty: from release
    std::string file = {};  ///< that it is of, for messages
};

/// A row of the history of a run that goes on, for who watches it.
struct WatchedRow {
    double time;   ///< [s] since release
    double force;  ///< [N] as the channel of that name
    double speed;  ///< [m/s] of the payload over ground
};

/// Settings and callbacks of a run that are not physics.
struct Run {
    std::stop_token stop;                           ///< asks for an early, clean end
    std::function<void(const Progress&)> progress;  ///< may be empty; called now and then
    /// May be empty; takes the frames of a scene that asks for them, in the order of their times. One that is
    /// not later than the last belongs to a run that began anew: none of those before counts. What it throws
    /// ends the run.
    std::function<void(const VtuGrid&)> fields = {};
    /// May be empty; takes the shapes for the report, once, at the end of a run that has some.
    std::function<void(ShapeFrames)> frames = {};
    int threads = 1;  ///< at most; the answer is the same for any number
    /// Lays a structure out in memory as for a mesh without any order, where its own would allow a faster
    /// way: the answer is the same but for rounding. For checks; no scene asks for it.
    bool force_unstructured = false;
    Checkpoints checkpoints = {};
    /// [s] since release, rising. Where there are some, the record has its channels at these times alone, as
    /// far as the run comes, with the specific force among them, and neither metrics nor inputs: for who runs
    /// a model thousands of times. Of fidelities that say so.
    std::span<const double> samples = {};
    /// May be empty; takes rows of the history once nothing changes them any more, in the order of their
    /// times; the last ones come with the record alone. One that is not later than the last belongs to a run
    /// that began anew: none of those before counts. Of fidelities whose runs are long.
    std::function<void(const WatchedRow&)> rows = {};
    /// May be empty; takes all shapes for the report so far whenever there are more, if `frames` is there.
    std::function<void(const ShapeFrames&)> frames_so_far = {};
};

struct Fidelity {
    std::string_view name;   ///< directory and column name: "rom", "full"
    std::string_view title;  ///< e.g. "reduced-order model"
    RunRecord (*run)(const Scene&, Run&) = nullptr;
    /// Keys of the scene whose physics this fidelity lacks, or which it needs and the scene does not give;
    /// never null, usually empty.
    std::vector<std::string> (*unsupported_keys)(const Scene&) = nullptr;
    bool gives_fields = false;  ///< it has frames to give at `<name>.fields_rate`
    bool has_threads = false;   ///< it is faster with some
    /// Plan of a run: what the scene would need and cost; may be null. Throws SceneError.
    Plan (*plan)(const Scene&, const PlanBasis&) = nullptr;
    bool keeps_checkpoints = false;  ///< its runs may be long: it saves states, and goes on from them
    /// Metrics of a run by their keys in a record, NaN where it has none, and how it ended: those of run(),
    /// for who makes very many. Null: run() alone has them.
    RunStatus (*metrics)(const Scene&, Run&, std::span<const std::string> keys,
                         std::span<double> values) = nullptr;
    /// Whether metrics_of_batch() takes scenes of this kind, for these metrics. Null: none.
    bool (*batches)(const Scene&, std::span<const std::string> keys) = nullptr;
    /// Metrics of `batch` scenes at once, a row of `values` each: within the tolerance those of metrics(), a
    /// scene that is unlike the others included. The same scenes in the same order give the same bits.
    void (*metrics_of_batch)(std::span<const Scene> scenes, Run&, std::span<const std::string> keys,
                             std::span<double> values, std::span<StatusCode> statuses) = nullptr;
    std::size_t batch = 0;
};

/// Why a fidelity cannot run a scene, of the keys that it lacks: "it lacks the physics of 'x'", or "it needs
/// 'x'" where the scene does not give that key.
std::string unsupported_text(const Scene& scene, const std::vector<std::string>& keys);

/// A record with everything filled in that does not depend on the run: scene, inputs, provenance.
RunRecord begin_record(const Scene& scene, std::string_view fidelity);

}  // namespace twinchute
