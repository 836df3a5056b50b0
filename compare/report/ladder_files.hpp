// A ladder as files: the plot, the table for reading, and all data as CSV and JSON.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "compare/ladder.hpp"
#include "compare/render/table.hpp"
#include "lib/record/file_batch.hpp"

namespace twinchute::compare {

/// A line for each level and metric; levels without any metric have one line.
std::string ladder_csv(const Ladder& ladder);
std::string ladder_json(const Ladder& ladder);
std::string ladder_markdown(const Ladder& ladder);
std::string ladder_svg(const Ladder& ladder);

/// Families of levels that the picture knows, in its order.
std::vector<std::string_view> drawn_families();

/// A row for each level: what it cost and how far it is from its reference.
Table levels_table(const Ladder& ladder);
/// References of errors; not `all`: of the judged metrics alone.
Table references_table(const Ladder& ladder, bool all);

/// For the terminal: a line for each level, the references, and the advice as the last line.
std::string ladder_text(const Ladder& ladder, const Style& style);

/// ladder.csv, ladder.md, ladder.svg and, as the marker, ladder.json.
void add_ladder(FileBatch& batch, const Ladder& ladder, const std::filesystem::path& directory);

}  // namespace twinchute::compare
