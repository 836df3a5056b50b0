#include "compare/render/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "compare/render/escape.hpp"
#include "lib/record/record_csv.hpp"

namespace twinchute::compare {
namespace {

/// Colour on a terminal; class and sign of a chip in HTML. A sign as well: colour alone tells too few.
struct Severity {
    Colour colour = Colour::none;
    std::string_view style = {}, sign = {};
};

Severity severity_of(Tone tone) {
    switch (tone) {
        case Tone::good:
            return {Colour::green, "within", "\u2713"};
        case Tone::bad:
            return {Colour::red, "exceeded", "\u2717"};
        case Tone::missing:
            return {Colour::red, "exceeded", "?"};
        case Tone::caution:
            return {Colour::yellow, "unjudged", "!"};
        case Tone::open:
            return {Colour::none, "unjudged", "\u2013"};
        default:
            return {};
    }
}

std::string heading(const Column& column) {
    return column.unit.empty() ? column.title : column.title + " [" + column.unit + "]";
}

std::string track(const std::vector<Bar>& bars) {
    std::string text = "<span class=\"track\" aria-hidden=\"true\">";
    for (const Bar& bar : bars)
        text += fmt::format("<span class=\"{}\" style=\"left:{:.2f}%{}\"></span>", bar.style, bar.left,
                            bar.width ? fmt::format(";width:{:.2f}%", *bar.width) : "");
    return text + "</span>";
}

/// "<th scope=...>": the first cell of a row names it.
std::string html_row(const std::vector<Cell>& cells, const std::vector<Column>& columns) {
    const Tone tone = cells.front().tone;
    std::string text = fmt::format("<tr{}>", tone == Tone::strong  ? " class=\"judged\""
                                             : tone == Tone::quiet ? " class=\"repeated\""
                                                                   : "");
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const std::string_view tag = i == 0 ? "th" : "td";
        text += fmt::format(
            "<{0}{1}>{2}</{0}>", tag,
            i == 0                             ? " scope=\"row\""
            : columns[i].align == Align::right ? " class=\"number\""
                                               : "",
            columns[i].drawn && cells[i].text.empty() ? track(cells[i].bars) : html_cell(cells[i]));
    }
    return text + "</tr>\n";
}

}  // namespace

void Table::add_words(std::initializer_list<std::string_view> titles, std::string_view unit) {
    for (const std::string_view title : titles)
        columns.push_back({std::string(title), Align::left, std::string(unit)});
}

void Table::add_numbers(std::initializer_list<std::string_view> titles, std::string_view unit) {
    for (const std::string_view title : titles)
        columns.push_back({std::string(title), Align::right, std::string(unit)});
}

std::string terminal_table(const Table& table, const Style& style, std::size_t indent) {
    twinchute::Table lines;
    for (const Column& column : table.columns) {
        if (column.drawn) continue;
        lines.header.push_back(printable(heading(column)));
        lines.right.push_back(column.align == Align::right);
    }
    for (const std::vector<Cell>& row : table.rows) {
        std::vector<std::string>& cells = lines.rows.emplace_back();
        for (std::size_t i = 0; i < row.size(); ++i)
            if (!table.columns[i].drawn)
                cells.push_back(style.paint(printable(row[i].text), severity_of(row[i].tone).colour));
    }
    return aligned(lines, style, indent);
}

std::string markdown_table(const Table& table) {
    if (table.rows.empty()) return {};
    std::string titles = "|", rule = "|", text;
    for (const Column& column : table.columns) {
        if (column.drawn) continue;
        titles += " " + markdown_text(heading(column)) + " |";
        rule += column.align == Align::right ? " ---: |" : " --- |";
    }
    for (const std::vector<Cell>& row : table.rows) {
        text += "|";
        for (std::size_t i = 0; i < row.size(); ++i)
            if (!table.columns[i].drawn)
                text += " " + markdown_text(row[i].text) +
                        (row[i].note.empty() ? "" : " (" + markdown_text(row[i].note) + ")") + " |";
        text += "\n";
    }
    return titles + "\n" + rule + "\n" + text;
}

std::string csv_table(const Table& table) {
    std::string titles, units, text;
    for (const Column& column : table.columns) {
        const char* separator = &column == &table.columns.front() ? "" : ",";
        titles += separator + csv_field(column.title);
        units += separator + csv_field(column.unit);
    }
    for (const std::vector<Cell>& row : table.rows)
        for (const Cell& cell : row)
            text += (&cell == &row.front() ? '\n' : ',') + csv_field(cell.text);
    return titles + "\n" + units + text + "\n";
}

std::string html_cell(const Cell& cell) {
    std::string text = cell.text == "-" ? "\u2013" : xml_text(cell.text);
    if (const Severity severity = severity_of(cell.tone); !severity.style.empty())
        text = fmt::format(R"(<span class="chip {}"><span aria-hidden="true">{}</span> {}</span>)",
                           severity.style, severity.sign, text);
    else if (cell.tone == Tone::code)
        text = "<code>" + text + "</code>";
    else if (cell.tone == Tone::candidate || cell.tone == Tone::reference)
        text = fmt::format(R"(<span class="side {}">{}</span>)",
                           cell.tone == Tone::candidate ? "candidate" : "reference", text);
    if (!cell.link.empty()) text = fmt::format("<a href=\"{}\">{}</a>", xml_text(cell.link), text);
    if (!cell.note.empty()) text += "<span class=\"note\">" + xml_text(cell.note) + "</span>";
    return text;
}

std::string html_table(const Table& table, std::string_view caption, std::string_view style,
                       std::string_view id) {
    std::string text;
    if (!id.empty())
        text = fmt::format(
            "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-labelledby=\"{}-caption\">\n", id);
    text += fmt::format("<table{}><caption{}>{}</caption>\n<thead><tr>",
                        style.empty() ? "" : fmt::format(" class=\"{}\"", style),
                        id.empty() ? "" : fmt::format(" id=\"{}-caption\"", id), caption);
    for (const Column& column : table.columns)
        text +=
            fmt::format("<th scope=\"col\"{}>{}</th>",
                        column.align == Align::right ? " class=\"number\"" : "", xml_text(heading(column)));
    text += "</tr></thead>\n<tbody>\n";
    for (const std::vector<Cell>& row : table.rows)
        text += html_row(row, table.columns);
    return text + "</tbody></table>" + (id.empty() ? "\n" : "</div>\n");
}

std::string exact(const std::optional<double>& value) {
    return value && std::isfinite(*value) ? fmt::format("{}", *value) : std::string();
}

}  // namespace twinchute::compare
