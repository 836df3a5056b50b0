// A run of some twenty seconds, killed a hundred times on its way.
#include <gtest/gtest.h>

#include "tests/support/killed_run.hpp"

namespace twinchute {
namespace {

TEST(ManyKills, AHundredLeaveTheRecordOfTheRunThatWasLeftAlone) {
    // The C-9 of the demo on its own mesh, released high enough to fall for two minutes, with noise and
    // fields.
    const ScratchDir here;
    here.write("scene.toml",
               "base = \"c9-inflation.toml\"\nrelease.height = \"2000 m\"\nstop.time = 110.0\n"
               "full.noise = { amplitude = 1e-4, seed = 3 }\nfull.checkpoint_interval = 0.05\n"
               "full.output_rate = 20\n");
    const auto words = [](const char* out) {
        return std::vector<std::string>{TWINCHUTE_PROGRAM, "full", "scene.toml", "--out", out,
                                        "--fields",        "0.5"};
    };
    const auto begin = std::chrono::steady_clock::now();
    const test::Ended whole = test::Process(words("whole"), here.path()).wait();
    const double takes = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    ASSERT_EQ(whole.code, 0) << whole.err;
    test::Ended ended;
    // A hundred lives of 0.6 % of the run on average: it cannot end before.
    const int killed =
        test::run_with_kills(words("killed"), here.path(), 100, 0.012 * takes, 20261122, &ended);
    EXPECT_EQ(killed, 100) << "the run ended before";
    ASSERT_EQ(ended.code, 0) << ended.err;
    EXPECT_EQ(test::record_files(here / "killed"), test::record_files(here / "whole"));
    const auto summary = nlohmann::json::parse(content_of(here / "killed/summary.json"));
    // A life that makes no checkpoint of its own leaves the one before: the next is its only trace.
    const std::size_t traces = summary["cost"]["resumed_at_s"].size();
    EXPECT_GT(traces, 10u);
    std::printf("a run of %.1f s, killed %d times, went on from %zu different checkpoints\n", takes, killed,
                traces);
}

}  // namespace
}  // namespace twinchute
