// Text on a terminal.
#include <gtest/gtest.h>

#include <condition_variable>
#include <csignal>
#include <mutex>

#include "lib/cli/interrupt.hpp"
#include "lib/cli/progress.hpp"
#include "lib/cli/record_text.hpp"
#include "lib/cli/text.hpp"

namespace twinchute {
namespace {

TEST(CliText, NumbersHaveFourDigitsAndNoNoise) {
    EXPECT_EQ(readable(4951.7), "4952");
    EXPECT_EQ(readable(21), "21.00");
    EXPECT_EQ(readable(1.6249), "1.625");
    EXPECT_EQ(readable(0.01234567), "0.01235");
    EXPECT_EQ(readable(123456), "123456");
    EXPECT_EQ(readable(0.99999), "1.000");
    EXPECT_EQ(readable(0), "0.000");
    EXPECT_EQ(readable(-1e-7), "-1e-07");
}

TEST(CliText, NothingPrintedCanMoveTheCursor) {
    EXPECT_EQ(printable("a\x1b[2Jb\rc\nd\x7f"), "a?[2Jb?c?d?");
    EXPECT_EQ(printable("a\nb", Newlines::keep), "a\nb");
    EXPECT_EQ(printable("\xC2\x9B"
                        "31m"),
              "?31m");                             // CSI as one C1 control
    EXPECT_EQ(printable("\xC3\xA9"), "\xC3\xA9");  // an e with an accent stays
}

TEST(CliText, ColumnsAlignByCharactersNotBytes) {
    Table table{{"name", "x"}, {{"\xC3\xA9", "10"}, {"ab", "9"}}, {false, true}};
    EXPECT_EQ(aligned(table), "name   x\n\xC3\xA9     10\nab     9\n");
}

TEST(CliText, NoColourCodesUnlessAskedFor) {
    EXPECT_EQ(Style{}.paint("x", Colour::red), "x");
    EXPECT_EQ(Style{true}.paint("x", Colour::red), "\033[31mx\033[0m");
}

TEST(CliText, TimesReadInTheirOwnUnit) {
    EXPECT_EQ(time_text(3.4e-4), "340 us");
    EXPECT_EQ(time_text(12.34), "12.3 s");
    EXPECT_EQ(time_text(8.8e-8), "88 ns");
}

TEST(CliRecordText, ShowsFiguresWithUnitAndStanding) {
    RunRecord record;
    record.scene.name = "a scene";
    record.status = {StatusCode::not_finite, "node 7"};
    record.add_metric("snatch_speed_m_s", 21, MetricKind::input, "given");
    record.left_out = {{"line drag", "no table"}};
    const std::string text = record_text(record, "a model", {});
    EXPECT_NE(text.find("not_finite: node 7"), std::string::npos);
    EXPECT_NE(text.find("snatch speed  21.00  m/s  input  given"), std::string::npos);
    EXPECT_NE(text.find("left out  line drag (no table)"), std::string::npos);
    EXPECT_EQ(text.find("energy"), std::string::npos);  // there is no ledger in the record
}

TEST(CliProgress, EstimatesTheTimeLeft) {
    // A quarter done in 10 s: three quarters, 30 s, are left.
    EXPECT_EQ(progress_text("full", {"inflation", 1.5, 0.25}, 10),
              "full inflation       1.50 s   25 %   30 s left");
    EXPECT_EQ(progress_text("full", {"inflation", 0, 0}, 10), "full inflation       0.00 s    0 %");
}

TEST(CliProgress, CountsFromWhereARunWasGoneOnFrom) {
    // From a half to three quarters in 10 s: the last quarter takes as long.
    EXPECT_EQ(progress_text("full", {"descent", 6.0, 0.75, 4.25}, 10, 0.5),
              "full descent         6.00 s   75 %   10 s left   resumed at t = 4.25 s");
    EXPECT_EQ(progress_text("full", {"descent", 4.25, 0.5, 4.25}, 0.1, 0.5),
              "full descent         4.25 s   50 %   resumed at t = 4.25 s");
}

class CliInterrupt : public testing::TestWithParam<int> {};

TEST_P(CliInterrupt, ASignalRequestsTheStop) {
    std::mutex mutex;
    std::condition_variable_any stopped;
    const Interrupt interrupt;
    EXPECT_FALSE(interrupt.token().stop_requested());
    std::raise(GetParam());
    std::unique_lock lock(mutex);
    // Woken by the request itself; the time limit is only there to fail instead of hanging.
    stopped.wait_for(lock, interrupt.token(), std::chrono::seconds(20), [] { return false; });
    EXPECT_TRUE(interrupt.token().stop_requested());
}

INSTANTIATE_TEST_SUITE_P(Signals, CliInterrupt, testing::Values(SIGINT, SIGTERM));

TEST(CliInterruptEnd, HandlersAreGoneAfterwards) {
    { const Interrupt interrupt; }
    struct sigaction action {};
    ASSERT_EQ(sigaction(SIGINT, nullptr, &action), 0);
    EXPECT_EQ(action.sa_handler, SIG_DFL);
}

}  // namespace
}  // namespace twinchute
