// One table in every format.
#include <gtest/gtest.h>

#include "compare/render/table.hpp"

namespace twinchute::compare {
namespace {

Table small_table() {
    return {{{"metric"}, {"value", Align::right, "N"}, {"verdict"}, {"share", Align::left, {}, true}},
            {{{"Force <|>", Tone::strong},
              {"12", Tone::plain, "a note"},
              {"within", Tone::good},
              Cell(std::vector{Bar{"bar up", 50.0, 12.5}, Bar{"end up", 4.0}})},
             {{"Speed, rate", Tone::quiet}, "-", {"exceeded", Tone::bad}, ""}}};
}

TEST(CompareTable, IsAlignedOnATerminal) {
    EXPECT_EQ(terminal_table(small_table(), {}),
              "metric       value [N]  verdict\n"
              "Force <|>           12  within\n"
              "Speed, rate          -  exceeded\n");
}

TEST(CompareTable, ColourChangesNoColumn) {
    Table table = small_table();
    std::swap(table.columns[1], table.columns[2]);
    for (std::vector<Cell>& row : table.rows)
        std::swap(row[1], row[2]);
    std::string painted = terminal_table(table, {true});
    EXPECT_NE(painted.find("\033[32mwithin\033[0m"), std::string::npos) << painted;
    EXPECT_NE(painted.find("\033[31mexceeded\033[0m"), std::string::npos) << painted;
    for (std::size_t at; (at = painted.find('\033')) != std::string::npos;)
        painted.erase(at, painted.find('m', at) - at + 1);
    EXPECT_EQ(painted, terminal_table(table, {}));
}

TEST(CompareTable, CannotMoveTheCursor) {
    Table table = small_table();
    table.columns[0].title = table.rows[0][0].text = "\033[2J\n";
    EXPECT_EQ(terminal_table(table, {}).find('\033'), std::string::npos);
}

TEST(CompareTable, InMarkdownNotesStandInBracketsAndDrawingsAreLeftOut) {
    EXPECT_EQ(markdown_table(small_table()),
              "| metric | value \\[N\\] | verdict |\n"
              "| --- | ---: | --- |\n"
              "| Force &lt;\\|&gt; | 12 (a note) | within |\n"
              "| Speed, rate | - | exceeded |\n");
    EXPECT_EQ(markdown_table({{{"metric"}}, {}}), "");
}

TEST(CompareTable, InCsvUnitsHaveALine) {
    Table table = small_table();
    table.columns.pop_back();
    for (std::vector<Cell>& row : table.rows)
        row.pop_back();
    EXPECT_EQ(csv_table(table),
              "metric,value,verdict\n,N,\nForce <|>,12,within\n\"Speed, rate\",-,exceeded\n");
}

TEST(CompareTable, InHtmlSeveritiesAreChipsAndBarsAreDrawn) {
    const std::string html = html_table(small_table(), "<em>All</em>", "metrics", "all");
    for (const char* part :
         {"aria-labelledby=\"all-caption\"", "<caption id=\"all-caption\"><em>All</em></caption>",
          "<th scope=\"col\" class=\"number\">value [N]</th>",
          "<tr class=\"judged\"><th scope=\"row\">Force &lt;|&gt;</th>",
          "<td class=\"number\">12<span class=\"note\">a note</span></td>",
          "<span class=\"chip within\"><span aria-hidden=\"true\">\u2713</span> within</span>",
          "<span class=\"bar up\" style=\"left:50.00%;width:12.50%\"></span>",
          "<span class=\"end up\" style=\"left:4.00%\"></span>",
          "<tr class=\"repeated\"><th scope=\"row\">Speed, rate</th><td class=\"number\">\u2013</td>"})
        EXPECT_NE(html.find(part), std::string::npos) << part << "\n" << html;
}

}  // namespace
}  // namespace twinchute::compare
