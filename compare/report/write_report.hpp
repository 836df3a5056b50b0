// Everything that a comparison leaves in a directory.
#pragma once

#include <filesystem>

#include "compare/gap.hpp"
#include "compare/ladder_beside.hpp"
#include "compare/trend.hpp"
#include "lib/record/file_batch.hpp"
#include "lib/record/record_csv.hpp"

namespace twinchute::compare {

/// Writes both records (each in the directory of its fidelity's name), report.html, with the ladder that lies
/// beside it, report.md with force.svg and speed.svg, junit.xml and, last, gap.json. Throws WriteError; then
/// nothing that stood there before has changed.
void write_report(const Comparison& comparison, const std::filesystem::path& directory,
                  const LadderBeside& beside = {});

/// Writes it as part of a larger batch. `trend`: against a baseline, for junit.xml; null where there is none.
/// `head`: of the tables of both records.
void add_report(FileBatch& batch, const Comparison& comparison, const std::filesystem::path& directory,
                const LadderBeside& beside = {}, const Trend* trend = nullptr,
                CsvHead head = CsvHead::names_and_units);

/// Adds all but the records: what can be made again from them.
void add_gap_files(FileBatch& batch, const Comparison& comparison, const std::filesystem::path& directory,
                   const LadderBeside& beside = {}, const Trend* trend = nullptr);

}  // namespace twinchute::compare
