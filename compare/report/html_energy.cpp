// Where the energy went, as a table whose bars show what is large.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "compare/report/html_parts.hpp"
#include "lib/cli/text.hpp"

namespace twinchute::compare {
namespace {

struct Line {
    std::string_view name;
    double EnergyLedger::*term;
};
constexpr std::array lines{
    Line{"Work of gravity", &EnergyLedger::gravity_work},
    Line{"Work of drag", &EnergyLedger::drag_work},
    Line{"External work", &EnergyLedger::external_work},
    Line{"Change of structure", &EnergyLedger::ramp},
    Line{"Added mass, brought to speed", &EnergyLedger::added_mass},
    Line{"Damping", &EnergyLedger::damping},
    Line{"Kinetic, change", &EnergyLedger::kinetic},
    Line{"Elastic, change", &EnergyLedger::elastic},
};

double largest_of(const std::array<PageSide, 2>& sides) {
    double most = 0.0;
    for (const PageSide& side : sides)
        for (const Line& line : lines)
            if (side.record->energy && std::isfinite((*side.record->energy).*line.term))
                most = std::max(most, std::abs((*side.record->energy).*line.term));
    return most;
}

/// From the middle: to the right what is positive.
std::string bar(std::string_view style, double share) {
    const double width = 50 * std::min(1.0, std::abs(share));
    return fmt::format("<span class=\"bar {}\" style=\"left:{:.2f}%;width:{:.2f}%\"></span>", style,
                       share < 0 ? 50 - width : 50.0, width);
}

}  // namespace

std::string energy_section_html(const Comparison& comparison) {
    const auto sides = page_sides(comparison);
    if (!sides[0].record->energy && !sides[1].record->energy) return {};
    const double most = largest_of(sides);
    std::string text =
        "<section id=\"energy\"><h2>Energy</h2>\n<table class=\"bars\"><caption>Energy ledger from the start "
        "of each run "
        "to its end, in kJ; negative is what leaves the system.</caption>\n";
    text += table_head({"", sides[0].record->fidelity, sides[1].record->fidelity, "share of the largest"},
                       "lrrl");
    text += "<tbody>\n";
    for (const Line& line : lines) {
        std::vector<std::string> cells{std::string(line.name)};
        std::string bars;
        bool any = false;
        for (const PageSide& side : sides) {
            const double value = side.record->energy ? (*side.record->energy).*line.term : 0.0;
            const bool there = side.record->energy && value != 0.0;  // exactly zero: nothing behind it
            any = any || there;
            cells.push_back(there ? readable(1e-3 * value) : "\u2013");
            if (there && std::isfinite(value) && most > 0.0) bars += bar(side.style, value / most);
        }
        cells.push_back("<span class=\"track\" aria-hidden=\"true\">" + bars + "</span>");
        if (any) text += table_row(cells);
    }
    std::vector<std::string> residual{"Not accounted for"};
    for (const PageSide& side : sides)
        residual.push_back(side.record->energy && std::isfinite(side.record->energy->residual_fraction)
                               ? fmt::format("{:.2g} %", 100 * side.record->energy->residual_fraction)
                               : "\u2013");
    residual.emplace_back("<span class=\"quiet\">share of the work of drag</span>");
    text += table_row(residual) + "</tbody></table>\n";
    for (const PageSide& side : sides)
        if (!side.record->energy)
            text += fmt::format("<p class=\"quiet\">{} keeps no ledger.</p>\n", side_name(side));
    return text + "</section>\n";
}

}  // namespace twinchute::compare
