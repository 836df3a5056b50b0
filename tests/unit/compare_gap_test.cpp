// Verdicts of a comparison. Expected values are the arithmetic of the definition: candidate minus
// reference against a tolerance that is a share of |reference| or a value in the metric's unit.
#include "compare/gap.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "lib/record/metrics.hpp"
#include "lib/scene/keys.hpp"
#include "tests/support/compare_records.hpp"

namespace twinchute::compare {
namespace {

using Tolerances = std::map<std::string, Tolerance>;

RunRecord with_peak(std::optional<double> peak) {
    RunRecord record;
    record.fidelity = "x";
    if (peak) record.add_metric("peak_force_N", *peak);
    return record;
}

const MetricGap* find(const FidelityGap& gap, std::string_view name) {
    const auto metric =
        std::ranges::find_if(gap.metrics, [&](const MetricGap& m) { return m.row->name == name; });
    return metric == gap.metrics.end() ? nullptr : &*metric;
}

Verdict peak_verdict(std::optional<double> reference, std::optional<double> candidate,
                     const Tolerances& asked) {
    const FidelityGap gap = measure_gap(with_peak(reference), with_peak(candidate), asked);
    const MetricGap* metric = find(gap, "peak_force");
    if (metric == nullptr) throw std::logic_error("no row");
    return metric->verdict;
}

TEST(CompareMetrics, NameUnitAndKeyOfEachRowBelongTogether) {
    for (const MetricRow& row : judgeable_rows()) {
        EXPECT_EQ(find_judgeable_row(row.name), &row) << "twice: " << row.name;
        EXPECT_EQ(find_metric_row(row.name), row.is_history() ? nullptr : &row) << row.name;
        if (row.is_history()) {
            EXPECT_EQ(row.name, std::string(row.key) + "_history");
            EXPECT_EQ(row.tolerance_unit(), "1") << "a relative norm: " << row.name;
        } else {
            EXPECT_EQ(split_metric_key(row.key).name, row.name);
            EXPECT_EQ(split_metric_key(row.key).unit, row.unit) << row.name;
        }
    }
    EXPECT_EQ(find_metric_row("max_deceleration")->tolerance_unit(), "g0");
    EXPECT_EQ(find_metric_row("peak_force")->tolerance_unit(), "N");
    EXPECT_EQ(find_metric_row("load_factor")->tolerance_unit(), "1");
}

TEST(CompareMetrics, ThreeMetricsAreJudgedByDefaultWithinTenPercent) {
    std::vector<std::string_view> judged;
    for (const MetricRow& row : metric_rows()) {
        if (!row.tolerance) continue;
        EXPECT_TRUE(row.tolerance->relative && row.tolerance->value == 0.1) << row.name;
        judged.push_back(row.name);
    }
    EXPECT_EQ(judged, (std::vector<std::string_view>{"filling_time", "peak_force", "descent_rate"}));
}

TEST(CompareVerdict, RelativeToTheReference) {
    EXPECT_EQ(peak_verdict(100, 109, {}), Verdict::within);
    EXPECT_EQ(peak_verdict(100, 91, {}), Verdict::within);
    EXPECT_EQ(peak_verdict(100, 111, {}), Verdict::exceeded);
    // 10 of 109 is less than 10 % of the candidate, but more than 10 % of the reference.
    EXPECT_EQ(peak_verdict(99, 109, {}), Verdict::exceeded);
    EXPECT_EQ(peak_verdict(-100, -109, {}), Verdict::within);  // a share of the size, whatever the sign
}

TEST(CompareVerdict, ExactlyAtTheToleranceIsWithin) {
    // 0.77 - 0.7 is 0.07000000000000006 and 0.1 * 0.7 is 0.06999999999999999 in binary.
    EXPECT_EQ(peak_verdict(0.7, 0.77, {}), Verdict::within);
    EXPECT_EQ(peak_verdict(0.7, 0.7700001, {}), Verdict::exceeded);
    EXPECT_EQ(peak_verdict(1000, 1500, {{"peak_force", {500, false}}}), Verdict::within);
    EXPECT_EQ(peak_verdict(1000, 1500.001, {{"peak_force", {500, false}}}), Verdict::exceeded);
}

TEST(CompareVerdict, AnAskedToleranceReplacesTheDefault) {
    EXPECT_EQ(peak_verdict(100, 103, {{"peak_force", {0.02, true}}}), Verdict::exceeded);
    EXPECT_EQ(peak_verdict(100, 130, {{"peak_force", {0.5, true}}}), Verdict::within);
    EXPECT_EQ(peak_verdict(100, 105, {{"peak_force", {4, false}}}), Verdict::exceeded);  // 4 N, not 400 %
    EXPECT_EQ(peak_verdict(100, 100, {{"peak_force", {0, true}}}), Verdict::within);
}

TEST(CompareVerdict, AZeroReferenceAllowsNoRelativeDifference) {
    EXPECT_EQ(peak_verdict(0, 0, {}), Verdict::within);
    EXPECT_EQ(peak_verdict(0, 1e-9, {}), Verdict::exceeded);
    EXPECT_EQ(peak_verdict(0, 3, {{"peak_force", {5, false}}}), Verdict::within);
    const FidelityGap gap = measure_gap(with_peak(0), with_peak(1), {});
    EXPECT_FALSE(find(gap, "peak_force")->relative);  // no division by zero
    EXPECT_EQ(find(gap, "peak_force")->difference, 1);
}

TEST(CompareVerdict, OneSideOnlyIsMissingAndSaysSo) {
    EXPECT_EQ(peak_verdict(100, {}, {}), Verdict::missing);
    EXPECT_EQ(peak_verdict({}, 100, {}), Verdict::missing);
    RunRecord reference = with_peak(100), candidate = with_peak({});
    reference.fidelity = "full";
    EXPECT_EQ(find(measure_gap(reference, candidate, {}), "peak_force")->note, "only full has it");
}

TEST(CompareVerdict, ANotFiniteValueIsNoValue) {
    EXPECT_EQ(peak_verdict(100, std::numeric_limits<double>::quiet_NaN(), {}), Verdict::missing);
}

TEST(CompareGap, ShowsWhatOneSideHasOrSomebodyAskedFor) {
    const FidelityGap empty = measure_gap(with_peak({}), with_peak({}), {});
    EXPECT_TRUE(empty.metrics.empty());  // a default tolerance alone makes no row
    EXPECT_EQ(peak_verdict({}, {}, {{"peak_force", {0.1, true}}}), Verdict::missing);

    RunRecord record = with_peak(100);
    record.add_metric("peak_force_raw_N", 9);
    EXPECT_EQ(find(measure_gap(record, record, {}), "peak_force_raw"), nullptr);
    EXPECT_NE(find(measure_gap(record, record, {{"peak_force_raw", {0.1, true}}}), "peak_force_raw"),
              nullptr);
}

/// A record of two parachutes, whose main pulls with so much.
RunRecord with_main_peak(std::optional<double> peak) {
    RunRecord record = with_peak(1000.0);
    record.events = {{"drogue.snatch", 1.0, 900.0, 50.0}, {"Main-1.snatch", 5.0, 800.0, 30.0}};
    if (peak) record.add_metric("main_1_peak_force_N", *peak);
    return record;
}

TEST(CompareGap, EachOfSeveralParachutesIsJudged) {
    const auto verdict = [](std::optional<double> a, std::optional<double> b, const Tolerances& asked) {
        const FidelityGap gap = measure_gap(with_main_peak(a), with_main_peak(b), asked);
        const MetricGap* metric = find(gap, "main_1_peak_force");
        return metric ? std::optional(metric->verdict) : std::nullopt;
    };
    // By the tolerance of peak_force, 10 %, or by one of its own; the peak of all together says nothing of
    // it.
    EXPECT_EQ(verdict(500.0, 540.0, {}), Verdict::within);
    EXPECT_EQ(verdict(500.0, 560.0, {}), Verdict::exceeded);
    EXPECT_EQ(verdict(500.0, 560.0, {{"main_1_peak_force", {0.2, true}}}), Verdict::within);
    EXPECT_EQ(verdict(500.0, {}, {}), Verdict::missing);
    EXPECT_FALSE(verdict({}, {}, {}));
    EXPECT_EQ(verdict({}, {}, {{"main_1_peak_force", {0.2, true}}}), Verdict::missing);
    // The same number under a name that no event has is a metric like any other that nobody asks for.
    RunRecord other = with_peak(1000.0);
    other.add_metric("main_1_peak_force_N", 500.0);
    EXPECT_EQ(find(measure_gap(other, other, {}), "main_1_peak_force"), nullptr);
}

TEST(CompareMetrics, OnesOfOneParachuteAreRowsOfTheTableUnderItsName) {
    const MetricRow* row = find_judgeable_row("main_stage_1_peak_force");
    ASSERT_TRUE(row);
    EXPECT_EQ(row->key, "main_stage_1_peak_force_N");
    EXPECT_EQ(row->title, "main: Peak opening force, stage 1");
    EXPECT_EQ(row->unit, "N");
    EXPECT_EQ(row, find_judgeable_row("main_stage_1_peak_force"));
    EXPECT_EQ(head_of_judgeable("main_stage_1_peak_force"), "main_");
    EXPECT_EQ(head_of_judgeable("stage_1_peak_force"), "");
    for (const char* none : {"peak_forc", "_peak_force", "main_force_history", "mainpeak_force"})
        EXPECT_FALSE(find_judgeable_row(none)) << none;
}

TEST(CompareGap, ARunThatBrokeOffIsNotJudged) {
    RunRecord broken = with_peak(20);  // the force so far, not the peak
    broken.status.code = StatusCode::interrupted;
    const FidelityGap gap = measure_gap(with_peak(100), broken, {});
    EXPECT_EQ(find(gap, "peak_force")->verdict, Verdict::not_judged);
    EXPECT_TRUE(find(gap, "peak_force")->tolerance);
}

TEST(CompareGap, WithoutToleranceThereIsNoVerdict) {
    RunRecord record;
    record.add_metric("load_factor", 3);
    const FidelityGap gap = measure_gap(record, record, {});
    EXPECT_EQ(find(gap, "load_factor")->verdict, Verdict::not_judged);
    EXPECT_EQ(overall_verdict(gap), Verdict::not_judged);
}

TEST(CompareGap, TwoInputsAreNotPassedOffAsAgreement) {
    const Comparison comparison = synthetic_comparison();
    EXPECT_NE(find(comparison.gap, "snatch_speed")->note.find("says nothing about the models"),
              std::string::npos);
    EXPECT_TRUE(find(comparison.gap, "peak_force")->note.empty());
}

TEST(CompareGap, TheCostRatioIsReferenceOverCandidate) {
    EXPECT_DOUBLE_EQ(*synthetic_comparison().gap.cost_ratio, 12.0 / 4e-4);
    EXPECT_FALSE(measure_gap(with_peak(1), with_peak(1), {}).cost_ratio);  // no wall time, no ratio
}

/// A comparison whose two sides lack the descent rate, and say why.
Comparison without_descent(bool rom_excused, bool full_excused, const Tolerances& asked = {}) {
    Comparison comparison = synthetic_comparison();
    for (RunRecord* side : {&comparison.candidate, &comparison.reference}) {
        std::erase_if(side->metrics, [](const Metric& m) { return m.key == "descent_rate_m_s"; });
        const bool excused = side == &comparison.candidate ? rom_excused : full_excused;
        side->missing.push_back({"descent_rate_m_s", "the run stopped before", excused});
    }
    comparison.gap = measure_gap(comparison.reference, comparison.candidate, asked);
    return comparison;
}

TEST(CompareGap, AMetricThatVanishesFromBothSidesIsMissingUnlessTheStopCameBefore) {
    const Comparison gone = without_descent(false, true);
    EXPECT_EQ(find(gone.gap, "descent_rate")->verdict, Verdict::missing);
    EXPECT_EQ(exit_code(gone), ExitCode::verdict);
    const Comparison early = without_descent(true, true);
    EXPECT_EQ(find(early.gap, "descent_rate")->verdict, Verdict::not_reached);
    EXPECT_EQ(find(early.gap, "descent_rate")->note,
              "neither side has it, rom: the run stopped before; full: the run stopped before");
    EXPECT_EQ(exit_code(early), ExitCode::done);
    EXPECT_EQ(verdict_line(early), "within tolerance: 2 of 2 judged metrics, 1 not reached (descent_rate)");
    // Whoever asks for a tolerance is not put off.
    const Comparison asked = without_descent(true, true, {{"descent_rate", {0.1, true}}});
    EXPECT_EQ(find(asked.gap, "descent_rate")->verdict, Verdict::missing);
}

TEST(CompareGap, WhereNothingIsReachedNothingWasCompared) {
    RunRecord record;
    record.fidelity = "x";
    for (const char* key : {"filling_time_s", "peak_force_N", "descent_rate_m_s"})
        record.missing.push_back({key, "stopped", true});
    Comparison comparison;
    comparison.reference = comparison.candidate = record;
    comparison.gap = measure_gap(record, record, {});
    EXPECT_EQ(verdict_line(comparison),
              "nothing was compared, 3 not reached (filling_time, peak_force, descent_rate)");
    EXPECT_EQ(overall_verdict(comparison), Verdict::not_judged);
}

TEST(CompareGap, AParachuteThatNeverOpenedFailsWhateverTheMetricsSay) {
    Comparison comparison = synthetic_comparison();
    comparison.candidate.status = {StatusCode::not_opened, "ground reached; main never opened (x)"};
    EXPECT_EQ(exit_code(comparison), ExitCode::verdict);
    EXPECT_EQ(overall_verdict(comparison), Verdict::exceeded);
    EXPECT_TRUE(
        verdict_line(comparison)
            .starts_with("not opened in rom: ground reached; main never opened (x); within tolerance"))
        << verdict_line(comparison);
}

TEST(CompareGap, WhatIsZeroButForRoundingHasNoShareAndIsWithin) {
    // The histories have metres up to 300: 3e-7 m are nothing there.
    const auto gap_of = [](double reference, double candidate, const Tolerances& asked = {}) {
        Comparison c = synthetic_comparison();
        for (RunRecord* side : {&c.reference, &c.candidate})
            side->channels.push_back({"altitude", "m", {300.0, 200.0}});
        c.reference.add_metric("landing_east_m", reference);
        c.candidate.add_metric("landing_east_m", candidate);
        return *find(measure_gap(c.reference, c.candidate, asked), "landing_east");
    };
    const MetricGap rounding = gap_of(1e-17, 0.0, {{"landing_east", {0.1, true}}});
    EXPECT_FALSE(rounding.relative);  // it was -100 %
    EXPECT_EQ(rounding.verdict, Verdict::within);
    EXPECT_EQ(rounding.note, "zero but for rounding");
    EXPECT_TRUE(gap_of(4e-7, 0.0).relative);
    EXPECT_EQ(gap_of(4e-7, 0.0, {{"landing_east", {0.1, true}}}).verdict, Verdict::exceeded);
    // A tolerance of nothing asks for the same bits.
    EXPECT_EQ(gap_of(1e-17, 0.0, {{"landing_east", {0.0, true}}}).verdict, Verdict::exceeded);
    EXPECT_EQ(gap_of(1e-17, 0.0, {{"landing_east", {0.0, false}}}).verdict, Verdict::exceeded);
}

TEST(CompareExit, FollowsTheWorstThatHappened) {
    Comparison comparison = synthetic_comparison();
    EXPECT_EQ(exit_code(comparison), ExitCode::done);
    comparison = synthetic_comparison({{"peak_force", {0.01, true}}});
    EXPECT_EQ(exit_code(comparison), ExitCode::verdict);
    comparison = synthetic_comparison({{"impulse", {0.01, true}}});  // neither record has it
    EXPECT_EQ(exit_code(comparison), ExitCode::verdict);
    comparison.candidate.status = {StatusCode::solver_failed, "too much work"};
    EXPECT_EQ(exit_code(comparison), ExitCode::numerical);
    EXPECT_EQ(verdict_line(comparison), "no verdict: rom ended as solver_failed: too much work");
    comparison.reference.status = {StatusCode::interrupted, ""};
    EXPECT_EQ(exit_code(comparison), ExitCode::interrupted);
}

TEST(CompareGap, WhatOneHasFromTheOtherAloneIsNotCompared) {
    // The rest of a full run, flown by rom: its descent rate against rom's is rom's against rom's. The place
    // of the landing holds what the full model flew before.
    const auto gap_of = [](const std::string& to, const Tolerances& asked) {
        Comparison made = synthetic_comparison();
        for (RunRecord* record : {&made.candidate, &made.reference}) {
            record->add_metric("landing_east_m", 40.0);
            record->handed_over = HandOver{to, 2.0, {"descent_rate_m_s", "landing_east_m"}};
        }
        return measure_gap(made.reference, made.candidate, asked);
    };
    const FidelityGap gap = gap_of("rom", {{"landing_east", {1.0, false}}});
    EXPECT_EQ(find(gap, "descent_rate")->verdict, Verdict::not_reached);
    EXPECT_FALSE(find(gap, "descent_rate")->reference);
    EXPECT_TRUE(find(gap, "descent_rate")->candidate);
    EXPECT_NE(find(gap, "descent_rate")->note.find("rom flew the rest from t = 2 s on"), std::string::npos);
    EXPECT_EQ(find(gap, "landing_east")->verdict, Verdict::within);
    EXPECT_EQ(find(gap_of("rom", {{"descent_rate", {0.1, true}}}), "descent_rate")->verdict,
              Verdict::missing);
    EXPECT_EQ(find(gap_of("third", {}), "descent_rate"), nullptr);  // neither has one of its own
    // Histories end with the hand-over: 6 s of them without one.
    for (const HistoryGap& history : gap.histories)
        for (const PhaseScore& phase : history.phases)
            EXPECT_LE(phase.to, 2.0);
    EXPECT_FALSE(gap.histories.empty());
}

}  // namespace
}  // namespace twinchute::compare
