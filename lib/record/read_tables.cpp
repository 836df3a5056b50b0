// history.csv and events.csv back into channels and events.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "lib/record/json_node.hpp"
#include "lib/record/record_parts.hpp"

namespace twinchute {
namespace {

constexpr std::size_t max_columns = 1024, max_events = 4096;

/// Line and column, both from 1.
struct Spot {
    int line = 0, column = 0;
};

struct Cell {
    std::string_view raw;  ///< as it stands; between the quotes where it is quoted
    bool quoted = false;
    bool last = false;  ///< of its line
    Spot place = {};    ///< where it begins

    std::string text() const {
        std::string plain(raw);
        if (quoted)
            for (std::size_t at = 0; (at = plain.find("\"\"", at)) != plain.npos; ++at)
                plain.erase(at, 1);
        return plain;
    }
};

/// Walks through the cells of a table (RFC 4180; lines end in LF or CR LF).
class Cells {
public:
    Cells(std::string_view text, const std::string& file) : text_(text), file_(file) {}

    bool at_end() const { return at_ == text_.size(); }
    std::size_t left() const { return text_.size() - at_; }
    int line() const { return line_; }
    Spot here() const { return {line_, column_of(at_)}; }

    [[noreturn]] void refuse(const Spot& place, const std::string& problem, const std::string& why = "",
                             const std::string& hint = "run the scene again") const {
        throw RecordError({file_, place.line, place.column}, problem, why, hint);
    }

    Cell next() {
        Cell cell;
        cell.place = here();
        if (at_ < text_.size() && text_[at_] == '"') {
            cell.quoted = true;
            cell.raw = quoted(cell.place);
        } else {
            const std::size_t begin = at_;
            while (at_ < text_.size() && text_[at_] != ',' && text_[at_] != '\n') {
                if (text_[at_] == '"') refuse(here(), "a quotation mark inside a cell");
                ++at_;
            }
            cell.raw = text_.substr(begin, at_ - begin);
            if (at_ < text_.size() && text_[at_] == '\n' && cell.raw.ends_with('\r'))
                cell.raw.remove_suffix(1);
        }
        if (text_.substr(at_).starts_with("\r\n")) ++at_;  // after a quotation mark
        if (at_ == text_.size()) refuse(here(), "ends within a line", "was it cut off?");
        if (text_[at_] == '\n') {
            cell.last = true;
            ++line_;
            line_begin_ = at_ + 1;
        } else if (text_[at_] != ',') {
            refuse(here(), "a cell goes on after its quotation mark");
        }
        ++at_;
        return cell;
    }

    /// The cells of a whole line.
    std::vector<Cell> line_of_cells() {
        std::vector<Cell> cells;
        do {
            cells.push_back(next());
            if (cells.size() > max_columns)
                refuse(cells.back().place, "too many columns", fmt::format("more than {}", max_columns));
        } while (!cells.back().last);
        return cells;
    }

private:
    int column_of(std::size_t at) const {
        return static_cast<int>(
                   std::min<std::size_t>(at - line_begin_, std::numeric_limits<int>::max() - 1)) +
               1;
    }

    std::string_view quoted(const Spot& begin_place) {
        const std::size_t begin = ++at_;
        for (;; ++at_) {
            if (at_ == text_.size()) refuse(begin_place, "a quotation mark that is not closed");
            if (text_[at_] == '\n') {
                ++line_;
                line_begin_ = at_ + 1;
            }
            if (text_[at_] != '"') continue;
            if (text_.substr(at_ + 1).starts_with('"'))
                ++at_;
            else
                return text_.substr(begin, at_++ - begin);
        }
    }

    std::string_view text_;
    const std::string& file_;
    std::size_t at_ = 0, line_begin_ = 0;
    int line_ = 1;
};

/// A number, or NaN for the empty cell of one that was not finite.
double number(const Cells& cells, const Cell& cell) {
    if (cell.raw.empty() && !cell.quoted) return std::numeric_limits<double>::quiet_NaN();
    double value = 0.0;
    const char* const last = cell.raw.data() + cell.raw.size();
    const auto [end, error] = std::from_chars(cell.raw.data(), last, value);
    if (cell.quoted || error == std::errc::invalid_argument || end != last)
        cells.refuse(cell.place, fmt::format("'{}' is not a number", shown(cell.raw)));
    if (error != std::errc{} || !std::isfinite(value))
        cells.refuse(cell.place, fmt::format("'{}' is not a finite number", shown(cell.raw)),
                     "one that is not finite is an empty cell");
    return value;
}

void require_width(const Cells& cells, const Cell& cell, std::size_t index, std::size_t columns) {
    if (cell.last == (index + 1 == columns)) return;
    cells.refuse(cell.place, cell.last ? "too few cells" : "too many cells",
                 fmt::format("the first line has {}", columns));
}

/// The names of the columns, each once, and below them their units, or none.
struct Header {
    std::vector<std::string> names, units;
};

Header read_header(Cells& cells, CsvHead head) {
    Header header;
    std::set<std::string> seen;
    for (const Cell& cell : cells.line_of_cells()) {
        std::string name = cell.text();
        if (!seen.insert(name).second)
            cells.refuse(cell.place, fmt::format("the column '{}' stands here twice", shown(name)));
        header.names.push_back(std::move(name));
    }
    if (head == CsvHead::names) return header;
    std::size_t index = 0;
    for (const Cell& cell : cells.line_of_cells()) {
        require_width(cells, cell, index++, header.names.size());
        header.units.push_back(cell.text());
    }
    return header;
}

}  // namespace

std::vector<Channel> read_history(std::string_view text, const std::string& file,
                                  const std::optional<ColumnUnits>& units) {
    Cells cells(text, file);
    Header header = read_header(cells, units ? CsvHead::names : CsvHead::names_and_units);
    const std::size_t columns = header.names.size();
    if (units)
        for (const std::string& name : header.names) {
            const auto unit = units->find(name);
            if (unit == units->end() && !name.empty())
                cells.refuse({1, 1}, fmt::format("the column '{}' has no unit", shown(name)),
                             "summary.json names those of a table without a line of them");
            header.units.push_back(unit == units->end() ? "" : unit->second);
        }
    if (columns == 1 && header.names[0].empty() && header.units[0].empty()) {  // a record without channels
        if (!cells.at_end()) cells.refuse(cells.here(), "numbers without a column");
        return {};
    }
    // A row takes at least a byte a column: what is reserved is bounded by the size of the text.
    const std::string_view rest = text.substr(text.size() - cells.left());
    const std::size_t rows =
        std::min(static_cast<std::size_t>(std::ranges::count(rest, '\n')), rest.size() / columns);
    std::vector<Channel> channels;
    for (std::size_t i = 0; i < columns; ++i) {
        if (header.names[i].empty()) cells.refuse({1, 1}, fmt::format("column {} has no name", i + 1));
        std::string& unit = header.units[i];
        channels.push_back({std::move(header.names[i]), unit == "1" ? "" : std::move(unit), {}});
        channels.back().values.reserve(rows);
    }
    while (!cells.at_end()) {
        for (std::size_t i = 0; i < columns; ++i) {
            const Cell cell = cells.next();
            require_width(cells, cell, i, columns);
            channels[i].values.push_back(number(cells, cell));
        }
    }
    return channels;
}

std::vector<Event> read_events(std::string_view text, const std::string& file, CsvHead head) {
    struct Column {
        std::string_view name, unit;
        double Event::*value;  ///< null: the name
    };
    constexpr std::array known{Column{"name", "-", nullptr}, Column{"time", "s", &Event::time},
                               Column{"altitude", "m", &Event::altitude},
                               Column{"speed", "m/s", &Event::speed}};
    Cells cells(text, file);
    const Header header = read_header(cells, head);
    for (const Column& column : known) {
        const auto found = std::ranges::find(header.names, column.name);
        if (found == header.names.end())
            cells.refuse({1, 1}, fmt::format("the column '{}' is missing", column.name));
        if (head == CsvHead::names) continue;  // without a line of units: those that are known
        const std::string& unit = header.units[static_cast<std::size_t>(found - header.names.begin())];
        if (unit != column.unit)
            cells.refuse({2, 1}, fmt::format("{} is in '{}'", column.name, shown(unit)),
                         fmt::format("'{}' is known", column.unit));
    }
    std::vector<Event> events;
    while (!cells.at_end()) {
        if (events.size() == max_events)
            cells.refuse(cells.here(), "too many events", fmt::format("more than {}", max_events));
        Event event;
        for (std::size_t i = 0; i < header.names.size(); ++i) {
            const Cell cell = cells.next();
            require_width(cells, cell, i, header.names.size());
            const auto column = std::ranges::find(known, header.names[i], &Column::name);
            if (column == known.end()) continue;  // of a later version
            if (column->value == nullptr)
                event.name = cell.text();
            else
                event.*(column->value) = number(cells, cell);
        }
        if (std::isnan(event.time)) cells.refuse({cells.line() - 1, 1}, "an event without a time");
        events.push_back(std::move(event));
    }
    return events;
}

}  // namespace twinchute
