// Tables that suites draw on: reference values, canopy types, and recordings of tests.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lib/record/run_record.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::compare {

/// A CSV file whose first line that does not begin with '#' names the columns; cells are text.
struct ReferenceTable {
    std::string file;
    std::vector<std::string> names;
    std::vector<std::vector<std::string>> lines;  ///< each with a cell for every name
    std::vector<int> numbers;                     ///< of these lines in the file, from 1

    std::optional<std::size_t> column(std::string_view name) const;
    /// The number in a cell; nothing where it is empty or does not begin with one ("8 (reefed 6)" is 8).
    std::optional<double> number(std::size_t line, std::size_t column) const;
};

/// Throws SceneError with file and line.
ReferenceTable read_reference_table(std::string_view text, const std::string& file);

/// Row of the table of canopy types for one type, as "key=value" for a scene: fill constant, drag coefficient
/// and projected diameter (the middle of their ranges), and the exponent of the drag-area law. Nothing where
/// the type, or its fill constant or drag coefficient, is not in it.
std::optional<std::vector<std::string>> canopy_type_keys(const ReferenceTable& types, std::string_view type);

/// A recording of a test as the history of a record: columns time, and force, height (above the ground of the
/// scene) or speed (downward), with a line of units. Throws SceneError with file, line and column.
RunRecord read_recording(std::string_view text, const std::string& file, const Scene& scene);

}  // namespace twinchute::compare
