// Where the energy went, as a table whose bars show what is large.
#include <fmt/format.h>

#include "compare/report/gap_tables.hpp"
#include "compare/report/html_parts.hpp"

namespace twinchute::compare {

std::string energy_section_html(const PageSides& sides) {
    const Table ledger = energy_table(sides);
    if (ledger.rows.empty()) return {};
    std::string text = "<section id=\"energy\"><h2>Energy</h2>\n" +
                       html_table(ledger,
                                  "Energy ledger from the start of each run to its end; negative is what "
                                  "leaves the system. Bars: share of the largest.",
                                  "bars");
    for (const PageSide& side : sides)
        if (!side.record->energy)
            text += fmt::format("<p class=\"quiet\">{} keeps no ledger.</p>\n", side_name(side));
    return text + "</section>\n";
}

}  // namespace twinchute::compare
