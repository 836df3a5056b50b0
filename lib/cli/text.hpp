// Text for a terminal: what may be printed there, colour, aligned columns, numbers for reading.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace twinchute {

enum class Newlines { escape, keep };

/// The text with control characters replaced by '?': a scene's name cannot move the cursor.
std::string printable(std::string_view text, Newlines newlines = Newlines::escape);

/// Number of columns that UTF-8 text takes, one per code point; colour codes take none.
std::size_t columns_of(std::string_view text);

/// A number with `digits` significant digits, without exponent where that reads better, e.g. "4952",
/// "0.0123".
std::string readable(double value, int digits = 4);

/// A value in SI as the units chosen show it, with its unit: "4952 N".
std::string with_unit(double value, std::string_view si_unit, int digits = 4);

enum class Colour { none, bold, dim, red, green, yellow };

/// Whether and how to colour.
struct Style {
    bool colour = false;
    std::string paint(std::string_view text, Colour colour) const;
};

/// Colour on standard output only if it is a terminal, TERM is not "dumb" and NO_COLOR is not set
/// (no-color.org).
Style output_style();

/// A table of words, for `list` and for reports.
struct Table {
    std::vector<std::string> header;
    std::vector<std::vector<std::string>> rows;
    std::vector<bool> right;  ///< by column: aligned right; missing: left
};

/// Aligned columns, two spaces apart, every line indented by `indent`; no spaces at line ends.
/// The last column is not padded.
std::string aligned(const Table& table, const Style& style = {}, std::size_t indent = 0);

}  // namespace twinchute
