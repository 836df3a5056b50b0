// The fields of a run beside its record: fields/frame-000000.vtu and on, and fields.pvd with their times.
#pragma once

#include <filesystem>
#include <vector>

#include "lib/record/checkpoint.hpp"
#include "lib/record/file_batch.hpp"
#include "lib/record/vtu.hpp"

namespace twinchute {

/// Writes each frame to its temporary file as it comes: a run holds none of those that it has given away.
/// The batch gives them their names together with the record's.
class FieldFiles {
public:
    /// `directory`: of the record.
    FieldFiles(FileBatch& batch, std::filesystem::path directory);

    /// A frame that is not later than the last one begins anew: none of those before counts. Throws
    /// WriteError.
    void add(const VtuGrid& frame);
    /// From here on computes the checksum of each frame, for checkpoints.
    void compute_checksums() { computes_checksums_ = true; }
    /// Frames written so far; they stay when the batch is not committed.
    std::vector<WrittenFrame> written();
    /// Frames that a killed run wrote become the first ones of this. Throws RecordError where one of them is
    /// not what was written, WriteError.
    void adopt(const std::vector<WrittenFrame>& frames);

    /// Writes fields.pvd, unless there was no frame. Throws WriteError.
    void finish();

    std::size_t count() const { return entries_.size(); }
    std::filesystem::path collection() const { return directory_ / "fields.pvd"; }

private:
    std::string next_name() const;
    void drop_all();

    FileBatch& batch_;
    std::filesystem::path directory_;
    std::vector<PvdEntry> entries_;
    bool computes_checksums_ = false;
    std::vector<WrittenFrame> written_;
};

/// Makes the batch take away the fields that an earlier run left in `directory`, but for what it writes anew.
void remove_old_fields(FileBatch& batch, const std::filesystem::path& directory);

}  // namespace twinchute
