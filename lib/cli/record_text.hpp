// A record for reading on a terminal.
#pragma once

#include <string>

#include "lib/cli/text.hpp"
#include "lib/record/run_record.hpp"

namespace twinchute {

/// Key figures with units and kind, events, energy, cost, warnings, what was left out.
/// `title`: of the fidelity, e.g. "reduced-order model".
std::string record_text(const RunRecord& record, std::string_view title, const Style& style);

/// Formulas beside the value that the run has for the same metric, a line each; what does not hold here is
/// greyed.
std::string estimates_text(const RunRecord& record, const Style& style);

/// E.g. "1.23 s wall, 14803 steps of 71 to 83 us, 88 ns per element-step".
std::string cost_text(const Cost& cost);

/// The assumption that weighs most and that nobody measures, beside every result: "fill constant
/// n = 4 (given: a source)". Empty when the scene gives the filling time itself.
std::string fill_constant_text(const RunRecord& record);

/// A predicted filling with its bracket, a line each. `whose`: in front of what each says, e.g. "rom: ".
std::string filling_text(const PredictedFilling& filling, std::string_view whose = {});

/// A line on what is not in the units chosen; empty in SI.
std::string units_text();

/// Factors on inputs by a calibration; empty where there is none. `whose`: as above.
std::string calibration_text(const RunRecord& record, std::string_view whose = {});
/// Answers of the run without them; empty where there is none.
std::string uncalibrated_text(const RunRecord& record);

/// [s] in the unit that reads best, e.g. "340 us", "12.3 s".
std::string time_text(double seconds);

/// "warning: what (why), suggestion", a line each; every line begins with `prefix`.
std::string warnings_text(const std::vector<Warning>& warnings, std::string_view prefix, const Style& style);

/// Colour of a status: green, yellow or red.
Colour status_colour(StatusCode code);

}  // namespace twinchute
