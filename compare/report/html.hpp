// A comparison, or a run, as one HTML page that needs nothing beside it: no network, no other file.
#pragma once

#include <string>
#include <string_view>

#include "compare/gap.hpp"
#include "compare/ladder_beside.hpp"

namespace twinchute::compare {

/// The text of report.html. It depends on nothing but the comparison and the ladder that lies beside it, so
/// that their files give the same page again.
std::string report_html(const Comparison& comparison, const LadderBeside& beside = {});

/// The page of a run alone, made of the same parts. `title`: of its model; `is_reference`: the colour that
/// the model has in a comparison.
std::string record_html(const RunRecord& record, const ShapeFrames& frames, std::string_view title,
                        bool is_reference);

}  // namespace twinchute::compare
