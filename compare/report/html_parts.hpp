// Parts that report_html puts together, in the order of the page. Each part is one <section> with a heading,
// or empty where there is nothing to say. Foreign text in it is escaped.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "compare/gap.hpp"
#include "compare/ladder_beside.hpp"
#include "compare/render/table.hpp"
#include "compare/report/sides.hpp"

namespace twinchute::compare {

/// Squares and cubes as raised digits; a dash for none.
std::string unit_for_reading(std::string_view unit);
/// A name in the colour of its side.
std::string side_name(const PageSide& side);

std::string summary_section(const Comparison& comparison);  ///< verdict, key figures, metrics, cost
Table estimates_table(const RunRecord& record);             ///< peak force by formula
std::string record_summary(const PageSide& side);           ///< of a run alone: status, key figures, metrics
/// Curves over one clock, with the dots of a test where there is one.
std::string histories_section(const PageSides& sides, const DropTestHistories* test);
std::string events_section_html(const PageSides& sides);        ///< what happened when
std::string attribution_section(const Comparison& comparison);  ///< why the two differ
std::string energy_section_html(const PageSides& sides);
std::string ladder_section(const LadderBeside& beside);  ///< error against run time, where there is a ladder
std::string canopy_section(const PageSides& sides);      ///< the shape, moving and still
/// Before and after calibration; empty where the candidate is not calibrated.
std::string calibration_section(const Comparison& comparison);
std::string notes_sections(const PageSides& sides);  ///< left out, warnings, inputs, provenance, licences

/// The shape's frames in three dimensions as they are looked at from the side: an SVG of a few moments.
std::string canopy_still(const ShapeFrames& shape, const RunRecord& record, double clock_zero);

/// Data that the page's scripts draw, as JSON that may stand in a `<script>`.
std::string page_data(const PageSides& sides, const DropTestHistories* test);
/// The frames that a page has room for.
ShapeFrames page_frames(const ShapeFrames& shape);

}  // namespace twinchute::compare
