// A record as files in a directory.
#pragma once

#include <filesystem>

#include "lib/record/file_batch.hpp"
#include "lib/record/frames.hpp"
#include "lib/record/record_csv.hpp"
#include "lib/record/run_record.hpp"

namespace twinchute {

/// Writes history.csv, events.csv, frames.bin where there are frames and, last, summary.json into
/// `directory`, which is made when it is not there; fields and frames of an earlier record go. Throws
/// WriteError; then nothing that stood there before has changed. `head`: of both tables.
void write_record(const RunRecord& record, const std::filesystem::path& directory,
                  const ShapeFrames& frames = {}, CsvHead head = CsvHead::names_and_units);

/// Adds the files of a record to a larger batch.
void add_record(FileBatch& batch, const RunRecord& record, const std::filesystem::path& directory,
                const ShapeFrames& frames = {}, CsvHead head = CsvHead::names_and_units);

}  // namespace twinchute
