#include "serve/runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <system_error>
#include <utility>

#include "compare/parallel.hpp"
#include "compare/report/html.hpp"
#include "compare/report/write_report.hpp"
#include "compare/tolerances.hpp"
#include "lib/record/file_batch.hpp"
#include "lib/record/record_json.hpp"
#include "lib/record/write_record.hpp"
#include "lib/scene/data_files.hpp"
#include "lib/solve/hand_over.hpp"

namespace twinchute::serve {
namespace {

namespace fs = std::filesystem;

RunState state_of(const RunRecord& record) {
    if (record.status.code == StatusCode::interrupted) return RunState::cancelled;
    return is_numerical_failure(record.status.code) || record.status.code == StatusCode::refused
               ? RunState::failed
               : RunState::done;
}

BackgroundRun::Rows rows_of(const RunRecord& record) {
    const auto values = [&](std::string_view name) {
        const Channel* channel = record.find_channel(name);
        return channel ? channel->values : std::vector<double>();
    };
    return {values("time"), values("force"), values("speed")};
}

constexpr double rom_share = 0.02;  // of the time of a comparison, for its progress alone

}  // namespace

std::string_view kind_name(RunKind kind) {
    constexpr std::array<std::string_view, 4> names{"full", "compare", "calibrate", "campaign"};
    return names[static_cast<std::size_t>(kind)];
}

std::string_view summary_name(RunKind kind) {
    constexpr std::array<std::string_view, 4> names{"summary.json", "summary.json", "calibration.json",
                                                    "campaign.json"};
    return names[static_cast<std::size_t>(kind)];
}

std::string_view state_name(RunState state) {
    constexpr std::array<std::string_view, 4> names{"running", "done", "failed", "cancelled"};
    return names[static_cast<std::size_t>(state)];
}

int page_threads() {
    return std::max(1, compare::processors() - 1);
}

BackgroundRun::BackgroundRun(std::string id, RunKind kind, Scene scene, const Models& models,
                             std::chrono::milliseconds patience, study::StudyWork study)
    : id_(std::move(id)),
      kind_(kind),
      scene_(std::move(scene)),
      models_(models),
      patience_(patience),
      study_(std::move(study)),
      thread_([this] { work(); }),
      watch_([this] { watch(); }) {}

BackgroundRun::~BackgroundRun() {
    cancel();
}

RunState BackgroundRun::state() const {
    const std::lock_guard guard(lock_);
    return status_.state;
}

void BackgroundRun::asked() {
    const std::lock_guard guard(lock_);
    asked_ = Clock::now();
}

void BackgroundRun::wait() {
    if (thread_.joinable()) thread_.join();
}

BackgroundRun::Status BackgroundRun::status(std::size_t first_row) const {
    const std::lock_guard guard(lock_);
    Status copy{status_.state, status_.stage, status_.time, status_.share, {}, status_.error};
    const auto from = static_cast<std::ptrdiff_t>(std::min(first_row, status_.rows.time.size()));
    for (const auto column : {&Rows::time, &Rows::force, &Rows::speed}) {
        const std::vector<double>& all = status_.rows.*column;
        if (!all.empty()) (copy.rows.*column).assign(all.begin() + from, all.end());
    }
    return copy;
}

std::shared_ptr<const compare::Comparison> BackgroundRun::result() const {
    const std::lock_guard guard(lock_);
    return result_;
}

std::shared_ptr<const study::StudyResult> BackgroundRun::study_result() const {
    const std::lock_guard guard(lock_);
    return study_result_;
}

void BackgroundRun::report(const Progress& progress, double from, double to) {
    const std::lock_guard guard(lock_);
    status_.stage = progress.stage;
    status_.time = progress.time;
    status_.share = from + (to - from) * progress.share;
}

void BackgroundRun::watch() {
    std::unique_lock guard(lock_);
    while (status_.state == RunState::running) {
        if (Clock::now() - asked_ > patience_) {
            status_.error = fmt::format("nobody has asked for it during {:g} s, keep the page open",
                                        std::chrono::duration<double>(patience_).count());
            stop_.request_stop();
            return;
        }
        ended_.wait_until(guard, asked_ + patience_ + std::chrono::milliseconds(1));
    }
}

void BackgroundRun::add_row(const WatchedRow& row) {
    const std::lock_guard guard(lock_);
    Rows& rows = status_.rows;
    if (!rows.time.empty() && row.time <= rows.time.back()) rows = {};  // the run began anew
    rows.time.push_back(row.time);
    rows.force.push_back(row.force);
    rows.speed.push_back(row.speed);
}

std::string BackgroundRun::frames() {
    const std::shared_ptr<const compare::Comparison> ended = result();
    const std::lock_guard guard(lock_);
    shape_wanted_ = true;
    const ShapeFrames& shape = ended ? ended->reference_frames : shape_;
    return shape.empty() ? "" : frames_bytes(shape);
}

RunRecord BackgroundRun::record_by(const Fidelity& fidelity, ShapeFrames& frames, double from, double to) {
    const std::array<const Fidelity*, 2> both{&models_.full, &models_.rom};
    Run run{stop_.get_token(), [&](const Progress& progress) { report(progress, from, to); }};
    run.threads = page_threads();
    run.frames = [&frames](ShapeFrames shape) { frames = std::move(shape); };
    run.rows = [this](const WatchedRow& row) { add_row(row); };
    run.frames_so_far = [this](const ShapeFrames& shape) {
        const std::lock_guard guard(lock_);
        if (shape_wanted_) shape_ = shape;
    };
    return as_written(run_scene(fidelity, scene_, run, both));
}

void BackgroundRun::work() {
    study_ ? run_study() : run_models();
}

void BackgroundRun::end(RunState state, const std::string& error) {
    status_.state = state;
    if (state == RunState::done) status_.share = 1.0;
    if (status_.error.empty()) status_.error = error;
    ended_.notify_all();
}

void BackgroundRun::run_study() {
    std::shared_ptr<study::StudyResult> made;
    RunState state = RunState::failed;
    std::string error;
    try {
        made = std::make_shared<study::StudyResult>(
            study_(stop_.get_token(), [this](const Progress& progress) { report(progress, 0.0, 1.0); }));
        state = made->interrupted ? RunState::cancelled : RunState::done;
        if (made->json.empty()) made.reset();
    } catch (const std::exception& thrown) {
        error = thrown.what();
    }
    const std::lock_guard guard(lock_);
    end(state, error);
    study_result_ = std::move(made);
}

void BackgroundRun::run_models() {
    auto made = std::make_shared<compare::Comparison>();
    RunState state = RunState::failed;
    std::string error;
    try {
        made->reference_title = models_.full.title;
        made->candidate_title = models_.rom.title;
        const bool both = kind_ == RunKind::compare;
        if (both) made->candidate = record_by(models_.rom, made->candidate_frames, 0.0, rom_share);
        made->reference = record_by(models_.full, made->reference_frames, both ? rom_share : 0.0, 1.0);
        if (both)
            made->gap = compare::measure_gap(made->reference, made->candidate, scene_.tolerances,
                                             compare::command_line_tolerances(made->reference));
        state = state_of(made->reference);
        if (both && state == RunState::done) state = state_of(made->candidate);
        const RunRecord& worse =
            both && state_of(made->candidate) != RunState::done ? made->candidate : made->reference;
        if (state == RunState::failed) error = worse.status.detail;
    } catch (const std::exception& thrown) {
        error = thrown.what();
        made.reset();
    }
    const std::lock_guard guard(lock_);
    end(state, error);
    if (made) status_.rows = rows_of(made->reference);
    shape_ = {};
    result_ = std::move(made);
}

std::shared_ptr<BackgroundRun> Runs::start(RunKind kind, Scene scene, study::StudyWork study) {
    const std::lock_guard guard(lock_);
    const auto is_active = [](const auto& run) { return run->state() == RunState::running; };
    if (std::ranges::count_if(runs_, is_active) >= static_cast<std::ptrdiff_t>(most_active)) return nullptr;
    while (runs_.size() - static_cast<std::size_t>(std::ranges::count_if(runs_, is_active)) >= most_ended)
        runs_.erase(std::ranges::find_if_not(runs_, is_active));
    return runs_.emplace_back(std::make_shared<BackgroundRun>(
        std::to_string(++last_id_), kind, std::move(scene), models_, patience, std::move(study)));
}

std::shared_ptr<BackgroundRun> Runs::find(std::string_view id) const {
    const std::lock_guard guard(lock_);
    const auto found =
        std::ranges::find(runs_, id, [](const auto& run) -> const std::string& { return run->id(); });
    return found == runs_.end() ? nullptr : *found;
}

std::vector<std::shared_ptr<BackgroundRun>> Runs::all() const {
    const std::lock_guard guard(lock_);
    return runs_;
}

std::vector<std::shared_ptr<BackgroundRun>> Runs::end() {
    std::vector<std::shared_ptr<BackgroundRun>> going;
    for (const auto& run : all())
        if (run->state() == RunState::running) going.push_back(run);
    for (const auto& run : going)
        run->cancel();
    for (const auto& run : going)
        run->wait();
    return going;
}

std::optional<fs::path> save_run(const BackgroundRun& run, const fs::path& place) {
    const std::shared_ptr<const compare::Comparison> result = run.result();
    const std::shared_ptr<const study::StudyResult> study = run.study_result();
    if (!result && !study) return std::nullopt;
    const std::string stem = file_stem_of(run.scene().file.stem().string());
    std::error_code ignored;
    fs::path directory = (place / (stem + ".out")).lexically_normal();
    for (int number = 2; fs::exists(fs::symlink_status(directory, ignored)); ++number)
        directory = (place / fmt::format("{}-{}.out", stem, number)).lexically_normal();
    FileBatch batch;
    if (study) {
        batch.add(directory / "report.html", study->page);
        batch.add(directory / summary_name(run.kind()), study->json, FileBatch::Kind::marker);
    } else if (run.kind() == RunKind::full) {
        add_record(batch, result->reference, directory, result->reference_frames);
        batch.add(directory / "run.html", compare::record_html(result->reference, result->reference_frames,
                                                               result->reference_title, true));
    } else {
        compare::add_report(batch, *result, directory);
    }
    batch.commit();
    return directory;
}

}  // namespace twinchute::serve
