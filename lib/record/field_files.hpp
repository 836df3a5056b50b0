// The fields of a run beside its record: fields/frame-000000.vtu and on, and fields.pvd with their times.
#pragma once

#include <filesystem>
#include <vector>

#include "lib/record/file_batch.hpp"
#include "lib/record/vtu.hpp"

namespace twinchute {

/// Writes each frame to its temporary file as it comes: a run holds none of those that it has given away.
/// The batch gives them their names together with the record's.
class FieldFiles {
public:
    /// `directory`: of the record.
    FieldFiles(FileBatch& batch, std::filesystem::path directory);

    /// `frame.time` is later than that of the last one. Throws WriteError.
    void add(const VtuGrid& frame);
    /// Writes fields.pvd, unless there was no frame. Throws WriteError.
    void finish();

    std::size_t count() const { return entries_.size(); }
    std::filesystem::path collection() const { return directory_ / "fields.pvd"; }

private:
    FileBatch& batch_;
    std::filesystem::path directory_;
    std::vector<PvdEntry> entries_;
};

/// Makes the batch take away the fields that an earlier run left in `directory`, but for what it writes anew.
void remove_old_fields(FileBatch& batch, const std::filesystem::path& directory);

}  // namespace twinchute
