// A comparison against an earlier one. Expected values are the arithmetic of the definition: now minus
// before, over |before|.
#include "compare/trend.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "compare/report/trend_text.hpp"
#include "tests/support/compare_records.hpp"

namespace twinchute::compare {
namespace {

/// The full model's peak force was 5000 N.
Trend with_peak(double now, const std::map<std::string, Tolerance>& asked = {}) {
    Comparison today = synthetic_comparison();
    today.reference.add_metric("peak_force_N", now);
    return measure_trend(synthetic_comparison(), today, asked);
}

TEST(CompareTrend, NothingMovedIsWithin) {
    const Trend trend = with_peak(5000);
    EXPECT_TRUE(trend.changes.empty());
    EXPECT_EQ(trend.compared, 10u);  // five metrics of each
    EXPECT_EQ(trend.judged, 6u);     // three of each have a tolerance
    EXPECT_EQ(overall_verdict(trend), Verdict::within);
}

TEST(CompareTrend, MovedIsWhatMovedByMoreThanAMillionth) {
    EXPECT_TRUE(with_peak(5000 * (1 + 0.9e-6)).changes.empty());
    const Trend trend = with_peak(5000 * (1 + 1.1e-6));
    ASSERT_EQ(trend.changes.size(), 1u);
    EXPECT_EQ(trend.changes[0].key, "peak_force_N");
    EXPECT_EQ(trend.changes[0].fidelity, "full");
    EXPECT_NEAR(*trend.changes[0].relative, 1.1e-6, 1e-12);  // of a double of 5000
    EXPECT_EQ(trend.changes[0].verdict, Verdict::within);
}

TEST(CompareTrend, AJudgedMetricMayMoveByAThousandthUnlessSomebodySaysOtherwise) {
    EXPECT_EQ(overall_verdict(with_peak(5005)), Verdict::within);  // exactly at it
    EXPECT_EQ(overall_verdict(with_peak(4994.9)), Verdict::exceeded);
    EXPECT_EQ(overall_verdict(with_peak(4900, {{"peak_force", {0.02, true}}})), Verdict::within);
    EXPECT_EQ(overall_verdict(with_peak(4899, {{"peak_force", {100, false}}})), Verdict::exceeded);
    EXPECT_EQ(overall_verdict(with_peak(5001, {{"peak_force", {0, true}}})), Verdict::exceeded);
    EXPECT_NE(verdict_line(with_peak(6000))
                  .find("moved too far from the baseline: full peak_force (6 judged, 1 of 10"),
              std::string::npos);
}

TEST(CompareTrend, MostChangedComesFirstAndWhatCameOrWentBeforeAll) {
    Comparison before = synthetic_comparison(), now = synthetic_comparison();
    now.candidate.add_metric("peak_force_N", 4800 * 1.01);
    now.reference.add_metric("descent_rate_m_s", 7.7 * 0.5);
    now.reference.add_metric("load_factor", 3);
    before.candidate.add_metric("impulse_N_s", 3000);
    before.reference.add_metric("landing_east_m", 0);  // of zero there is no share
    now.reference.add_metric("landing_east_m", 0.5);
    const Trend trend = measure_trend(before, now, {{"landing_east", {1, false}}});
    std::vector<std::string> order;
    for (const MetricChange& change : trend.changes)
        order.push_back(change.key);
    EXPECT_EQ(order, (std::vector<std::string>{"impulse_N_s", "load_factor", "landing_east_m",
                                               "descent_rate_m_s", "peak_force_N"}));
    EXPECT_EQ(trend.changes[0].now, std::nullopt);
    EXPECT_EQ(trend.changes[1].before, std::nullopt);
    EXPECT_EQ(trend.changes[2].relative, std::nullopt);
    EXPECT_EQ(trend.changes[2].verdict, Verdict::within);
}

TEST(CompareTrend, AJudgedMetricThatIsGoneIsMissingAndANewOneHasNoPast) {
    Comparison before = synthetic_comparison();
    before.candidate.add_metric("snatch_force_N", 800);
    const Trend gone = measure_trend(before, synthetic_comparison(), {{"snatch_force", {0.1, true}}});
    EXPECT_EQ(gone.changes[0].verdict, Verdict::missing);
    EXPECT_EQ(overall_verdict(gone), Verdict::exceeded);
    EXPECT_NE(verdict_line(gone).find("rom snatch_force (gone)"), std::string::npos);
    const Trend came = measure_trend(synthetic_comparison(), before, {});
    EXPECT_EQ(overall_verdict(came), Verdict::within);
}

/// An earlier comparison against one whose two sides lack the descent rate.
Trend without_descent(bool not_reached, const std::map<std::string, Tolerance>& asked = {}) {
    Comparison now = synthetic_comparison();
    for (RunRecord* side : {&now.candidate, &now.reference}) {
        std::erase_if(side->metrics, [](const Metric& m) { return m.key == "descent_rate_m_s"; });
        if (not_reached) side->missing.push_back({"descent_rate_m_s", "the run stopped before", true});
    }
    now.gap = measure_gap(now.reference, now.candidate, {});
    return measure_trend(synthetic_comparison(), now, asked);
}

TEST(CompareTrend, ADefaultMetricThatIsGoneFromBothIsMissingUnlessTheStopCameBefore) {
    EXPECT_EQ(overall_verdict(without_descent(false)), Verdict::exceeded);
    EXPECT_NE(verdict_line(without_descent(false)).find("rom descent_rate (gone)"), std::string::npos);
    const Trend early = without_descent(true);
    EXPECT_EQ(overall_verdict(early), Verdict::within);
    EXPECT_NE(verdict_line(early).find("; not reached: rom descent_rate, full descent_rate"),
              std::string::npos)
        << verdict_line(early);
    EXPECT_EQ(early.changes[0].note, "the run stopped before");
    EXPECT_EQ(overall_verdict(without_descent(true, {{"descent_rate", {0.1, true}}})), Verdict::exceeded);
}

TEST(CompareTrend, AToleranceOnWhatNoRecordHasFails) {
    const Trend trend =
        measure_trend(synthetic_comparison(), synthetic_comparison(), {{"impulse", {0.1, true}}});
    EXPECT_EQ(overall_verdict(trend), Verdict::exceeded);
    EXPECT_EQ(trend.changes[0].key, "impulse_N_s");
    EXPECT_EQ(overall_verdict(measure_trend(synthetic_comparison(), synthetic_comparison(),
                                            {{"force_history", {0.1, true}}})),
              Verdict::exceeded);
}

TEST(CompareTrend, ABaselineHasToHaveWhatIsAskedOfIt) {
    Comparison before = synthetic_comparison();
    for (RunRecord* record : {&before.candidate, &before.reference})
        std::erase_if(record->metrics, [](const Metric& m) { return m.key == "descent_rate_m_s"; });
    const Comparison now = synthetic_comparison();
    EXPECT_EQ(overall_verdict(measure_trend(before, now, {})), Verdict::within);  // new
    const Trend asked = measure_trend(before, now, {{"descent_rate", {0.1, true}}});
    EXPECT_EQ(overall_verdict(asked), Verdict::exceeded);
    EXPECT_NE(verdict_line(asked).find("rom descent_rate (not in the baseline)"), std::string::npos);
}

TEST(CompareTrend, ABaselineThatNothingIsHeldAgainstFails) {
    Comparison before = synthetic_comparison(), now = synthetic_comparison();
    for (RunRecord* record : {&before.candidate, &before.reference, &now.candidate, &now.reference})
        record->metrics.clear();
    before.gap = measure_gap(before.reference, before.candidate, {});
    now.gap = measure_gap(now.reference, now.candidate, {});
    const Trend trend = measure_trend(before, now, {});
    EXPECT_EQ(trend.judged, 0u);
    EXPECT_EQ(overall_verdict(trend), Verdict::exceeded);
}

TEST(CompareTrend, AToleranceMayBeOnAParachutesOwnMetric) {
    Comparison before = synthetic_comparison();
    before.reference.add_metric("main_peak_force_N", 4000);
    before.candidate.add_metric("main_peak_force_N", 4000);
    Comparison now = before;
    now.reference.metrics.back().value = 4200;
    const auto verdict_of = [&](double tolerance) {
        return overall_verdict(measure_trend(before, now, {{"main_peak_force", {tolerance, true}}}));
    };
    EXPECT_EQ(verdict_of(0.06), Verdict::within);
    EXPECT_EQ(verdict_of(0.04), Verdict::exceeded);
}

TEST(CompareTrend, WhatTheBaselineJudgesIsMissedWhereItHasAnotherName) {
    // A drogue that is called otherwise now: its peak force was judged, and is gone.
    Comparison before = synthetic_comparison(), now = synthetic_comparison();
    for (RunRecord* record : {&before.candidate, &before.reference})
        record->add_metric("drogue_peak_force_N", 3000), record->events.push_back({"drogue.snatch", 1, 0, 0});
    for (RunRecord* record : {&now.candidate, &now.reference})
        record->add_metric("pilot_peak_force_N", 3000), record->events.push_back({"pilot.snatch", 1, 0, 0});
    before.gap = measure_gap(before.reference, before.candidate, {});
    now.gap = measure_gap(now.reference, now.candidate, {});
    const Trend trend = measure_trend(before, now, {});
    EXPECT_EQ(overall_verdict(trend), Verdict::exceeded);
    EXPECT_EQ(std::ranges::count_if(trend.changes,
                                    [](const MetricChange& change) {
                                        return change.key == "drogue_peak_force_N" &&
                                               change.verdict == Verdict::missing;
                                    }),
              2);
}

TEST(CompareTrend, WhatIsZeroButForRoundingHasNotMoved) {
    Comparison before = synthetic_comparison(), now = synthetic_comparison();
    for (Comparison* c : {&before, &now})
        c->candidate.channels.push_back({"altitude", "m", {300.0, 200.0}});
    before.candidate.add_metric("landing_east_m", 1e-17);
    now.candidate.add_metric("landing_east_m", 0.0);
    EXPECT_TRUE(measure_trend(before, now, {{"landing_east", {0.01, true}}}).changes.empty());
    now.candidate.add_metric("landing_east_m", 4e-7);  // of 300 m 1.3e-9
    EXPECT_EQ(overall_verdict(measure_trend(before, now, {{"landing_east", {0.01, true}}})),
              Verdict::exceeded);
}

TEST(CompareTrend, ARunThatBrokeOffIsNotJudged) {
    Comparison broken = synthetic_comparison();
    broken.reference.status = {StatusCode::energy_grew, "at 1 s"};
    broken.reference.add_metric("peak_force_N", 9000);
    const Trend trend = measure_trend(broken, synthetic_comparison(), {});
    EXPECT_EQ(trend.judged, 3u);                           // those of the other fidelity
    EXPECT_EQ(overall_verdict(trend), Verdict::exceeded);  // a gate with nothing to hold against is no gate
    EXPECT_EQ(trend.note, "full of the baseline ended as energy_grew");
    EXPECT_NE(verdict_line(trend).find(trend.note), std::string::npos);
}

TEST(CompareTrend, AnInputWithoutANumberHasNotMovedFromItself) {
    Comparison before = synthetic_comparison(), now = synthetic_comparison();
    const Input unknown{"parachute.porosity", std::nan(""), "", InputOrigin::given, ""};
    before.reference.inputs.push_back(unknown);
    now.reference.inputs.push_back(unknown);
    EXPECT_TRUE(measure_trend(before, now, {}).inputs.empty());
    now.reference.inputs.back().value = 0.1;
    EXPECT_EQ(measure_trend(before, now, {}).inputs.size(), 1u);
}

TEST(CompareTrend, KeysThatWereRenamedAreNoOtherInputs) {
    const auto named = [](const char* key) { return Input{key, 2.0, "N/m", InputOrigin::given, ""}; };
    const std::vector<Input> before{named("parachute.deploy.fold_resistance"),
                                    named("parachute.drogue.deploy.fold_resistance")};
    std::vector<Input> now{named("parachute.deploy.deployment_resistance"),
                           named("parachute.drogue.deploy.deployment_resistance")};
    EXPECT_TRUE(input_changes(before, now).empty());
    now.back().value = 3.0;
    ASSERT_EQ(input_changes(before, now).size(), 1u);
    EXPECT_EQ(input_changes(before, now)[0].before, "2 N/m");
}

TEST(CompareTrend, NamesInputsProgramAndMachineThatDiffer) {
    Comparison now = synthetic_comparison();
    now.reference.inputs[0].value = 160.0;
    now.reference.inputs.push_back(
        {"compare.tolerance.peak_force", std::string("5 %"), "", InputOrigin::given, ""});
    now.reference.inputs.erase(now.reference.inputs.begin() + 2);
    now.reference.provenance.compiler = "GNU 13";
    now.reference.provenance.host_cpu = "B <CPU>";
    const Trend trend = measure_trend(synthetic_comparison(), now, {});
    ASSERT_EQ(trend.inputs.size(), 2u);  // a tolerance is no input of a run
    EXPECT_EQ(trend.inputs[0].what, "payload.mass");
    EXPECT_EQ(trend.inputs[0].before, "152.4 kg");
    EXPECT_EQ(trend.inputs[0].now, "160 kg");
    EXPECT_EQ(trend.inputs[1].now, "");
    ASSERT_EQ(trend.model.size(), 1u);
    EXPECT_EQ(trend.model[0].now, "GNU 13");
    ASSERT_EQ(trend.machine.size(), 1u);
    const std::string text = trend_markdown(trend, "a|b", "<name>");
    EXPECT_NE(text.find("B &lt;CPU&gt;"), std::string::npos) << text;
    EXPECT_NE(text.find("- baseline: a\\|b\n"), std::string::npos) << text;
    EXPECT_TRUE(text.starts_with("# &lt;name&gt;, against a baseline\n\n**")) << text;
    EXPECT_NE(trend_terminal(trend, "old", {}).find("input     parachute.drag_area_law: ludtke -> absent\n"),
              std::string::npos);
}

}  // namespace
}  // namespace twinchute::compare
