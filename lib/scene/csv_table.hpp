// A CSV file of numbers: the first line names the columns, the second their units.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lib/scene/keys.hpp"
#include "lib/scene/scene_error.hpp"

namespace twinchute {

/// A column that a table may have.
struct CsvColumn {
    std::string_view name;
    std::string_view unit;  ///< SI; the file may use any other of its kind
    KeyRange range = {};    ///< in SI
    bool twice = false;     ///< of the first one: a value may stand in two lines, one after the other
};

/// Columns in SI, each as long as the others.
struct CsvTable {
    std::string file;
    std::map<std::string, std::vector<double>, std::less<>> columns;

    bool has(std::string_view name) const { return columns.contains(name); }
    const std::vector<double>& at(std::string_view name) const { return columns.find(name)->second; }
};

/// Reads a table whose columns are among `known` and whose first one in that list is there, rises from line
/// to line (see CsvColumn::twice) and has at least `fewest` values. Cells are plain: no quotes, no empty
/// ones; the last line may end without a line feed, lines may end in CR LF. Throws SceneError with file, line
/// and column (counted in bytes from 1) of the cell that is wrong.
CsvTable read_csv_table(std::string_view text, const std::string& file, std::span<const CsvColumn> known,
                        std::size_t fewest = 2);

/// Throws SceneError about the columns that a table has, at its first line.
[[noreturn]] void refuse_columns(const std::string& file, std::string problem, std::string hint);

}  // namespace twinchute
