// A record as JSON, with the keys that scripts rely on. A key whose physics was left out is absent,
// never zero; a value that is not finite is absent as well, and a warning in its place says so.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "lib/record/checksum.hpp"
#include "lib/record/record_csv.hpp"
#include "lib/record/run_record.hpp"

namespace twinchute {

/// The text of summary.json. `files`: those written beside it; none, where the record is not written. Where
/// their tables have no line of units (`head`), it holds the units of the channels.
std::string summary_json(const RunRecord& record, const FileChecksums& files = {},
                         CsvHead head = CsvHead::names_and_units);

/// The record as a reader of its files will see it: metrics, and seconds of blocks, that are not finite are
/// left out, other such numbers are NaN (0 for the terms of the energy that are written only unless zero),
/// bytes that are not UTF-8 are replaced. A report made from this is the one that can be made again from the
/// files.
RunRecord as_written(RunRecord record);

/// Its parts, for reports that hold more than one record.
nlohmann::ordered_json scene_json(const SceneId& scene);
nlohmann::ordered_json inputs_json(const std::vector<Input>& inputs);
nlohmann::ordered_json status_json(const RunStatus& status);
nlohmann::ordered_json cost_json(const Cost& cost);
nlohmann::ordered_json warnings_json(const std::vector<Warning>& warnings);
nlohmann::ordered_json left_out_json(const std::vector<LeftOut>& left_out);
nlohmann::ordered_json provenance_json(const Provenance& provenance);

/// As text: indented, numbers with full round-trip precision, ended by a newline. Bytes that are not
/// UTF-8 are replaced.
std::string json_text(const nlohmann::ordered_json& json);

}  // namespace twinchute
