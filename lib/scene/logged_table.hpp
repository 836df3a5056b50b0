// A table as data loggers and spreadsheets write it: columns of numbers under names.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace twinchute {

struct LoggedColumn {
    std::string name;  ///< in lower case, blanks as '_', without the unit
    std::string unit;  ///< as written, from a line of its own or from brackets behind the name; empty: none
    int column = 1;    ///< of its cell in the first line, counted in bytes from 1
    int unit_line = 1, unit_column = 1;         ///< of its unit, where it has one
    std::vector<std::optional<double>> values;  ///< nothing: an empty cell, or "nan"
};

struct LoggedTable {
    std::string file;
    int head_line = 1;  ///< that names the columns
    std::vector<LoggedColumn> columns;
    std::vector<int> lines;  ///< of the values in the file, from 1

    const LoggedColumn* find(std::string_view name) const;
};

/// Cells stand between commas, semicolons or tabs, whichever the first line has, and may be quoted. Lines
/// that are empty or begin with '#' or '%' are comments. A line without numbers behind the first one holds
/// units. Where no comma separates, one may stand for the decimal point. Throws SceneError with file, line
/// and column of the cell that is wrong.
LoggedTable read_logged_table(std::string_view text, const std::string& file);

/// Readings of a column with their times: lines in which it holds a number.
struct LoggedHistory {
    std::vector<double> time;   ///< [s], rises
    std::vector<double> value;  ///< [SI]
};

/// Time [s] of each line: the column `time` or `t`, which rises from line to line. Throws SceneError.
std::vector<double> logged_times(const LoggedTable& table);
/// `times`: logged_times(table); `unit`: SI, which a column without a unit is in. Accelerations may count in
/// standard gravities, "g". Throws SceneError.
LoggedHistory logged_history(const LoggedTable& table, const std::vector<double>& times,
                             const LoggedColumn& column, std::string_view unit);

}  // namespace twinchute
