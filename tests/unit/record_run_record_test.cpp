// Names and look-ups of a record, and who made it.
#include <gtest/gtest.h>

#include <cstdlib>
#include <set>
#include <string>

#include "lib/record/run_record.hpp"

namespace twinchute {
namespace {

constexpr StatusCode all_codes[] = {
    StatusCode::completed,        StatusCode::stopped_by_event, StatusCode::interrupted,
    StatusCode::refused,          StatusCode::solver_failed,    StatusCode::step_too_small,
    StatusCode::not_finite,       StatusCode::strain_limit,     StatusCode::energy_grew,
    StatusCode::element_inverted, StatusCode::step_limit,       StatusCode::time_limit,
    StatusCode::not_opened,
};

TEST(RecordStatus, EveryEndingHasItsOwnName) {
    std::set<std::string_view> names;
    for (const StatusCode code : all_codes)
        names.insert(status_name(code));
    EXPECT_EQ(names.size(), std::size(all_codes));
    EXPECT_FALSE(names.contains("unknown"));
}

TEST(RecordStatus, FailuresAreTheOnesThatExitCode3StandsFor) {
    // The list in the table of exit codes.
    const std::set<std::string_view> listed{"solver_failed",    "not_finite",   "energy_grew",
                                            "element_inverted", "strain_limit", "step_too_small",
                                            "step_limit",       "time_limit"};
    for (const StatusCode code : all_codes) {
        EXPECT_EQ(is_numerical_failure(code), listed.contains(status_name(code))) << status_name(code);
    }
}

TEST(RecordLookup, FindsWhatIsThereAndNothingElse) {
    RunRecord record;
    record.add_metric("peak_force_N", 5000);
    record.events = {{"snatch", 0.5, 300, 21}};
    record.channels = {{"time", "s", {0, 1}}};
    EXPECT_EQ(record.metric("peak_force_N"), 5000);
    EXPECT_FALSE(record.metric("peak_force"));
    ASSERT_NE(record.find_event("snatch"), nullptr);
    EXPECT_EQ(record.find_event("snatch")->time, 0.5);
    EXPECT_EQ(record.find_event("ground"), nullptr);
    ASSERT_NE(record.find_channel("time"), nullptr);
    EXPECT_EQ(record.find_channel("force"), nullptr);
}

TEST(RecordLookup, AMetricStatedTwiceHasTheLaterValueOnce) {
    RunRecord record;
    record.add_metric("peak_force_N", 1, MetricKind::input, "a guess");
    record.add_metric("peak_force_N", 2);
    ASSERT_EQ(record.metrics.size(), 1u);
    EXPECT_EQ(record.metrics[0].value, 2);
    EXPECT_EQ(record.metrics[0].kind, MetricKind::result);
    EXPECT_TRUE(record.metrics[0].note.empty());
}

TEST(RecordProvenance, IsFilledIn) {
    const Provenance made = current_provenance();
    for (const std::string& text :
         {made.version, made.commit, made.compiler, made.flags, made.instruction_set, made.host_cpu}) {
        EXPECT_FALSE(text.empty());
    }
    // The options that decide about the bits have to be seen; warnings have not.
    EXPECT_NE(made.flags.find("-ffp-contract=off"), std::string::npos);
    EXPECT_EQ(made.flags.find("-Wall"), std::string::npos);
}

TEST(RecordProvenance, TheDateIsUtcAndCanBePinned) {
    ASSERT_EQ(setenv("SOURCE_DATE_EPOCH", "1000000000", 1), 0);
    EXPECT_EQ(current_provenance().date, "2001-09-09T01:46:40Z");  // the well-known billennium
    ASSERT_EQ(setenv("SOURCE_DATE_EPOCH", "nonsense", 1), 0);
    const std::string now = current_provenance().date;
    ASSERT_EQ(unsetenv("SOURCE_DATE_EPOCH"), 0);
    EXPECT_EQ(now.size(), std::string("2001-09-09T01:46:40Z").size());
    EXPECT_GT(now, "2024");
}

}  // namespace
}  // namespace twinchute
