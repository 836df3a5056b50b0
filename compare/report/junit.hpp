// The verdicts as JUnit XML, which every continuous-integration dashboard reads.
#pragma once

#include <string>

#include "compare/gap.hpp"
#include "compare/trend.hpp"

namespace twinchute::compare {

/// One test case for each run (an error when it did not end properly, a failure when a parachute never
/// opened), one for each metric and history of the gap (a failure when its tolerance is not met, skipped when
/// it is not judged) and, with a trend, one for the baseline as a whole and one for each judged metric that
/// moved.
std::string junit_xml(const Comparison& comparison, const Trend* trend = nullptr);

}  // namespace twinchute::compare
