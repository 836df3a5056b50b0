// A ladder as files: the plot, the table for reading, and all data as CSV and JSON.
#pragma once

#include <filesystem>
#include <string>

#include "compare/ladder.hpp"
#include "lib/cli/text.hpp"
#include "lib/record/file_batch.hpp"

namespace twinchute::compare {

/// A line for each rung and metric; rungs without any metric have one line.
std::string ladder_csv(const Ladder& ladder);
std::string ladder_json(const Ladder& ladder);
std::string ladder_markdown(const Ladder& ladder);
std::string ladder_svg(const Ladder& ladder);

/// For the terminal: a line for each rung, the references, and the advice as the last line.
std::string ladder_text(const Ladder& ladder, const Style& style);

/// ladder.csv, ladder.md, ladder.svg and, as the marker, ladder.json.
void add_ladder(FileBatch& batch, const Ladder& ladder, const std::filesystem::path& directory);

}  // namespace twinchute::compare
