// The moving shape of a structure, quantised for drawing: frames.bin (docs/guide/frames.md).
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lib/record/record_error.hpp"

namespace twinchute {

/// Kind of a cable of a shape; files hold its number.
enum class ShapeCableKind : std::uint8_t { radial, skirt, vent, line, riser, static_line, vent_line };
constexpr std::uint8_t shape_cable_kinds = 7;

/// Whether a triangle of fabric carries in no direction, in one or in both.
enum class FabricFolds : std::uint8_t { slack, wrinkled, taut };

struct ShapeCable {
    std::array<std::uint32_t, 2> node;
    ShapeCableKind kind;

    bool operator==(const ShapeCable&) const = default;
};

/// One instant. A place is corner + step * count, a stress stress_step * count.
struct ShapeFrame {
    double time = 0.0;                 ///< [s] since release
    std::array<double, 3> corner{};    ///< [m] x east, y north, z up
    double step = 0.0;                 ///< [m] the same along each axis
    double stress_step = 0.0;          ///< [N/m]
    std::vector<std::uint16_t> place;  ///< x, y, z of each node
    std::vector<std::uint8_t> stress;  ///< first principal stress resultant of each triangle
    std::vector<FabricFolds> folds;    ///< of each triangle

    bool operator==(const ShapeFrame&) const = default;
};

struct ShapeFrames {
    std::uint32_t nodes = 0;
    std::uint32_t payload = 0;  ///< its node
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<ShapeCable> cables;
    std::vector<ShapeFrame> frames;  ///< in the order of their times

    bool empty() const { return frames.empty(); }
    bool operator==(const ShapeFrames&) const = default;
};

/// Quantises an instant: `place` [m] as x, y, z of each node, `stress` [N/m] of each triangle, all finite.
/// A place is off by at most half of 1/65535 of the longest side of the box around all nodes, a stress by
/// half of 1/255 of the largest one; a stress below zero counts as zero.
ShapeFrame quantised(double time, std::span<const double> place, std::span<const double> stress,
                     std::vector<FabricFolds> folds);

/// [bytes] that each frame takes in a file.
std::size_t bytes_per_frame(const ShapeFrames& shape);

/// Returns the shape with so few frames that they take at most `max_bytes`, evenly chosen, first and last
/// always among them.
ShapeFrames thinned(const ShapeFrames& shape, std::size_t max_bytes);

/// The content of frames.bin.
std::string frames_bytes(const ShapeFrames& shape);

/// Back again, to the same bits. `file` stands for it in messages. Throws RecordError for everything that
/// frames_bytes does not write.
ShapeFrames read_frames_bytes(std::string_view bytes, const std::string& file);

/// frames.bin of a record's directory; empty where there is none. Throws RecordError.
ShapeFrames read_frames(const std::filesystem::path& directory);

}  // namespace twinchute
