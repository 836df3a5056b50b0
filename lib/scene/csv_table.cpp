#include "lib/scene/csv_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "lib/scene/nearest.hpp"
#include "lib/scene/units.hpp"

namespace twinchute {
namespace {

struct Cell {
    std::string_view text;  ///< without blanks around it
    int column = 1;         ///< where it begins in its line
};

struct Line {
    int number = 0;
    std::vector<Cell> cells;
};

bool is_blank(char c) {
    return c == ' ' || c == '\t';
}

Line split(std::string_view text, int number) {
    Line line{number, {}};
    for (std::size_t begin = 0;;) {
        const std::size_t comma = std::min(text.find(',', begin), text.size());
        std::size_t first = begin, last = comma;
        while (first < last && is_blank(text[first]))
            ++first;
        while (last > first && is_blank(text[last - 1]))
            --last;
        line.cells.push_back({text.substr(first, last - first), static_cast<int>(first) + 1});
        if (comma == text.size()) return line;
        begin = comma + 1;
    }
}

std::vector<Line> lines_of(std::string_view text) {
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // a mark that spreadsheets write
    std::vector<Line> lines;
    while (!text.empty()) {
        const std::size_t feed = std::min(text.find('\n'), text.size());
        std::string_view line = text.substr(0, feed);
        if (line.ends_with('\r')) line.remove_suffix(1);
        lines.push_back(split(line, static_cast<int>(lines.size()) + 1));
        text.remove_prefix(std::min(feed + 1, text.size()));
    }
    return lines;
}

class Reader {
public:
    Reader(const std::string& file, std::span<const CsvColumn> known) : file_(file), known_(known) {}

    CsvTable read(std::string_view text, std::size_t fewest) {
        const std::vector<Line> lines = lines_of(text);
        if (lines.size() < 2)
            refuse({}, static_cast<int>(lines.size()) + 1, "is not a table",
                   "the first line names the columns, the second their units",
                   fmt::format("begin with e.g. {} and {}", known_[0].name, known_[0].unit));
        name_columns(lines[0]);
        read_units(lines[1]);
        for (std::size_t i = 2; i < lines.size(); ++i)
            read_values(lines[i]);
        const std::vector<double>& first = values_[first_column_];
        if (first.size() < fewest)
            refuse({}, static_cast<int>(lines.size()), "too few lines of numbers",
                   fewest == 1 ? "there is none"
                               : fmt::format("{} found, two are the fewest to go between", first.size()),
                   "add levels");
        CsvTable table;
        table.file = file_;
        for (std::size_t i = 0; i < columns_.size(); ++i)
            table.columns.emplace(columns_[i]->name, std::move(values_[i]));
        return table;
    }

private:
    [[noreturn]] void refuse(const Cell& cell, int line, std::string problem, std::string why,
                             std::string hint) const {
        throw SceneError({file_, line, cell.column}, "", std::move(problem), std::move(why), std::move(hint));
    }

    void name_columns(const Line& line) {
        std::vector<std::string_view> names;
        for (const CsvColumn& column : known_)
            names.push_back(column.name);
        for (const Cell& cell : line.cells) {
            const auto row = std::ranges::find(known_, cell.text, &CsvColumn::name);
            if (row == known_.end())
                refuse(cell, line.number, fmt::format("unknown column '{}'", cell.text), "",
                       suggest(cell.text, names));
            if (std::ranges::find(columns_, &*row) != columns_.end())
                refuse(cell, line.number, fmt::format("the column '{}' stands here twice", cell.text), "",
                       "keep one of the two");
            if (&*row == &known_[0]) first_column_ = columns_.size();
            columns_.push_back(&*row);
        }
        if (std::ranges::find(columns_, &known_[0]) == columns_.end())
            refuse(line.cells[0], line.number, fmt::format("the column '{}' is missing", known_[0].name), "",
                   "name it in the first line");
        values_.resize(columns_.size());
    }

    void require_cells(const Line& line) const {
        const std::size_t found = line.cells.size(), wanted = columns_.size();
        if (found == wanted) return;
        refuse(found < wanted ? line.cells.back() : line.cells[wanted], line.number,
               fmt::format("{} cells where the first line has {}", found, wanted), "",
               "every line has a cell for every column");
    }

    void read_units(const Line& line) {
        require_cells(line);
        for (std::size_t i = 0; i < columns_.size(); ++i) {
            try {
                factors_.push_back(to_si(fmt::format("1 {}", line.cells[i].text), columns_[i]->unit));
            } catch (const UnitError& error) {
                refuse(line.cells[i], line.number, fmt::format("{}: {}", columns_[i]->name, error.problem()),
                       error.why(), "the second line holds the units, one a column");
            }
        }
    }

    void read_values(const Line& line) {
        require_cells(line);
        for (std::size_t i = 0; i < columns_.size(); ++i) {
            const Cell& cell = line.cells[i];
            const CsvColumn& column = *columns_[i];
            const double value = number(cell, line.number) * factors_[i];
            if (!std::isfinite(value))
                refuse(cell, line.number, fmt::format("'{}' is not a finite number", cell.text), "",
                       "leave out a line that was not measured");
            if (!column.range.contains(value))
                refuse(cell, line.number,
                       fmt::format("{}: {} {} is out of range", column.name, value, column.unit),
                       allowed_text(Key{.path = column.name, .unit = column.unit, .range = column.range}),
                       "correct the value or its unit");
            if (i == first_column_ && !follows(values_[i], value, column.twice))
                refuse(cell, line.number, fmt::format("{} does not rise", column.name),
                       fmt::format("{} {} after {} {}", value, column.unit, values_[i].back(), column.unit),
                       fmt::format("sort the lines by {}, each once", column.name));
            values_[i].push_back(value);
        }
    }

    static bool follows(const std::vector<double>& before, double value, bool twice) {
        const std::size_t count = before.size();
        if (count == 0 || value > before.back()) return true;
        return twice && value == before.back() && !(count > 1 && before[count - 2] == value);
    }

    double number(const Cell& cell, int line) const {
        double value = 0.0;
        const char* last = cell.text.data() + cell.text.size();
        const auto [end, error] = std::from_chars(cell.text.data(), last, value);
        if (cell.text.empty())
            refuse(cell, line, "an empty cell", "", "leave out a line that was not measured");
        if (error == std::errc::result_out_of_range)
            refuse(cell, line, fmt::format("'{}' is not a finite number", cell.text), "", "correct it");
        if (error != std::errc{} || end != last)
            refuse(cell, line, fmt::format("'{}' is not a number", cell.text), "",
                   "plain numbers with a decimal point, units in the second line");
        return value;
    }

    const std::string& file_;
    std::span<const CsvColumn> known_;
    std::vector<const CsvColumn*> columns_;  ///< of the file, in its order
    std::vector<double> factors_;            ///< to SI
    std::vector<std::vector<double>> values_;
    std::size_t first_column_ = 0;
};

}  // namespace

CsvTable read_csv_table(std::string_view text, const std::string& file, std::span<const CsvColumn> known,
                        std::size_t fewest) {
    return Reader(file, known).read(text, fewest);
}

void refuse_columns(const std::string& file, std::string problem, std::string hint) {
    throw SceneError({file, 1, 1}, "", std::move(problem), "", std::move(hint));
}

}  // namespace twinchute
