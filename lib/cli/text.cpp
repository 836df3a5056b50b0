#include "lib/cli/text.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "lib/record/display_units.hpp"

namespace twinchute {
namespace {

std::string_view escape_code(Colour colour) {
    switch (colour) {
        case Colour::none:
            return "";
        case Colour::bold:
            return "\033[1m";
        case Colour::dim:
            return "\033[2m";
        case Colour::red:
            return "\033[31m";
        case Colour::green:
            return "\033[32m";
        case Colour::yellow:
            return "\033[33m";
    }
    return "";
}

}  // namespace

std::string printable(std::string_view text, Newlines newlines) {
    std::string clean;
    clean.reserve(text.size());
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto byte = static_cast<unsigned char>(text[i]);
        const bool kept_newline = byte == '\n' && newlines == Newlines::keep;
        // C1 controls, U+0080..U+009F, are two bytes in UTF-8 and some terminals obey them.
        const bool c1 =
            byte == 0xC2 && i + 1 < text.size() && (static_cast<unsigned char>(text[i + 1]) & 0xE0) == 0x80;
        if (c1) {
            clean += '?';
            ++i;
        } else if ((byte < 0x20 && !kept_newline) || byte == 0x7F) {
            clean += '?';
        } else {
            clean += text[i];
        }
    }
    return clean;
}

std::size_t columns_of(std::string_view text) {
    std::size_t columns = 0;
    bool colour = false;  // inside a colour code of Style::paint
    for (const char c : text) {
        colour = colour || c == '\033';
        columns += !colour && (static_cast<unsigned char>(c) & 0xC0) != 0x80 ? 1 : 0;
        colour = colour && c != 'm';
    }
    return columns;
}

std::string readable(double value, int digits) {
    if (!std::isfinite(value)) return std::isnan(value) ? "nan" : value > 0 ? "inf" : "-inf";
    const double magnitude = std::abs(value);
    if (magnitude != 0 && (magnitude < 1e-4 || magnitude >= 1e9))
        return fmt::format("{:.{}g}", value, digits);
    // As many digits after the point as leave `digits` significant ones after rounding: 0.99999 is
    // 1.000, not 1.0000. Integers stay whole.
    const std::string scientific = fmt::format("{:.{}e}", magnitude, digits - 1);
    const int power = std::stoi(scientific.substr(scientific.find('e') + 1));
    std::string text = fmt::format("{:.{}f}", value, std::max(0, digits - 1 - power));
    if (text.find_first_not_of("-0.") == std::string::npos && text.starts_with('-')) text.erase(0, 1);
    return text;
}

std::string with_unit(double value, std::string_view si_unit, int digits) {
    return readable(shown(value, si_unit).value, digits) + spaced_unit(si_unit);
}

std::string Style::paint(std::string_view text, Colour wanted) const {
    if (!colour || wanted == Colour::none) return std::string(text);
    return fmt::format("{}{}\033[0m", escape_code(wanted), text);
}

Style output_style() {
    const char* no_colour = std::getenv("NO_COLOR");
    const char* terminal = std::getenv("TERM");
    const bool wanted = (no_colour == nullptr || *no_colour == '\0') &&
                        (terminal == nullptr || std::string_view(terminal) != "dumb");
    return {wanted && ::isatty(STDOUT_FILENO) == 1};
}

std::string aligned(const Table& table, const Style& style, std::size_t indent) {
    std::vector<std::size_t> widths;
    const auto measure = [&](const std::vector<std::string>& row) {
        widths.resize(std::max(widths.size(), row.size()), 0);
        for (std::size_t i = 0; i < row.size(); ++i)
            widths[i] = std::max(widths[i], columns_of(row[i]));
    };
    measure(table.header);
    for (const auto& row : table.rows)
        measure(row);

    std::string text;
    const auto append = [&](const std::vector<std::string>& row, Colour colour) {
        std::string line(indent, ' ');
        for (std::size_t i = 0; i < row.size(); ++i) {
            const std::string padding(widths[i] - columns_of(row[i]), ' ');
            const bool right = i < table.right.size() && table.right[i];
            if (i > 0) line += "  ";
            line += right ? padding + row[i] : row[i] + padding;
        }
        line.erase(line.find_last_not_of(' ') + 1);
        text += style.paint(line, colour) + '\n';
    };
    if (!table.header.empty()) append(table.header, Colour::bold);
    for (const auto& row : table.rows)
        append(row, Colour::none);
    return text;
}

}  // namespace twinchute
