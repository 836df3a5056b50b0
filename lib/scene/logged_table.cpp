#include "lib/scene/logged_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "lib/scene/scene_error.hpp"
#include "lib/scene/units.hpp"

namespace twinchute {
namespace {

struct LoggedCell {
    std::string text;
    int column = 1;
};

class LoggedReader {
public:
    explicit LoggedReader(const std::string& file) { table_.file = file; }

    LoggedTable read(std::string_view text) {
        if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // a mark that spreadsheets write
        int number = 0;
        while (!text.empty()) {
            const std::size_t feed = std::min(text.find_first_of("\r\n"), text.size());
            const std::string_view line = text.substr(0, feed);
            const bool pair = text.substr(feed, 2) == "\r\n";
            text.remove_prefix(std::min(feed + (pair ? 2 : 1), text.size()));
            ++number;
            const std::string_view body = trimmed(line);
            if (body.empty() || body.front() == '#' || body.front() == '%') continue;
            take(line, number);
        }
        if (table_.lines.size() < 2)
            refuse(std::max(number, 1), 1, "too few lines of numbers",
                   fmt::format("{} found below the names of the columns", table_.lines.size()),
                   "begin with a line such as time,force");
        return std::move(table_);
    }

private:
    [[noreturn]] void refuse(int line, int column, std::string problem, std::string why,
                             std::string hint) const {
        throw SceneError({table_.file, line, column}, "", std::move(problem), std::move(why),
                         std::move(hint));
    }

    void take(std::string_view line, int number) {
        if (table_.columns.empty()) return name_columns(line, number);
        std::vector<LoggedCell> cells = split(line, number);
        // A separator at the end of a line, as some programs write it.
        while (cells.size() > table_.columns.size() && cells.back().text.empty())
            cells.pop_back();
        if (cells.size() != table_.columns.size())
            refuse(number, cells.back().column,
                   fmt::format("{} cells where the first line has {}", cells.size(), table_.columns.size()),
                   "", "every line has a cell for every column");
        if (table_.lines.empty() && !has_units_line_ && is_line_of_units(cells)) {
            has_units_line_ = true;
            for (std::size_t i = 0; i < cells.size(); ++i)
                if (!cells[i].text.empty()) {
                    table_.columns[i].unit = bare_unit(cells[i].text);
                    table_.columns[i].unit_line = number;
                    table_.columns[i].unit_column = cells[i].column;
                }
            return;
        }
        table_.lines.push_back(number);
        for (std::size_t i = 0; i < cells.size(); ++i)
            table_.columns[i].values.push_back(number_in(cells[i], number));
    }

    void name_columns(std::string_view line, int number) {
        for (const char candidate : {'\t', ';', ','})
            if (is_between_cells(line, candidate)) {
                separator_ = candidate;
                break;
            }
        table_.head_line = number;
        std::vector<LoggedCell> cells = split(line, number);
        while (cells.size() > 1 && cells.back().text.empty())
            cells.pop_back();
        for (const LoggedCell& cell : cells) {
            LoggedColumn column;
            column.column = column.unit_column = cell.column;
            column.unit_line = number;
            std::string_view name = cell.text;
            if (const std::size_t open = name.find_first_of("[("); open != name.npos) {
                column.unit = bare_unit(name.substr(open));
                name = trimmed(name.substr(0, open));
            }
            for (const char c : name)
                column.name +=
                    c == ' ' || c == '-' ? '_' : static_cast<char>(c >= 'A' && c <= 'Z' ? c + 32 : c);
            if (!column.name.empty() && table_.find(column.name) != nullptr)
                refuse(number, cell.column, fmt::format("the column '{}' stands here twice", column.name), "",
                       "keep one of the two");
            table_.columns.push_back(std::move(column));
        }
    }

    static bool is_between_cells(std::string_view line, char separator) {
        bool quoted = false;
        for (const char c : line) {
            if (c == '"') quoted = !quoted;
            if (c == separator && !quoted) return true;
        }
        return false;
    }

    std::vector<LoggedCell> split(std::string_view line, int number) const {
        std::vector<LoggedCell> cells;
        std::size_t at = 0;
        for (;;) {
            while (at < line.size() && is_space(line[at]) && line[at] != separator_)
                ++at;
            LoggedCell cell{"", static_cast<int>(at) + 1};
            if (at < line.size() && line[at] == '"') {
                for (++at;; ++at) {
                    if (at >= line.size())
                        refuse(number, cell.column, "a quote is not closed", "", "end the cell with '\"'");
                    if (line[at] != '"')
                        cell.text += line[at];
                    else if (line.substr(at + 1, 1) == "\"")
                        cell.text += line[at++];
                    else
                        break;
                }
                ++at;
                while (at < line.size() && line[at] != separator_)
                    if (!is_space(line[at++]))
                        refuse(number, static_cast<int>(at), "something stands behind a quoted cell", "",
                               "quote the whole cell, or nothing of it");
            } else {
                const std::size_t end = std::min(line.find(separator_, at), line.size());
                cell.text = trimmed(line.substr(at, end - at));
                at = end;
            }
            cell.text = trimmed(std::string(cell.text));
            cells.push_back(std::move(cell));
            if (at >= line.size()) return cells;
            ++at;
        }
    }

    /// "[m/s]", "(m/s)" and "m/s" are one unit; "-" is none.
    static std::string bare_unit(std::string_view text) {
        text = trimmed(text);
        if (text.size() >= 2 && (text.front() == '[' || text.front() == '(')) {
            text.remove_prefix(1);
            if (text.back() == ']' || text.back() == ')') text.remove_suffix(1);
        }
        text = trimmed(text);
        return text == "-" ? "1" : std::string(text);
    }

    std::optional<double> plain(std::string text) const {
        if (separator_ != ',' && std::ranges::count(text, ',') == 1 && std::ranges::count(text, '.') == 0)
            text[text.find(',')] = '.';
        const char *begin = text.data(), *end = begin + text.size();
        if (begin != end && *begin == '+') ++begin;
        double value = 0.0;
        const auto [rest, error] = std::from_chars(begin, end, value);
        if (error != std::errc{} || rest != end) return {};
        return value;
    }

    bool is_line_of_units(const std::vector<LoggedCell>& cells) const {
        return std::ranges::none_of(cells, [&](const LoggedCell& c) { return plain(c.text).has_value(); }) &&
               std::ranges::any_of(cells, [](const LoggedCell& c) { return !c.text.empty(); });
    }

    std::optional<double> number_in(const LoggedCell& cell, int line) const {
        if (cell.text.empty()) return {};
        const std::optional<double> value = plain(cell.text);
        if (!value)
            refuse(line, cell.column, fmt::format("'{}' is not a number", cell.text), "",
                   "plain numbers, units behind the names or in the second line");
        if (std::isnan(*value)) return {};
        if (std::isinf(*value))
            refuse(line, cell.column, "an infinite number", "",
                   "leave the cell empty where nothing was measured");
        return value;
    }

    LoggedTable table_;
    char separator_ = ',';
    bool has_units_line_ = false;
};

}  // namespace

const LoggedColumn* LoggedTable::find(std::string_view name) const {
    const auto found = std::ranges::find(columns, name, &LoggedColumn::name);
    return found == columns.end() ? nullptr : &*found;
}

LoggedTable read_logged_table(std::string_view text, const std::string& file) {
    return LoggedReader(file).read(text);
}

namespace {

bool is_acceleration(std::string_view unit) {
    return unit == "m/s^2";
}

/// Factor of a column's unit to SI. Accelerometers count in standard gravities, which the units database
/// takes for grams.
double factor_of(const LoggedTable& table, const LoggedColumn& column, std::string_view si) {
    const std::string& unit = column.unit;
    if (unit.empty()) return 1.0;
    if (is_acceleration(si) && (unit == "g" || unit == "G" || unit == "g0")) return 9.80665;
    try {
        return to_si("1 " + unit, si);
    } catch (const UnitError& error) {
        throw SceneError({table.file, column.unit_line, column.unit_column}, "",
                         fmt::format("{}: {}", column.name, error.problem()), error.why(),
                         error.suggestion());
    }
}

const LoggedColumn& time_column(const LoggedTable& table) {
    for (const char* name : {"time", "t"})
        if (const LoggedColumn* column = table.find(name)) return *column;
    throw SceneError({table.file, table.head_line, 1}, "", "the column 'time' is missing",
                     "a history is read against it", "name it in the first line");
}

}  // namespace

std::vector<double> logged_times(const LoggedTable& table) {
    const LoggedColumn& column = time_column(table);
    const double factor = factor_of(table, column, "s");
    std::vector<double> times;
    for (std::size_t i = 0; i < column.values.size(); ++i) {
        const SourcePlace place{table.file, table.lines[i], column.column};
        if (!column.values[i])
            throw SceneError(place, "", "a line without a time", "",
                             "leave out a line that was not measured");
        const double time = *column.values[i] * factor;
        if (!times.empty() && !(time > times.back()))
            throw SceneError(place, "", "time does not rise",
                             fmt::format("{} s after {} s", time, times.back()),
                             "sort the lines by time, each once");
        times.push_back(time);
    }
    return times;
}

LoggedHistory logged_history(const LoggedTable& table, const std::vector<double>& times,
                             const LoggedColumn& column, std::string_view unit) {
    const double factor = factor_of(table, column, unit);
    LoggedHistory history;
    for (std::size_t i = 0; i < times.size(); ++i) {
        if (!column.values[i]) continue;
        history.time.push_back(times[i]);
        history.value.push_back(*column.values[i] * factor);
    }
    return history;
}

}  // namespace twinchute
