// The way back: a record from the files that write_record left.
#pragma once

#include <filesystem>
#include <string_view>

#include "lib/record/record_error.hpp"
#include "lib/record/run_record.hpp"

namespace twinchute {

/// Reads summary.json, history.csv and events.csv of a directory; one without summary.json is no record.
///
/// A record that was written reads back to the same bits, but for what as_written says. Keys of the JSON and
/// columns of events.csv that this version does not know are skipped; a schema or a word (status, standing,
/// origin) that it does not know is refused.
/// A file whose checksum in summary.json does not match is refused, summary.json among them; records of
/// versions without checksums are read. Throws RecordError for everything that is wrong,
/// with file, and line and column where it is a table.
RunRecord read_record(const std::filesystem::path& directory);

/// Reads a record from the texts of its three files; `directory` stands before their names in messages.
RunRecord read_record_text(std::string_view summary, std::string_view history, std::string_view events,
                           const std::filesystem::path& directory = {});

}  // namespace twinchute
