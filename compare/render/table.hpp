// A table as a model, built once by what has something to say, and one writer a format.
#pragma once

#include <concepts>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lib/cli/text.hpp"

namespace twinchute::compare {

/// Emphasis of a cell. Severities are colours on a terminal and chips with a sign in HTML; the others are
/// seen in HTML alone.
enum class Tone { plain, strong, quiet, code, candidate, reference, good, bad, missing, caution, open };

/// A coloured stretch of an HTML cell's track [%]; `style` is its class. No width: a mark.
struct Bar {
    std::string_view style;
    double left = 0.0;
    std::optional<double> width = {};
    bool operator==(const Bar&) const = default;
};

struct Cell {
    std::string text;  ///< raw: writers escape it; "-" stands for no value
    Tone tone = Tone::plain;
    std::string note = {};       ///< small print: in brackets in Markdown, none on a terminal and in CSV
    std::vector<Bar> bars = {};  ///< HTML alone
    std::string link = {};       ///< a path from the page; HTML alone

    Cell() = default;
    template <std::convertible_to<std::string_view> Text>
    Cell(const Text& words, Tone how = Tone::plain, std::string small = {})
        : text(std::string_view(words)), tone(how), note(std::move(small)) {}
    explicit Cell(std::vector<Bar> track) : bars(std::move(track)) {}
    bool operator==(const Cell&) const = default;
};

enum class Align { left, right };

struct Column {
    std::string title;
    Align align = Align::left;
    std::string unit = {};  ///< in brackets behind the title; in CSV in a line of its own
    bool drawn = false;     ///< its cells are bars: HTML alone has it
};

struct Table {
    std::vector<Column> columns;
    std::vector<std::vector<Cell>> rows;  ///< a first cell that is strong or quiet makes its whole row so

    /// Columns of words, aligned left, and of numbers, aligned right, all of one unit.
    void add_words(std::initializer_list<std::string_view> titles, std::string_view unit = {});
    void add_numbers(std::initializer_list<std::string_view> titles, std::string_view unit = {});
};

/// Aligned columns for a terminal; see twinchute::aligned.
std::string terminal_table(const Table& table, const Style& style, std::size_t indent = 0);

/// A line a row; empty where the table has no rows.
std::string markdown_table(const Table& table);

/// A line of titles, one of units, and one for each row.
std::string csv_table(const Table& table);

/// `caption` is HTML, `style` the table's class. With an `id` it scrolls by itself where a page is too
/// narrow.
std::string html_table(const Table& table, std::string_view caption, std::string_view style = {},
                       std::string_view id = {});

/// The inside of a table cell, for use elsewhere in a page.
std::string html_cell(const Cell& cell);

/// The shortest text of a number that reads back the same; empty where it is absent or not finite.
std::string exact(const std::optional<double>& value);

}  // namespace twinchute::compare
