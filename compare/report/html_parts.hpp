// Parts that report_html puts together, in the order of the page. Each part is one <section> with a heading,
// or empty where there is nothing to say. Foreign text in it is escaped.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "compare/gap.hpp"
#include "compare/ladder_beside.hpp"
#include "compare/render/table.hpp"

namespace twinchute::compare {

/// One of the two records, and the class that gives it its colour.
struct PageSide {
    const RunRecord* record;
    const ShapeFrames* frames;
    std::string_view style;  ///< "candidate" or "reference"
    Tone tone;
};
/// Candidate first, as in every table.
std::array<PageSide, 2> page_sides(const Comparison& comparison);

/// Squares and cubes as raised digits; a dash for none.
std::string unit_for_reading(std::string_view unit);
/// A name in the colour of its side.
std::string side_name(const PageSide& side);

std::string summary_section(const Comparison& comparison);      ///< verdict, key figures, metrics, cost
std::string histories_section(const Comparison& comparison);    ///< curves over one clock
std::string events_section_html(const Comparison& comparison);  ///< what happened when
std::string attribution_section(const Comparison& comparison);  ///< why the two differ
std::string energy_section_html(const Comparison& comparison);
std::string ladder_section(const LadderBeside& beside);  ///< error against run time, where there is a ladder
std::string canopy_section(const Comparison& comparison);  ///< the shape, moving and still
std::string notes_sections(
    const Comparison& comparison);  ///< left out, warnings, inputs, provenance, licences

/// The shape's frames in three dimensions as they are looked at from the side: an SVG of a few moments.
std::string canopy_still(const ShapeFrames& shape, const RunRecord& record, double clock_zero);

/// Data that the page's scripts draw, as JSON that may stand in a `<script>`.
std::string page_data(const Comparison& comparison);
/// The frames that a page has room for.
ShapeFrames page_frames(const ShapeFrames& shape);

}  // namespace twinchute::compare
