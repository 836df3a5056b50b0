// Predicted over measured, both logarithmic, as SVG.
#pragma once

#include <string>

#include "compare/validate/run_suite.hpp"

namespace twinchute::compare {

/// The whole file: points with the standard uncertainty of each side, the line of equality, twice the scatter
/// of the experiment about it, and of the model about its bias. What is not positive is not drawn; with no
/// point left it says so. Text comes from a suite and is escaped.
std::string scatter_svg(const SuiteResult& suite, const GroupResult& group);

}  // namespace twinchute::compare
