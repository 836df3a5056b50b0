// Patterns as drawings at true scale.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "fullsim/pattern/gore_pattern.hpp"

namespace twinchute::fullsim {

struct Paper {
    std::string_view name, label;
    double width, height;  ///< [mm]
};
inline constexpr Paper papers[] = {{"a4", "A4", 210.0, 297.0}, {"letter", "Letter", 215.9, 279.4}};

/// Words of a drawing.
struct PatternNotes {
    std::string title;
    int gores = 0;
    std::vector<std::string> parts;  ///< lines of the list of parts; for paper alone
    const Paper* paper = papers;     ///< that a PDF file is printed on
};

/// Words on a piece: "C-9, main, gore: 1 of 28, seam allowance 15 mm, true scale".
std::string piece_label(const GorePattern& pattern, const PatternPiece& piece, const PatternNotes& notes);

/// Height of letters [mm] with which a label fits along its piece: at most 20 mm.
double letter_height(const PatternPiece& piece, const std::string& label);

/// Smallest rectangle around all pieces [m].
struct Extent {
    PatternPoint low, high;
};
Extent extent_of(const GorePattern& pattern);

/// A unit is a mm. Lines have the ids cut, sew, panels, marks, grain, with "-2" behind them for the second of
/// several pieces and so on.
std::string pattern_svg(const GorePattern& pattern, const PatternNotes& notes);

/// DXF R12, in mm: layers CUT, SEW, PANELS, MARKS, GRAIN and TEXT.
std::string pattern_dxf(const GorePattern& pattern, const PatternNotes& notes);

/// Tiles to print and join, after a sheet with a square to measure, the plan of the tiles and the list of
/// parts. Throws std::runtime_error where libharu fails.
std::string pattern_pdf(const GorePattern& pattern, const PatternNotes& notes);

}  // namespace twinchute::fullsim
