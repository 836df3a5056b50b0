// The tables of a comparison, built once for every format that shows them.
#pragma once

#include "compare/gap.hpp"
#include "compare/render/table.hpp"
#include "compare/report/sides.hpp"

namespace twinchute::compare {

/// The verdict with its severity, or "-".
Cell verdict_cell(Verdict verdict);

/// A row a metric: both values, their difference, tolerance and verdict.
Table metrics_table(const Comparison& comparison);
/// Notes of metrics and of their values, each once.
Table metric_notes_table(const Comparison& comparison);

/// A row a history: the L2 norm of the difference, by phase.
Table histories_table(const FidelityGap& gap);
/// A row a phase of a history, in every norm.
Table phases_table(const FidelityGap& gap);
/// A row a history that a test measured. The comparison has a test.
Table test_table(const Comparison& comparison);

/// Terms of the energy ledgers that are not zero on all sides; empty where no side keeps one.
Table energy_table(const PageSides& sides);
/// A row an event, in the order of EventPair.
Table events_table(const PageSides& sides);
/// Where the candidate is calibrated: the gap of metrics with a tolerance, before and after.
Table calibration_table(const Comparison& comparison);

/// Where filling is predicted: how far it hangs on the initial mouth.
Table filling_table(const PageSides& sides);
/// Physics that each side left out, and why.
Table left_out_table(const PageSides& sides);
Table warnings_table(const PageSides& sides);
Table inputs_table(const RunRecord& record);

}  // namespace twinchute::compare
