// Full runs, comparisons and studies that go on while the page is served.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "compare/gap.hpp"
#include "lib/scene/scene.hpp"
#include "lib/solve/fidelity.hpp"
#include "study/work.hpp"

namespace twinchute::serve {

/// Models that a server runs; the rows must outlive it.
struct Models {
    const Fidelity &full, &rom;
};

enum class RunKind { full, compare, calibrate, campaign };
constexpr bool is_study(RunKind kind) {
    return kind == RunKind::calibrate || kind == RunKind::campaign;
}
enum class RunState { running, done, failed, cancelled };

/// Their commands.
std::string_view kind_name(RunKind kind);
/// The file in which a command writes what programs read.
std::string_view summary_name(RunKind kind);
/// "running", "done", "failed", "cancelled".
std::string_view state_name(RunState state);

/// Threads of a run: one processor stays with the page.
int page_threads();

/// One run in a thread of its own. Every member may be called from any thread.
class BackgroundRun {
public:
    using Clock = std::chrono::steady_clock;

    /// Begins. It is cancelled where nobody calls asked() for `patience`. `study`: of calibrate and campaign.
    BackgroundRun(std::string id, RunKind kind, Scene scene, const Models& models,
                  std::chrono::milliseconds patience, study::StudyWork study = {});

    ~BackgroundRun();
    BackgroundRun(const BackgroundRun&) = delete;
    BackgroundRun& operator=(const BackgroundRun&) = delete;

    const std::string& id() const { return id_; }
    RunKind kind() const { return kind_; }
    const Scene& scene() const { return scene_; }
    RunState state() const;

    /// Somebody still wants it.
    void asked();
    void cancel() { stop_.request_stop(); }
    /// Until it has ended.
    void wait();

    /// Rows of the history of the full model that have been computed so far.
    struct Rows {
        std::vector<double> time, force, speed;  ///< [s], [N], [m/s]
    };
    struct Status {
        RunState state = RunState::running;
        std::string stage;
        double time = 0.0, share = 0.0;  ///< as Progress
        Rows rows;                       ///< from the first one asked for
        std::string error;               ///< why there is no result, or only a part of one
    };
    /// `first_row`: rows before it are left out.
    Status status(std::size_t first_row = 0) const;

    /// Bytes of frames.bin so far; nothing before the first shape since somebody asked.
    std::string frames();

    /// Records of the run, once it has ended and unless it came to nothing. Of a full run: `reference` and
    /// its frames alone.
    std::shared_ptr<const compare::Comparison> result() const;
    /// Documents of a study, likewise.
    std::shared_ptr<const study::StudyResult> study_result() const;

private:
    void work();
    /// Cancels the run where nobody asks for it any more.
    void watch();
    void run_models();
    void run_study();
    void end(RunState state, const std::string& error);
    void report(const Progress& progress, double from, double to);
    void add_row(const WatchedRow& row);
    RunRecord record_by(const Fidelity& fidelity, ShapeFrames& frames, double from, double to);

    const std::string id_;
    const RunKind kind_;
    const Scene scene_;
    const Models models_;
    const std::chrono::milliseconds patience_;
    const study::StudyWork study_;
    std::stop_source stop_;
    mutable std::mutex lock_;  // of what follows
    std::condition_variable ended_;
    Status status_;
    Clock::time_point asked_ = Clock::now();
    ShapeFrames shape_;          // so far
    bool shape_wanted_ = false;  // shapes of fine meshes are large
    std::shared_ptr<const compare::Comparison> result_;
    std::shared_ptr<const study::StudyResult> study_result_;
    std::jthread thread_, watch_;  // last: they use the rest
};

/// The runs of a server: two at a time, and some that have ended.
class Runs {
public:
    static constexpr std::size_t most_active = 2, most_ended = 8;
    /// Browsers let a page that is out of sight ask once a minute.
    static constexpr std::chrono::minutes patience{3};

    explicit Runs(const Models& models) : models_(models) {}

    /// Begins one, or returns null where as many go on as may.
    std::shared_ptr<BackgroundRun> start(RunKind kind, Scene scene, study::StudyWork study = {});
    /// The run of that id, or null.
    std::shared_ptr<BackgroundRun> find(std::string_view id) const;
    /// The oldest first.
    std::vector<std::shared_ptr<BackgroundRun>> all() const;
    /// Cancels what goes on, waits for its end and returns it.
    std::vector<std::shared_ptr<BackgroundRun>> end();

private:
    const Models models_;
    mutable std::mutex lock_;
    std::vector<std::shared_ptr<BackgroundRun>> runs_;
    int last_id_ = 0;
};

/// Writes what a run has computed into a new directory of `place`, named after its scene, and returns that:
/// the record of a full run, both records and the report, or those of a campaign. Nothing where there is no
/// result. Throws WriteError.
std::optional<std::filesystem::path> save_run(const BackgroundRun& run, const std::filesystem::path& place);

}  // namespace twinchute::serve
