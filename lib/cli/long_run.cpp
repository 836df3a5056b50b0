#include "lib/cli/long_run.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <system_error>

#include "lib/cli/text.hpp"
#include "lib/record/file_batch.hpp"
#include "lib/record/read_record.hpp"
#include "lib/record/record_json.hpp"
#include "lib/scene/scene_digest.hpp"

namespace twinchute {
namespace {

namespace fs = std::filesystem;

bool is_there(const fs::path& file) {
    std::error_code ignored;
    return fs::exists(fs::symlink_status(file, ignored));
}

/// Difference between a scene and that of a record; empty when there is none.
std::string difference(const Scene& scene, const RunRecord& record) {
    if (record.scene.sha256 != scene.sha256) return "the scene file has changed since";
    RunRecord asked;
    asked.inputs = scene.inputs;
    asked = as_written(std::move(asked));
    for (const Input& input : asked.inputs) {
        const Input* there = record.find_input(input.key);
        const bool same = there != nullptr && there->value == input.value;
        if (!same && input.key != "full.checkpoint_interval") return "they differ in " + input.key;
    }
    if (asked.inputs.size() != record.inputs.size()) return "other keys were given";
    return scene_digest(scene) == record.scene.digest ? ""
                                                      : "a table, a material or a mesh has changed since";
}

}  // namespace

Option resume_option() {
    return {"resume", "",
            "go on where a run was cut off, from the checkpoint in the directory of its record; what has "
            "ended there is not run again"};
}

LongRun::LongRun(const Fidelity& fidelity, const Scene& scene, fs::path directory, bool resumes)
    : directory_(std::move(directory)),
      of_{current_program(), std::string(fidelity.name), scene_digest(scene)},
      keeps_(fidelity.keeps_checkpoints) {
    if (!keeps_ || !resumes) return;
    from_ = read_checkpoint(directory_);
    if (from_) require_same(from_->of, of_, checkpoint_file(directory_).string());
}

Checkpoints LongRun::checkpoints(FieldFiles& fields) {
    if (!keeps_) return {};
    fields.compute_checksums();
    Checkpoints made;
    if (from_) {
        fields.adopt(from_->frames);
        made.from = std::move(from_->state);
        made.file = checkpoint_file(directory_).string();
        from_.reset();
    }
    made.save = [this, &fields](std::string state) { save({of_, fields.written(), std::move(state)}); };
    return made;
}

/// A run is worth more than its checkpoint: one that cannot be written does not end it.
void LongRun::save(const Checkpoint& checkpoint) {
    try {
        std::error_code error;
        fs::create_directories(directory_, error);
        if (error) throw WriteError(directory_, error.value());
        replace_file(checkpoint_file(directory_), checkpoint_bytes(checkpoint));
    } catch (const WriteError& error) {
        if (!said_) std::fputs(fmt::format("twinchute: {}; the run goes on\n", error.what()).c_str(), stderr);
        said_ = true;
    }
}

void LongRun::sign(RunRecord& record) const {
    record.scene.digest = of_.scene;
}

void LongRun::ended(const RunRecord& record) {
    if (record.status.code == StatusCode::interrupted) return;
    std::error_code ignored;  // one that cannot go makes the next --resume end as this run did
    if (keeps_) fs::remove(checkpoint_file(directory_), ignored);
    remove_abandoned(directory_);
}

std::optional<RunRecord> finished_record(const Fidelity& fidelity, const Scene& scene,
                                         const fs::path& directory) {
    const fs::path summary = directory / "summary.json";
    if (is_there(checkpoint_file(directory)) || !is_there(summary)) return {};
    RunRecord record = read_record(directory);
    const auto refuse = [&](const char* problem, const std::string& why) {
        throw RecordError({summary.string()}, problem, why,
                          "name another directory with --out, or run without --resume to replace it");
    };
    if (record.fidelity != fidelity.name) refuse("is of another model", "of '" + record.fidelity + "'");
    const Provenance here = current_provenance();
    if (const std::string why = difference(scene, record); !why.empty()) refuse("is of another scene", why);
    if (record.provenance.version != here.version || record.provenance.commit != here.commit)
        refuse("is of another version of this program",
               fmt::format("written by {} ({}), this is {} ({})", record.provenance.version,
                           record.provenance.commit, here.version, here.commit));
    if (record.status.code == StatusCode::interrupted) return {};
    return record;
}

std::string resumed_text(const RunRecord& record) {
    if (record.cost.resumed_at.empty()) return {};
    std::string times;
    for (const double time : record.cost.resumed_at)
        times += fmt::format("{}{:.4g} s", times.empty() ? "" : ", ", time);
    return fmt::format("resumed   {} at t = {}\n", record.fidelity, times);
}

void remove_abandoned(const fs::path& directory) {
    std::vector<fs::path> files;
    for (const fs::path& place : {directory, directory / "fields"}) {
        std::error_code error;
        for (fs::directory_iterator entry(place, error), end; !error && entry != end; entry.increment(error))
            if (is_abandoned(entry->path())) files.push_back(entry->path());
    }
    std::error_code ignored;
    for (const fs::path& file : files)
        fs::remove(file, ignored);
}

}  // namespace twinchute
