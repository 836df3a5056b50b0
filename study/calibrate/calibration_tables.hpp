// Tables of a calibration, each built once for every format.
#pragma once

#include "compare/render/table.hpp"
#include "study/calibrate/calibration.hpp"

namespace twinchute::study {

compare::Table parameters_table(const Calibration& calibration);
compare::Table fits_table(const Calibration& calibration);
compare::Table bands_table(const Calibration& calibration);
compare::Table correlation_table(const Calibration& calibration);

/// "parachute.fill_time.n and parachute.drag_area are closely correlated (-0.97): ...", a sentence each.
std::vector<std::string> remarks_of(const Calibration& calibration);

}  // namespace twinchute::study
