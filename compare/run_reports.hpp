// Reports of runs of one fidelity: a page for each, and what their series comes to.
#pragma once

#include "lib/cli/fidelity_command.hpp"

namespace twinchute::compare {

/// `is_reference`: the colour that the fidelity has in comparisons. It must outlive the result.
RunReports run_reports(const Fidelity& fidelity, bool is_reference);

}  // namespace twinchute::compare
