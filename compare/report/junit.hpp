// The verdicts as JUnit XML, which every continuous-integration dashboard reads.
#pragma once

#include <string>

#include "compare/gap.hpp"

namespace twinchute::compare {

/// One test case for each run (an error when it did not end properly) and one for each judged
/// metric (a failure when its tolerance is not met). What is not judged is no test and does not appear.
std::string junit_xml(const Comparison& comparison);

}  // namespace twinchute::compare
