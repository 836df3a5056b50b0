// An attribution in words and as a table: what the terminal and Markdown have in common.
#pragma once

#include <string>
#include <vector>

#include "compare/gap.hpp"
#include "compare/render/table.hpp"

namespace twinchute::compare {

/// Share of the reference below which a gap is nothing to explain, and a term nothing to name or to draw.
constexpr double negligible = 1e-4;

/// The metric in the units chosen.
MetricAttribution shown_metric(MetricAttribution metric);

/// A sentence or two: how large the gap of a metric is, what makes most of it, and whether its terms may be
/// read at all. Not escaped.
std::string attribution_sentence(const MetricAttribution& metric, const Comparison& comparison);

/// From the candidate's values down to the reference's, a row an effect and a column a metric. Not escaped.
Table attribution_table(const Comparison& comparison);

/// How the table is to be read, and which seeds its scatter is of.
std::string attribution_legend(const Comparison& comparison);

/// Sentences on what a term switches, for effects whose title does not say it: "Line elasticity: off: ...".
/// Each once.
std::vector<std::string> attribution_details(const Attribution& attribution);

}  // namespace twinchute::compare
