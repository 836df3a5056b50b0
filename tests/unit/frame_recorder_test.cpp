// When frames of a full run are taken, and what is in them.
#include <gtest/gtest.h>

#include "fullsim/run/frames.hpp"

namespace twinchute::fullsim {
namespace {

/// One triangle with legs of 1 m and a line to the payload, 2 m below; a static line of one cable from corner
/// 0.
class FrameRecorderTest : public testing::Test {
protected:
    FrameRecorderTest() {
        mesh_.position = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, -2}};
        mesh_.canopy_nodes = 3;
        mesh_.triangles = {{{0, 1, 2}, 0, 1.0, 0.0, 1.0}};
        mesh_.cables = {{{0, 3}, 2.0, 1.0, CableKind::line}};
        mesh_.fabric.youngs_modulus = 2e8;
        mesh_.fabric.thickness = 1e-4;
        mesh_.fabric.poisson_ratio = 0.0;
        mesh_.fabric.density = 500.0;
        mesh_.static_line.position = {{0, 0, 5}};
        mesh_.static_line.mass = {0.0};
        mesh_.static_line.cables = {{{0, mesh_.first_static_line_node()}, 5.0, 1.0, CableKind::static_line}};
    }
    State at(double time, double stretch = 1.0) const {
        State state;
        state.time = time;
        for (const Vec3& x : mesh_.position)
            state.node.push_back({to_lanes(Vec3(stretch * x.x(), x.y(), x.z())), splat(0.0)});
        state.node.emplace_back();  // the dummy
        for (const Vec3& x : mesh_.static_line.position)
            state.node.push_back({to_lanes(x), splat(0.0)});
        return state;
    }
    static std::vector<double> times(const ShapeFrames& shape) {
        std::vector<double> all;
        for (const ShapeFrame& frame : shape.frames)
            all.push_back(frame.time);
        return all;
    }

    Mesh mesh_;
};

TEST_F(FrameRecorderTest, StretchedFabricHasItsStress) {
    FrameRecorder recorder(mesh_, true);
    recorder.begin(0.0, {0.1, 10});
    recorder.observe(at(0.0, 1.02));
    recorder.accept();
    const ShapeFrames shape = recorder.finish();
    ASSERT_EQ(shape.frames.size(), 1u);
    // Uniaxial Green strain of a stretch of 1.02 times E t = 2e4 N/m (no cross contraction).
    EXPECT_NEAR(shape.frames[0].stress_step * shape.frames[0].stress[0], 2e4 * 0.5 * (1.02 * 1.02 - 1), 1e-6);
    EXPECT_EQ(shape.payload, 3u);
    // The static line's anchor comes after the payload: the dummy has no place.
    EXPECT_EQ(shape.nodes, 5u);
    EXPECT_TRUE((shape.cables[1] == ShapeCable{{0, 4}, ShapeCableKind::static_line}));
    const auto z = [&](std::size_t node) {
        return shape.frames[0].corner[2] + shape.frames[0].step * shape.frames[0].place[3 * node + 2];
    };
    EXPECT_NEAR(z(4), 5.0, shape.frames[0].step);
    EXPECT_NEAR(z(3), -2.0, shape.frames[0].step);
}

TEST_F(FrameRecorderTest, AStaticLineThatHasLetGoIsAPointAtTheApex) {
    FrameRecorder recorder(mesh_, true);
    recorder.begin(0.0, {0.1, 10});
    const State state = at(0.0);
    mesh_.static_line = {};
    recorder.observe(state);
    recorder.accept();
    const ShapeFrame frame = recorder.finish().frames.at(0);
    for (std::size_t k = 0; k < 3; ++k)
        EXPECT_EQ(frame.place[3 * 4 + k], frame.place[k]);
}

TEST_F(FrameRecorderTest, ALongStretchIsThinnedAndItsIntervalDoubles) {
    FrameRecorder recorder(mesh_, true);
    recorder.begin(0.0, {0.1, 4});
    for (int i = 0; i <= 100; ++i) {  // 10 s in steps of 0.1 s
        recorder.observe(at(0.1 * i));
        recorder.accept();
    }
    recorder.begin(10.05, {0.1, 4});
    recorder.observe(at(10.06));
    recorder.accept();
    const ShapeFrames shape = recorder.finish();
    // Every 0.1, 0.2 ... 3.2 s: the first interval with which no more than four are there at the end; then
    // the new stretch's own.
    const std::vector<double> expected{0.0, 3.2, 6.4, 9.6, 10.06};
    ASSERT_EQ(shape.frames.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i)
        EXPECT_NEAR(shape.frames[i].time, expected[i], 1e-9);
}

TEST_F(FrameRecorderTest, WhatACheckFindsUnsoundIsDropped) {
    FrameRecorder recorder(mesh_, true);
    recorder.begin(0.0, {0.1, 10});
    recorder.observe(at(0.0));
    recorder.accept();
    recorder.observe(at(0.1));
    recorder.forget();
    recorder.accept();
    EXPECT_EQ(times(recorder.finish()), std::vector<double>{0.0});
}

TEST_F(FrameRecorderTest, TakesNothingThatNobodyWants) {
    FrameRecorder recorder(mesh_, false);
    recorder.begin(0.0, {0.1, 10});
    EXPECT_FALSE(recorder.frame_is_due(1e9));
    EXPECT_TRUE(recorder.finish().empty());
}

}  // namespace
}  // namespace twinchute::fullsim
