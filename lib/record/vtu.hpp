// Unstructured grids as VTK reads them: one .vtu file a grid, and a .pvd file that gives grids their times.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace twinchute {

/// Numbers of each point or of each cell.
struct VtuArray {
    std::string name;    ///< with its unit, as a metric's key: "cable_tension_N"
    int components = 1;  ///< numbers of one point or cell, side by side in `values`
    std::variant<std::vector<float>, std::vector<double>, std::vector<std::int32_t>, std::vector<std::int8_t>>
        values;
};

/// VTK's numbers for the shapes of cells.
enum class VtuCell : std::uint8_t { vertex = 1, line = 3, triangle = 5 };

struct VtuGrid {
    std::string note;                        ///< for whoever opens the file in an editor; may be empty
    std::optional<double> time;              ///< [s]
    std::vector<double> points;              ///< [m] x, y, z of each point
    std::vector<std::int32_t> connectivity;  ///< points of the first cell, then those of the next
    std::vector<std::int32_t> offsets;       ///< where in `connectivity` each cell ends
    std::vector<VtuCell> cells;
    std::vector<VtuArray> point_data, cell_data;

    /// Points and cells of another grid with the same arrays, after those of this one.
    void append(const VtuGrid& other);
    void add_cell(VtuCell shape, std::span<const std::int32_t> of_points);
};

/// The text of a .vtu file: arrays inline in base64, little-endian whatever the machine. The same grid gives
/// the same bytes.
std::string vtu_text(const VtuGrid& grid);

/// A grid of a series, by the name of its file relative to the .pvd file.
struct PvdEntry {
    double time;  ///< [s]
    std::string file;
};

/// The text of a .pvd file.
std::string pvd_text(std::span<const PvdEntry> entries);

}  // namespace twinchute
