// Shapes quantised, written, read, and refused.
#include <gtest/gtest.h>

#include <cmath>

#include "lib/record/frames.hpp"
#include "lib/record/write_record.hpp"
#include "tests/support/scratch_dir.hpp"

namespace twinchute {
namespace {

/// Five nodes, two triangles, a line to the payload; `frames` instants.
ShapeFrames small_shape(int frames) {
    ShapeFrames shape{5, 4, {{0, 1, 2}, {2, 1, 3}}, {{{0, 4}, ShapeCableKind::line}}, {}};
    for (int i = 0; i < frames; ++i) {
        const double z = 300.0 - i;
        const std::vector<double> place{0, 0, z, 1, 0, z, 0, 1, z + 0.1 * i, 1, 1, z, 0.5, 0.5, z - 7};
        shape.frames.push_back(quantised(0.1 * i, place, std::vector{10.0 * i, 5.0},
                                         {FabricFolds::taut, FabricFolds::wrinkled}));
    }
    return shape;
}

std::string refusal(std::string_view bytes) {
    try {
        read_frames_bytes(bytes, "frames.bin");
    } catch (const RecordError& error) {
        return error.what();
    }
    return "";
}

/// The bytes with a little-endian word put at a place.
std::string changed(std::string bytes, std::size_t at, std::uint32_t value) {
    for (int i = 0; i < 4; ++i)
        bytes[at + static_cast<std::size_t>(i)] = static_cast<char>(value >> (8 * i));
    return bytes;
}

TEST(Frames, AreOffByNoMoreThanHalfACount) {
    // The longest side is 40 m, the largest stress 900 N/m: the bounds that frames.hpp gives.
    const std::vector<double> place{-12.3, 4, 100, 7.7, 5, 140, 0.123456, 4.2, 111.11};
    const std::vector<double> stress{900, 123.4, -5};
    const ShapeFrame frame = quantised(1.5, place, stress, std::vector(3, FabricFolds::slack));
    EXPECT_DOUBLE_EQ(frame.step, 40.0 / 65535);
    for (std::size_t i = 0; i < place.size(); ++i)
        EXPECT_NEAR(frame.corner[i % 3] + frame.step * frame.place[i], place[i],
                    0.5 * frame.step * (1 + 1e-9))
            << i;
    EXPECT_NEAR(frame.stress_step * frame.stress[0], 900, 1e-9);
    EXPECT_NEAR(frame.stress_step * frame.stress[1], 123.4, 0.5 * 900 / 255);
    EXPECT_EQ(frame.stress[2], 0);  // nothing below zero
}

TEST(Frames, OfAPointWithoutStressAreThatPoint) {
    const ShapeFrame frame = quantised(0, std::vector{1.0, 2.0, 3.0}, std::vector{0.0}, {FabricFolds::slack});
    EXPECT_EQ(frame.step, 0);
    EXPECT_EQ(frame.corner, (std::array{1.0, 2.0, 3.0}));
    EXPECT_EQ(frame.stress, std::vector<std::uint8_t>{0});
}

TEST(Frames, AreReadAsTheyWereWritten) {
    for (const int count : {0, 1, 7}) {
        const ShapeFrames shape = small_shape(count);
        const std::string bytes = frames_bytes(shape);
        // Head, 12 bytes a triangle, 9 a cable: docs/guide/frames.md.
        EXPECT_EQ(bytes.size(), 32u + 2 * 12 + 9 + static_cast<std::size_t>(count) * bytes_per_frame(shape));
        EXPECT_EQ(bytes_per_frame(shape), 48u + 5 * 6 + 2 + 1);
        EXPECT_TRUE(read_frames_bytes(bytes, "f") == shape) << count;
    }
}

TEST(Frames, CutOffAnywhereAreRefused) {
    const std::string bytes = frames_bytes(small_shape(2));
    for (std::size_t size = 0; size < bytes.size(); ++size)
        EXPECT_NE(refusal(std::string_view(bytes).substr(0, size)), "") << size;
    EXPECT_EQ(refusal(bytes), "");
    EXPECT_NE(refusal(bytes + "x").find("goes on after its last frame"), std::string::npos);
}

TEST(Frames, ThatLieAreRefusedWithTheReason) {
    const std::string bytes = frames_bytes(small_shape(2));
    const std::size_t triangles = 32, cables = triangles + 24, frame = cables + 9;
    struct Lie {
        std::size_t at;
        std::uint32_t value;
        const char* reason;
    };
    const Lie lies[] = {
        {0, 0, "does not hold frames"},
        {8, 2, "version 2"},
        {12, 4'000'001, "4000001 nodes"},
        {16, 4'000'000, "ends too early"},  // promised, not there: nothing is allocated for it
        {24, 0xffffffff, "4294967295 frames"},
        {28, 5, "names node 5 of 5"},
        {triangles, 5, "names node 5 of 5"},
        {cables + 4, 0x80000000, "names node 2147483648 of 5"},
        {cables + 8, 7, "kind of cable"},
        {frame + 4, 0x7ff80000, "time that is not finite"},
        {frame + 4, 0x40000000, "order of their times"},  // 2 s before 0.1 s
        {frame + 32 + 4, 0xbff00000, "step below zero"},
        {frame + 78 + 2 - 1, 0x03030303, "state of fabric"},
    };
    for (const Lie& lie : lies)
        EXPECT_NE(refusal(changed(bytes, lie.at, lie.value)).find(lie.reason), std::string::npos)
            << lie.reason << ": " << refusal(changed(bytes, lie.at, lie.value));
}

TEST(Frames, ThinnedKeepFirstAndLast) {
    const ShapeFrames shape = small_shape(100);
    const ShapeFrames fewer = thinned(shape, 10 * bytes_per_frame(shape) + 1);
    ASSERT_EQ(fewer.frames.size(), 10u);
    for (std::size_t i = 0; i < 10; ++i)  // 99 steps in 9 equal parts
        EXPECT_TRUE(fewer.frames[i] == shape.frames[11 * i]) << i;
    EXPECT_TRUE(thinned(shape, 1 << 20) == shape);
    EXPECT_EQ(thinned(shape, 0).frames.size(), 2u);
}

TEST(Frames, GoWithTheRecordAndAreReadFromItsDirectory) {
    const ScratchDir here;
    const ShapeFrames shape = small_shape(3);
    EXPECT_TRUE(read_frames(here.path()).empty());
    write_record({}, here / "r", shape);
    EXPECT_TRUE(read_frames(here / "r") == shape);
    write_record({}, here / "r");  // a record without a shape takes the old one away
    EXPECT_EQ(tree_of(here / "r"), (std::set<std::string>{"summary.json", "history.csv", "events.csv"}));
    std::filesystem::create_directory(here / "r/frames.bin");
    EXPECT_THROW(read_frames(here / "r"), RecordError);
}

}  // namespace
}  // namespace twinchute
