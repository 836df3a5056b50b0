// Cases of a suite that are series: all of it is run, its rows are trends.
#pragma once

#include "compare/validate/case_scene.hpp"
#include "compare/validate/run_suite.hpp"

namespace twinchute::compare {

/// The rows of a series at one fidelity. With seeds every case is run with each, and its metrics are medians;
/// a model without structure has no seeds.
std::vector<RowResult> run_series(const ValidationCase& one, const CaseScene& scenes,
                                  const Fidelity& fidelity, const ValidationOptions& options);

}  // namespace twinchute::compare
