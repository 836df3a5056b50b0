#include "compare/report/html_parts.hpp"

#include <fmt/format.h>

#include "compare/report/escape.hpp"

namespace twinchute::compare {

std::array<PageSide, 2> page_sides(const Comparison& comparison) {
    return {{{&comparison.candidate, &comparison.candidate_frames, "candidate"},
             {&comparison.reference, &comparison.reference_frames, "reference"}}};
}

PageClock page_clock(const Comparison& comparison) {
    PageClock clock;
    const auto sides = page_sides(comparison);
    for (const char* name : {"snatch", "line-stretch"}) {
        const Event* first = sides[0].record->find_event(name);
        const Event* second = sides[1].record->find_event(name);
        if (first == nullptr || second == nullptr) continue;
        return {{first->time, second->time}, true};
    }
    return clock;
}

std::string table_row(const std::vector<std::string>& cells) {
    std::string row = fmt::format("<tr><th scope=\"row\">{}</th>", cells.front());
    for (std::size_t i = 1; i < cells.size(); ++i)
        row += fmt::format("<td>{}</td>", cells[i]);
    return row + "</tr>\n";
}

std::string table_head(const std::vector<std::string>& cells, std::string_view alignment) {
    std::string head = "<thead><tr>";
    for (std::size_t i = 0; i < cells.size(); ++i)
        head += fmt::format("<th scope=\"col\"{}>{}</th>", alignment[i] == 'r' ? " class=\"number\"" : "",
                            xml_text(cells[i]));
    return head + "</tr></thead>\n";
}

std::string unit_for_reading(std::string_view unit) {
    std::string text(unit);
    if (const std::size_t at = text.find("^2"); at != text.npos) text.replace(at, 2, "\u00b2");
    return text;
}

std::string side_name(const PageSide& side) {
    return fmt::format(R"(<span class="side {}">{}</span>)", side.style, xml_text(side.record->fidelity));
}

}  // namespace twinchute::compare
