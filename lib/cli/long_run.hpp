// A run that survives: its checkpoints beside its record, and the way back into it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "lib/cli/command.hpp"
#include "lib/record/checkpoint.hpp"
#include "lib/record/field_files.hpp"
#include "lib/solve/fidelity.hpp"

namespace twinchute {

/// --resume, for commands that run a fidelity which keeps checkpoints.
Option resume_option();

/// The checkpoints of one run of a fidelity in the directory of its record. Nothing of it is there for a
/// fidelity that keeps none.
class LongRun {
public:
    /// `resumes`: goes on from the checkpoint that is there, if any. Throws RecordError where that is of
    /// another scene, version or model, or where it or a frame of the fields is not what was written.
    LongRun(const Fidelity& fidelity, const Scene& scene, std::filesystem::path directory, bool resumes);

    /// The frames written so far become those of `fields`; checkpoints name those to come. Throws RecordError
    /// and WriteError. `fields` has to outlive the result.
    Checkpoints checkpoints(FieldFiles& fields);

    /// Says in the record what it was made from, for finished_record.
    void sign(RunRecord& record) const;
    /// The record is safe under its name: nothing is left to go on from, unless it was interrupted.
    void ended(const RunRecord& record);

private:
    void save(const Checkpoint& checkpoint);

    std::filesystem::path directory_;
    CheckpointOf of_;
    bool keeps_;
    std::optional<Checkpoint> from_;
    bool said_ = false;  // that one could not be written
};

/// The record in a directory, where that of a run of this scene by this version has ended there before:
/// nothing where there is none, or one that was interrupted, or where a checkpoint says that a run was cut
/// off. Throws RecordError where it is of another scene or version: --resume replaces no results.
std::optional<RunRecord> finished_record(const Fidelity& fidelity, const Scene& scene,
                                         const std::filesystem::path& directory);

/// For reading: where the run went on from, or nothing.
std::string resumed_text(const RunRecord& record);

/// Takes away the temporary files that killed runs left in a directory of a record and its fields.
void remove_abandoned(const std::filesystem::path& directory);

}  // namespace twinchute
