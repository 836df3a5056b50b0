// Many records side by side: one row a record, metrics as columns.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "lib/cli/text.hpp"
#include "lib/record/run_record.hpp"

namespace twinchute::compare {

/// Part of a record that a table keeps: histories of a hundred would fill the memory.
struct RecordRow {
    std::string place;  ///< its directory, as the reader named it
    std::string scene, fidelity, status;
    std::vector<std::pair<std::string, double>> metrics;  ///< by key, finite
    double wall_s = 0.0;
};

RecordRow record_row(const RunRecord& record, std::string place);

/// The metrics that say most; the files have all.
std::string records_terminal(const std::vector<RecordRow>& rows, const Style& style);

/// The text of report.md.
std::string records_markdown(const std::vector<RecordRow>& rows);

/// The text of records.csv: first line names, second line units; a metric that a record lacks is an empty
/// field.
std::string records_csv(const std::vector<RecordRow>& rows);

/// The text of records.json; a metric that a record lacks is absent.
std::string records_json(const std::vector<RecordRow>& rows);

}  // namespace twinchute::compare
