#include "compare/report/html_parts.hpp"

namespace twinchute::compare {

std::string unit_for_reading(std::string_view unit) {
    std::string text(unit);
    if (const std::size_t at = text.find("^2"); at != text.npos) text.replace(at, 2, "\u00b2");
    if (const std::size_t at = text.find("^3"); at != text.npos) text.replace(at, 2, "\u00b3");
    if (text.empty()) return "-";
    return text;
}

std::string side_name(const PageSide& side) {
    return html_cell({side.record->fidelity, side.tone});
}

}  // namespace twinchute::compare
