// The server of the local page without its sockets: secrets, the page in one piece, runs in the background.
#include <gtest/gtest.h>

#include <chrono>
#include <set>
#include <thread>

#include "fullsim/fidelity.hpp"
#include "lib/scene/read_scene.hpp"
#include "rom/fidelity.hpp"
#include "serve/access.hpp"
#include "serve/page_files.hpp"
#include "serve/runs.hpp"

namespace twinchute::test {
namespace {

using namespace std::chrono_literals;
using serve::RunKind;
using serve::RunState;

Scene scene_with(std::vector<std::string> overrides) {
    return read_scene(TWINCHUTE_SOURCE_DIR "/data/scenes/c9-inflation.toml", overrides);
}

/// A fall of a quarter of an hour: minutes of run time on any machine.
Scene endless() {
    return scene_with({"release.height=6000", "stop.time=1000"});
}

const serve::Models models{fullsim::full_fidelity(), rom::rom_fidelity()};

TEST(ServeAccess, TokensAreLongAndNeverTheSame) {
    std::set<std::string> seen;
    for (int i = 0; i < 1000; ++i) {
        const std::string token = serve::new_token();
        EXPECT_EQ(token.size(), 32u);  // 128 bits, four a digit
        EXPECT_EQ(token.find_first_not_of("0123456789abcdef"), token.npos) << token;
        EXPECT_TRUE(seen.insert(token).second);
    }
}

TEST(ServeAccess, SecretsAreTheSameOrNot) {
    EXPECT_TRUE(serve::is_same_secret("abc", "abc"));
    EXPECT_TRUE(serve::is_same_secret("", ""));
    for (const char* other : {"", "ab", "abd", "bbc", "abcd", "ABC"})
        EXPECT_FALSE(serve::is_same_secret("abc", other)) << other;
}

/// A name of another file would be looked for on the server, which has none.
TEST(ServePage, StandsInOnePiece) {
    const std::string page = serve::page_html();
    EXPECT_TRUE(page.starts_with("<!DOCTYPE html>"));
    EXPECT_EQ(page.find("<script src="), page.npos);
    EXPECT_EQ(page.find("<link rel=\"stylesheet\""), page.npos);
}

TEST(ServeRuns, OneThatNobodyAsksForIsCancelled) {
    serve::BackgroundRun run("1", RunKind::full, endless(), models, 200ms);
    const auto begin = std::chrono::steady_clock::now();
    while (std::chrono::steady_clock::now() - begin < 600ms) {  // three times as long as its patience
        run.asked();
        std::this_thread::sleep_for(20ms);
    }
    EXPECT_EQ(run.state(), RunState::running);
    run.wait();
    EXPECT_EQ(run.state(), RunState::cancelled);
    EXPECT_NE(run.status().error.find("nobody has asked for it during 0.2 s"), std::string::npos);
    EXPECT_EQ(run.result()->reference.status.code, StatusCode::interrupted);
}

/// Studies say nothing of how far they are: whether somebody asks for one is looked at all the same.
TEST(ServeRuns, StudiesThatNobodyAsksForAreCancelled) {
    const study::StudyWork endless_study = [](const std::stop_token& stop, const auto&) {
        while (!stop.stop_requested())
            std::this_thread::sleep_for(1ms);
        return study::StudyResult{.json = "{}", .page = "", .interrupted = true};
    };
    serve::BackgroundRun run("1", RunKind::campaign, scene_with({}), models, 100ms, endless_study);
    run.wait();
    EXPECT_EQ(run.state(), RunState::cancelled);
    EXPECT_NE(run.status().error.find("nobody has asked for it during 0.1 s"), std::string::npos);
    EXPECT_EQ(run.study_result()->json, "{}");
    EXPECT_EQ(run.result(), nullptr);
}

TEST(ServeRuns, StudiesThatThrowHaveFailed) {
    serve::BackgroundRun run(
        "1", RunKind::calibrate, scene_with({}), models, 1h,
        [](const std::stop_token&, const auto&) -> study::StudyResult { throw std::runtime_error("why"); });
    run.wait();
    EXPECT_EQ(run.state(), RunState::failed);
    EXPECT_EQ(run.status().error, "why");
    EXPECT_EQ(run.study_result(), nullptr);
}

TEST(ServeRuns, DestroyedOnesEnd) {
    const auto begin = std::chrono::steady_clock::now();
    { const serve::BackgroundRun run("1", RunKind::compare, endless(), models, 1h); }
    EXPECT_LT(std::chrono::steady_clock::now() - begin, 5s);  // the run would go on
}

/// Watchers of a full run are told the beginning of its history, and its shapes are those of its
/// record.
TEST(ServeRuns, RowsAndShapesSoFarAreThoseOfTheRecord) {
    const Scene scene = scene_with(
        {"full.mesh.gore_columns=1", "full.mesh.gore_rows=4", "full.mesh.line_elements=4", "stop.time=1"});
    std::vector<WatchedRow> rows;
    std::vector<ShapeFrames> shapes;
    ShapeFrames last;
    twinchute::Run run;
    run.rows = [&](const WatchedRow& row) { rows.push_back(row); };
    run.frames = [&](ShapeFrames shape) { last = std::move(shape); };
    run.frames_so_far = [&](const ShapeFrames& shape) { shapes.push_back(shape); };
    const RunRecord record = models.full.run(scene, run);
    const std::vector<double>&time = record.find_channel("time")->values,
          &force = record.find_channel("force")->values, &speed = record.find_channel("speed")->values;
    // All but those that wait for their filter (5 ms) and the next check.
    ASSERT_GT(rows.size(), time.size() / 2);
    ASSERT_LT(rows.size(), time.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        EXPECT_EQ(rows[i].time, time[i]);
        EXPECT_EQ(rows[i].force, force[i]);
        EXPECT_EQ(rows[i].speed, speed[i]);
    }
    ASSERT_GT(shapes.size(), 3u);
    for (std::size_t i = 1; i < shapes.size(); ++i)
        EXPECT_GT(shapes[i].frames.back().time, shapes[i - 1].frames.back().time);
    EXPECT_EQ(shapes.back().triangles, last.triangles);
    EXPECT_EQ(shapes.back().frames,
              std::vector(last.frames.begin(),
                          last.frames.begin() + static_cast<std::ptrdiff_t>(shapes.back().frames.size())));
}

}  // namespace
}  // namespace twinchute::test
