#include "lib/record/frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>

#include "lib/record/record_parts.hpp"

namespace twinchute {
namespace {

constexpr std::string_view magic = "TWCSHAPE";
constexpr std::uint32_t version = 1;
// Bounds of what is believed. A mesh of 120 000 triangles, the largest that we measure, has half as many
// nodes.
constexpr std::uint32_t max_elements = 4'000'000, max_frames = 10'000;
constexpr std::size_t largest_file = 256u << 20;
constexpr std::size_t head_of_frame = 6 * 8;  // time, corner, two steps

std::size_t packed_folds(std::size_t triangles) {
    return (triangles + 3) / 4;
}

/// Little-endian on every machine.
class Writer {
public:
    template <typename Word>
    void word(Word value) {
        for (std::size_t i = 0; i < sizeof value; ++i)
            bytes_ += static_cast<char>(static_cast<unsigned char>(value >> (8 * i)));
    }
    void number(double value) { word(std::bit_cast<std::uint64_t>(value)); }
    void text(std::string_view text) { bytes_ += text; }
    void reserve(std::size_t size) { bytes_.reserve(size); }
    std::string take() { return std::move(bytes_); }

private:
    std::string bytes_;
};

class Reader {
public:
    Reader(std::string_view bytes, const std::string& file) : bytes_(bytes), file_(file) {}

    [[noreturn]] void refuse(const std::string& problem, const std::string& why = {}) const {
        throw RecordError({file_}, problem, why, "run the scene again");
    }
    template <typename Word>
    Word word() {
        const std::string_view text = take(sizeof(Word));
        Word value = 0;
        for (std::size_t i = 0; i < sizeof value; ++i)
            value =
                static_cast<Word>(value | static_cast<Word>(static_cast<unsigned char>(text[i])) << (8 * i));
        return value;
    }
    std::uint32_t count(const char* what, std::uint32_t max) {
        const auto value = word<std::uint32_t>();
        if (value > max)
            refuse(fmt::format("has {} {}", value, what), fmt::format("at most {} are possible", max));
        return value;
    }
    std::uint32_t node(std::uint32_t nodes) {
        const auto value = word<std::uint32_t>();
        if (value >= nodes) refuse(fmt::format("names node {} of {}", value, nodes));
        return value;
    }
    double number(const char* what) {
        const double value = std::bit_cast<double>(word<std::uint64_t>());
        if (!std::isfinite(value)) refuse(fmt::format("holds a {} that is not finite", what));
        return value;
    }
    double length(const char* what) {
        const double value = number(what);
        if (value < 0.0) refuse(fmt::format("holds a {} below zero", what));
        return value;
    }
    std::string_view take(std::size_t size) {
        if (size > left()) refuse("ends too early", "was it cut off?");
        const std::string_view text = bytes_.substr(at_, size);
        at_ += size;
        return text;
    }
    std::size_t left() const { return bytes_.size() - at_; }

private:
    std::string_view bytes_;
    const std::string& file_;
    std::size_t at_ = 0;
};

void write_frame(Writer& out, const ShapeFrame& frame) {
    out.number(frame.time);
    for (const double place : frame.corner)
        out.number(place);
    out.number(frame.step);
    out.number(frame.stress_step);
    for (const std::uint16_t place : frame.place)
        out.word(place);
    for (const std::uint8_t stress : frame.stress)
        out.word(stress);
    for (std::size_t first = 0; first < frame.folds.size(); first += 4) {
        std::uint8_t four = 0;
        for (std::size_t i = first; i < std::min(first + 4, frame.folds.size()); ++i)
            four = static_cast<std::uint8_t>(four | static_cast<int>(frame.folds[i]) << (2 * (i - first)));
        out.word(four);
    }
}

ShapeFrame read_frame(Reader& in, const ShapeFrames& shape) {
    ShapeFrame frame;
    frame.time = in.number("time");
    if (!shape.frames.empty() && !(frame.time > shape.frames.back().time))
        in.refuse("holds frames that are not in the order of their times");
    for (double& place : frame.corner)
        place = in.number("place");
    frame.step = in.length("step");
    frame.stress_step = in.length("stress");
    const std::size_t triangles = shape.triangles.size();
    frame.place.resize(3 * static_cast<std::size_t>(shape.nodes));
    for (std::uint16_t& place : frame.place)
        place = in.word<std::uint16_t>();
    frame.stress.resize(triangles);
    for (std::uint8_t& stress : frame.stress)
        stress = in.word<std::uint8_t>();
    const std::string_view folds = in.take(packed_folds(triangles));
    frame.folds.resize(triangles);
    for (std::size_t i = 0; i < 4 * folds.size(); ++i) {
        const int two = static_cast<unsigned char>(folds[i / 4]) >> (2 * (i % 4)) & 3;
        if (two > (i < triangles ? static_cast<int>(FabricFolds::taut) : 0))
            in.refuse("holds a state of fabric that is not known");
        if (i < triangles) frame.folds[i] = static_cast<FabricFolds>(two);
    }
    return frame;
}

}  // namespace

ShapeFrame quantised(double time, std::span<const double> place, std::span<const double> stress,
                     std::vector<FabricFolds> folds) {
    assert(place.size() % 3 == 0 && stress.size() == folds.size());
    ShapeFrame frame;
    frame.time = time;
    double side = 0.0;
    for (std::size_t k = 0; k < 3 && k < place.size(); ++k) {
        double low = place[k], high = place[k];
        for (std::size_t i = k; i < place.size(); i += 3) {
            low = std::min(low, place[i]);
            high = std::max(high, place[i]);
        }
        frame.corner[k] = low;
        side = std::max(side, high - low);
    }
    frame.step = side / std::numeric_limits<std::uint16_t>::max();
    const double counts = frame.step > 0.0 ? 1.0 / frame.step : 0.0;
    frame.place.reserve(place.size());
    for (std::size_t i = 0; i < place.size(); ++i)
        frame.place.push_back(
            static_cast<std::uint16_t>(std::min(65535.0, (place[i] - frame.corner[i % 3]) * counts + 0.5)));
    double largest = 0.0;
    for (const double value : stress)
        largest = std::max(largest, value);
    frame.stress_step = largest / std::numeric_limits<std::uint8_t>::max();
    const double shares = frame.stress_step > 0.0 ? 1.0 / frame.stress_step : 0.0;
    frame.stress.reserve(stress.size());
    for (const double value : stress)
        frame.stress.push_back(
            static_cast<std::uint8_t>(std::min(255.0, std::max(0.0, value) * shares + 0.5)));
    frame.folds = std::move(folds);
    return frame;
}

std::size_t bytes_per_frame(const ShapeFrames& shape) {
    return head_of_frame + 6 * static_cast<std::size_t>(shape.nodes) + shape.triangles.size() +
           packed_folds(shape.triangles.size());
}

ShapeFrames thinned(const ShapeFrames& shape, std::size_t max_bytes) {
    const std::size_t there = shape.frames.size();
    const std::size_t wanted = std::max<std::size_t>(2, max_bytes / bytes_per_frame(shape));
    if (there <= wanted) return shape;
    ShapeFrames fewer{shape.nodes, shape.payload, shape.triangles, shape.cables, {}};
    for (std::size_t i = 0; i < wanted; ++i)
        fewer.frames.push_back(shape.frames[i * (there - 1) / (wanted - 1)]);
    return fewer;
}

std::string frames_bytes(const ShapeFrames& shape) {
    Writer out;
    out.reserve(64 + 12 * shape.triangles.size() + 9 * shape.cables.size() +
                shape.frames.size() * bytes_per_frame(shape));
    out.text(magic);
    const auto count = [](const auto& list) { return static_cast<std::uint32_t>(list.size()); };
    for (const std::uint32_t value : {version, shape.nodes, count(shape.triangles), count(shape.cables),
                                      count(shape.frames), shape.payload})
        out.word(value);
    for (const auto& triangle : shape.triangles)
        for (const std::uint32_t node : triangle)
            out.word(node);
    for (const ShapeCable& cable : shape.cables) {
        out.word(cable.node[0]);
        out.word(cable.node[1]);
        out.word(static_cast<std::uint8_t>(cable.kind));
    }
    for (const ShapeFrame& frame : shape.frames)
        write_frame(out, frame);
    return out.take();
}

ShapeFrames read_frames_bytes(std::string_view bytes, const std::string& file) {
    Reader in(bytes, file);
    if (bytes.size() > largest_file)
        in.refuse("is too large", fmt::format("more than {} MiB", largest_file >> 20));
    if (!bytes.starts_with(magic)) in.refuse("does not hold frames", "it begins with something else");
    in.take(magic.size());
    if (const auto found = in.word<std::uint32_t>(); found != version)
        throw RecordError({file}, fmt::format("has version {} of the format", found),
                          fmt::format("this program reads {}", version),
                          "read it with the version that wrote it");
    ShapeFrames shape;
    shape.nodes = in.count("nodes", max_elements);
    const std::uint32_t triangles = in.count("triangles", max_elements),
                        cables = in.count("cables", max_elements), frames = in.count("frames", max_frames);
    shape.payload = in.node(shape.nodes);
    // Before anything is allocated: what is promised must be there.
    const std::size_t size =
        12 * std::size_t{triangles} + 9 * std::size_t{cables} +
        frames * (head_of_frame + 6 * std::size_t{shape.nodes} + triangles + packed_folds(triangles));
    if (in.left() < size) in.refuse("ends too early", "was it cut off?");
    if (in.left() > size) in.refuse("goes on after its last frame");
    shape.triangles.resize(triangles);
    for (auto& triangle : shape.triangles)
        for (std::uint32_t& node : triangle)
            node = in.node(shape.nodes);
    shape.cables.reserve(cables);
    for (std::uint32_t i = 0; i < cables; ++i) {
        const std::uint32_t from = in.node(shape.nodes), to = in.node(shape.nodes);
        const auto kind = in.word<std::uint8_t>();
        if (kind >= shape_cable_kinds)
            in.refuse(fmt::format("names a kind of cable that is not known: {}", kind));
        shape.cables.push_back({{from, to}, static_cast<ShapeCableKind>(kind)});
    }
    shape.frames.reserve(frames);
    for (std::uint32_t i = 0; i < frames; ++i)
        shape.frames.push_back(read_frame(in, shape));
    return shape;
}

ShapeFrames read_frames(const std::filesystem::path& directory) {
    const std::filesystem::path file = directory / "frames.bin";
    std::error_code error;
    if (!std::filesystem::exists(std::filesystem::status(file, error))) return {};
    return read_frames_bytes(read_record_file(file, largest_file), file.string());
}

}  // namespace twinchute
