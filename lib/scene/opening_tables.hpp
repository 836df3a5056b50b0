// Filling times, growing drag areas, drag areas by attitude or Mach number and points of a test as a CSV file
// gives them.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lib/models/attitude_drag.hpp"
#include "lib/models/calibration.hpp"
#include "lib/models/drag_area.hpp"
#include "lib/models/fill_time.hpp"
#include "lib/models/mach_drag.hpp"

namespace twinchute {

/// Columns fill_fraction and drag_area_ratio; see DragAreaTable. `file` stands for it in messages, `name` is
/// what a scene calls it. Throws SceneError.
DragAreaTable read_drag_area_table(std::string_view text, const std::string& file, const std::string& name);

/// Columns froude_number or mass_ratio, and fill_constant. Throws SceneError.
CalibrationTable read_calibration_table(std::string_view text, const std::string& file,
                                        const std::string& name);
FillTable read_fill_table(std::string_view text, const std::string& file, const std::string& name);

/// Columns angle and drag_area; see AttitudeDrag. Throws SceneError.
AttitudeDrag read_attitude_drag(std::string_view text, const std::string& file, const std::string& name);

/// Columns mach_number and drag_area_factor; see MachDrag. Throws SceneError.
MachDrag read_mach_drag(std::string_view text, const std::string& file, const std::string& name);

/// Points of a test, in columns that are named as the metrics x and y. Throws SceneError.
std::pair<std::vector<double>, std::vector<double>> read_test_points(std::string_view text,
                                                                     const std::string& file,
                                                                     const std::string& x,
                                                                     const std::string& y);

}  // namespace twinchute
