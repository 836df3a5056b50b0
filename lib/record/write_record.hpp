// A record as files in a directory.
#pragma once

#include <filesystem>

#include "lib/record/file_batch.hpp"
#include "lib/record/file_sums.hpp"
#include "lib/record/run_record.hpp"

namespace twinchute {

/// Writes history.csv, events.csv and, last, summary.json into `directory`, which is made when it is
/// not there; fields of an earlier record go. Throws WriteError; then nothing that stood there before has
/// changed.
void write_record(const RunRecord& record, const std::filesystem::path& directory);

/// The same as part of a larger batch. `others`: further files of the record that the caller adds, which the
/// summary vouches for as well.
void add_record(FileBatch& batch, const RunRecord& record, const std::filesystem::path& directory,
                const FileSums& others = {});

}  // namespace twinchute
