// Differences of histories, against curves whose norms are known in closed form.
#include "compare/histories.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "compare/gap.hpp"
#include "lib/math/vec.hpp"
#include "tests/support/compare_records.hpp"

namespace twinchute::compare {
namespace {

Curve sampled(double from, double to, int pieces, const std::function<double(double)>& value) {
    Curve curve;
    for (int i = 0; i <= pieces; ++i) {
        curve.time.push_back(from + (to - from) * i / pieces);
        curve.value.push_back(value(curve.time.back()));
    }
    return curve;
}

/// A record with one channel beside time, snatch at `snatch` and full open at `full`.
RunRecord with_history(const Curve& curve, double snatch, double full) {
    RunRecord record;
    record.channels = {{"time", "s", curve.time}, {"force", "N", curve.value}};
    record.events = {{"snatch", snatch, 0, 0}, {"full-open", full, 0, 0}};
    return record;
}

const MetricRow& force_row() {
    return history_rows().front();
}

constexpr double round_off = 1e-13;  // some thousand additions of numbers of order 1

TEST(CompareHistories, NormsOfLinesAreExact) {
    // Norm of x over [0, 3]: integral of x^2 = 9. One segment or seven make no difference.
    for (const int pieces : {1, 7}) {
        const Curve ramp = sampled(0, 3, pieces, [](double t) { return t; });
        EXPECT_NEAR(l2_norm(ramp), 3, 3 * round_off);
        EXPECT_EQ(infinity_norm(ramp), 3);
    }
    // Through zero: 2x - 1 over [0, 1], integral of the square 1/3.
    EXPECT_NEAR(l2_norm({{0, 1}, {-1, 1}}), std::sqrt(1.0 / 3), round_off);
}

TEST(CompareHistories, AJumpHasAValueOnEitherSide) {
    const Curve step{{0, 1, 1, 2}, {0, 3, 10, 12}};
    EXPECT_EQ(value_before(step, 1), 3);
    EXPECT_EQ(value_after(step, 1), 10);
    for (const auto value : {value_before, value_after}) {
        EXPECT_DOUBLE_EQ(value(step, 0.5), 1.5);
        EXPECT_DOUBLE_EQ(value(step, 1.5), 11);
        EXPECT_EQ(value(step, 0), 0);
        EXPECT_EQ(value(step, 2), 12);
    }
    // At the very ends of a curve, too; of three rows of one time the first and the last one count.
    const Curve ends{{0, 0, 1, 1, 1}, {5, 6, 7, 99, 8}};
    EXPECT_EQ(value_before(ends, 0), 5);
    EXPECT_EQ(value_after(ends, 0), 6);
    EXPECT_EQ(value_before(ends, 1), 7);
    EXPECT_EQ(value_after(ends, 1), 8);
}

TEST(CompareHistories, DifferentClocksMeetInTheirUnion) {
    // A hat of height 1 at 1.5 and a line 0: a clock of three points and one of two. Over [0, 3] the square
    // of the hat integrates to 2 x 1.5/3 = 1.
    const Curve hat{{0, 1.5, 3}, {0, 1, 0}}, line{{-1, 4}, {0, 0}};
    EXPECT_NEAR(l2_norm(difference(hat, line, 0, 3)), 1, round_off);
    EXPECT_EQ(infinity_norm(difference(line, hat, 0, 3)), 1);  // the peak is a point of the union
    // Ramps of slope 2 and 1 on clocks that share no inner point differ by x: integral over [0.5, 1.5] of
    // x^2.
    const Curve two = sampled(0, 2, 7, [](double t) { return 2 * t; }),
                one = sampled(0, 2, 11, [](double t) { return t; });
    EXPECT_NEAR(l2_norm(difference(two, one, 0.5, 1.5)), std::sqrt((1.5 * 1.5 * 1.5 - 0.125) / 3), round_off);
}

TEST(CompareHistories, TheNormOfTheDifferenceIsSymmetric) {
    const Curve a = sampled(0, 1, 13, [](double t) { return std::sin(5 * t); }),
                b = sampled(0, 1, 8, [](double t) { return std::exp(t); });
    EXPECT_EQ(l2_norm(difference(a, b, 0.1, 0.9)), l2_norm(difference(b, a, 0.1, 0.9)));
    EXPECT_EQ(infinity_norm(difference(a, b, 0, 1)), infinity_norm(difference(b, a, 0, 1)));
    EXPECT_EQ(l2_norm(difference(a, a, 0, 1)), 0);
}

TEST(CompareHistories, SinesConvergeToTheirIntegrals) {
    // sin - cos = sqrt(2) sin(t - pi/4): over a period the square integrates to 2 pi. Straight lines between
    // n points miss it by the order of h^2: 16 times less from one to four times the points.
    const double period = 2 * pi, exact = std::sqrt(period);
    const auto error = [&](int n) {
        const Curve sine = sampled(0, period, n, [](double t) { return std::sin(t); }),
                    cosine = sampled(0, period, n + 3, [](double t) { return std::cos(t); });
        return std::abs(l2_norm(difference(sine, cosine, 0, period)) - exact);
    };
    EXPECT_LT(error(400), 1e-4);
    EXPECT_NEAR(error(100) / error(400), 16, 2);  // n + 3 is not n: the clocks drift against each other
}

TEST(CompareHistories, AJumpCountsOnBothSides) {
    // 1 until 1, 3 from then on, against 1 throughout: the difference is 0, then 2 over one second.
    const Curve jump{{0, 1, 1, 2}, {1, 1, 3, 3}}, flat{{0, 2}, {1, 1}};
    EXPECT_NEAR(l2_norm(difference(jump, flat, 0, 2)), 2, round_off);
    EXPECT_EQ(infinity_norm(difference(jump, flat, 0, 1)), 0);  // what was, at its end
    EXPECT_EQ(infinity_norm(difference(jump, flat, 1, 2)), 2);  // what follows, from its beginning
    EXPECT_EQ(l2_norm(cut(jump, 1, 2)), 3);
}

TEST(CompareHistories, AlignedAtSnatchAShiftOfTheClockChangesNothing) {
    const auto force = [](double t) { return 1 + std::sin(3 * t); };
    const RunRecord reference = with_history(sampled(0, 4, 400, force), 1, 3);
    // A copy of the curve released 0.75 s earlier, with its events; 0.75 is exact in binary, so are the
    // shifted clocks.
    RunRecord late = reference;
    for (double& t : late.channels[0].values)
        t += 0.75;
    for (Event& event : late.events)
        event.time += 0.75;
    for (const PhaseScore& phase : score_history(reference, late, force_row())) {
        EXPECT_NEAR(phase.l2, 0, 1e-14);  // of a clock that is rounded once
        EXPECT_NEAR(phase.infinity, 0, 1e-14);
    }
    // Without its snatch the late one is aligned at release, and the shift is seen.
    late.events.erase(late.events.begin());
    EXPECT_GT(*judged_score(score_history(reference, late, force_row())), 0.1);
}

TEST(CompareHistories, PhasesAreScoredApart) {
    // The reference is 2 throughout. The candidate is 2 + 1 before snatch at 1, 2 - 0.2 until full open at 3,
    // then 2.
    const Curve two = sampled(0, 5, 5, [](double) { return 2.0; });
    const Curve other{{0, 1, 1, 3, 3, 4.5}, {3, 3, 1.8, 1.8, 2, 2}};
    const auto phases = score_history(with_history(two, 1, 3), with_history(other, 1, 2.5), force_row());
    ASSERT_EQ(phases.size(), 3u);
    const auto expect = [](const PhaseScore& phase, HistoryPhase which, double from, double to,
                           double maximum, double norms) {
        EXPECT_EQ(phase.phase, which);
        EXPECT_DOUBLE_EQ(phase.from, from);
        EXPECT_DOUBLE_EQ(phase.to, to);
        EXPECT_NEAR(phase.maximum, maximum, round_off);
        EXPECT_NEAR(phase.l2, norms, round_off);
        EXPECT_NEAR(phase.infinity, norms, round_off);
    };
    expect(phases[0], HistoryPhase::deployment, -1, 0, 0.5, 0.5);
    expect(phases[1], HistoryPhase::inflation, 0, 2, -0.1, 0.1);  // the reference says when it ends
    expect(phases[2], HistoryPhase::descent, 2, 3.5, 0, 0);       // as long as both last
    EXPECT_NEAR(*judged_score(phases), 0.1, round_off);           // deployment is not judged
}

TEST(CompareHistories, DeploymentIsScoredOnlyWhereTheReferenceHasSomething) {
    const auto phases_at = [](double before, double filling) {
        const Curve reference{{0, 0.25, 0.25, 3, 3, 5}, {before, before, filling, filling, 2, 2}};
        const Curve other = sampled(0, 5, 5, [](double) { return 1.0; });
        std::vector<HistoryPhase> phases;
        for (const PhaseScore& score :
             score_history(with_history(reference, 0.25, 3), with_history(other, 0.25, 3), force_row()))
            phases.push_back(score.phase);
        return phases;
    };
    using enum HistoryPhase;
    EXPECT_EQ(phases_at(0.021, 2), (std::vector{deployment, inflation, descent}));
    EXPECT_EQ(phases_at(0.019, 2), (std::vector{inflation, descent}));      // below a hundredth of 2
    EXPECT_EQ(phases_at(-0.019, 1e-3), (std::vector{inflation, descent}));  // what is judged is always scored
}

/// A drogue from 1 s on, full at 2, cut at 4; a main that leaves its pack at `leaves`, snatches at `snatch`
/// and is full 2 s later. The drogue pulls with 10, the main with 1 while it is drawn out and with `pull`
/// from then on.
RunRecord two_in_turn(double snatch, double pull, double leaves = 4) {
    RunRecord record =
        with_history({{0, 1, 1, 4, 4, snatch, snatch, snatch + 5}, {0, 0, 10, 10, 1, 1, pull, pull}}, 1, 2);
    record.events = {{"drogue.snatch", 1, 0, 0},    {"drogue.full-open", 2, 0, 0},
                     {"drogue.cut", 4, 0, 0},       {"main.release", leaves, 0, 0},
                     {"main.snatch", snatch, 0, 0}, {"main.full-open", snatch + 2, 0, 0}};
    return record;
}

TEST(CompareHistories, EachParachuteInTurnIsAlignedAtItsOwnSnatch) {
    // Two mains alike, one snatched half a second later (exact in binary), a quarter of a second earlier out
    // of its pack: nothing is apart but the clock.
    const RunRecord reference = two_in_turn(5, 2);
    const auto late = score_history(reference, two_in_turn(5.5, 2, 3.75), force_row());
    struct Expected {
        const char* parachute;
        HistoryPhase phase;
        double from, to;
    };
    // The drogue's descent ends where the main leaves its pack in the first of both, 2.75 s after the
    // drogue's snatch. From then on, at 3.75 s in either record, the main is drawn out, of which both
    // have 1.25 s. Before the drogue's snatch the reference has no force, and no score.
    const std::vector<Expected> expected{{"drogue", HistoryPhase::inflation, 0, 1},
                                         {"drogue", HistoryPhase::descent, 1, 2.75},
                                         {"main", HistoryPhase::deployment, -1.25, 0},
                                         {"main", HistoryPhase::inflation, 0, 2},
                                         {"main", HistoryPhase::descent, 2, 5}};
    ASSERT_EQ(late.size(), expected.size());
    for (std::size_t k = 0; k < expected.size(); ++k) {
        EXPECT_EQ(late[k].parachute, expected[k].parachute) << k;
        EXPECT_EQ(late[k].phase, expected[k].phase) << k;
        EXPECT_DOUBLE_EQ(late[k].from, expected[k].from) << k;
        EXPECT_DOUBLE_EQ(late[k].to, expected[k].to) << k;
        if (late[k].phase != HistoryPhase::deployment) {
            EXPECT_EQ(late[k].l2, 0.0) << k;
        }
    }
    // A main that pulls half as hard again is that far off, however hard the drogue pulled.
    const auto harder = score_history(reference, two_in_turn(5.5, 3), force_row());
    EXPECT_NEAR(*judged_score(harder), 0.5, round_off);
    EXPECT_EQ(harder.front().l2, 0.0);
}

TEST(CompareHistories, WithoutTheSameParachutesThereIsOneClock) {
    const RunRecord reference = two_in_turn(5, 2);
    RunRecord lost = two_in_turn(5, 0);  // its main never comes out
    std::erase_if(lost.events, [](const Event& event) { return event.name.starts_with("main."); });
    const auto phases = score_history(reference, lost, force_row());
    ASSERT_EQ(phases.size(), 2u);
    EXPECT_EQ(phases.back().parachute, "");
    EXPECT_DOUBLE_EQ(phases.back().to, 9.0);  // to the end, the main's pull included
    // Squares of 10 over 2 s, 1 over 1 s and 2 over 5 s: the last are missing.
    EXPECT_NEAR(*judged_score(phases), std::sqrt(20.0 / 221.0), round_off);
    // One clock, too, where a third one comes out in one record alone.
    RunRecord more = reference;
    more.events.push_back({"reserve.snatch", 8, 0, 0});
    for (const auto& scores :
         {score_history(more, reference, force_row()), score_history(reference, more, force_row())})
        EXPECT_EQ(scores.front().parachute, "");
}

TEST(CompareHistories, WithoutTwoUsableCurvesThereIsNoScore) {
    const Curve good = sampled(0, 4, 4, [](double t) { return t; });
    const RunRecord record = with_history(good, 1, 2);
    const auto scores = [&](const Curve& other) {
        return score_history(record, with_history(other, 1, 2), force_row()).size();
    };
    EXPECT_EQ(scores(good), 3u);
    EXPECT_EQ(scores({{0, 1, 2}, {0, std::nan(""), 1}}), 0u);
    EXPECT_EQ(scores({{0, 2, 1}, {0, 1, 1}}), 0u);  // time that falls
    EXPECT_EQ(scores({{0}, {0}}), 0u);
    EXPECT_EQ(score_history(record, RunRecord{}, force_row()).size(), 0u);
    RunRecord zero = with_history(sampled(0, 4, 4, [](double) { return 0.0; }), 1, 2);
    EXPECT_EQ(score_history(zero, record, force_row()).size(), 0u);
    EXPECT_EQ(judged_score({}), std::nullopt);
}

TEST(CompareHistories, AToleranceIsHeldAgainstTheWorseOfInflationAndDescent) {
    const auto verdict_of = [](const Tolerance& tolerance) {
        const Comparison comparison = synthetic_comparison({{"force_history", tolerance}});
        return std::pair(comparison.gap.histories.front(), exit_code(comparison));
    };
    const double score = *verdict_of({1, true}).first.score;
    ASSERT_GT(score, 0);
    EXPECT_EQ(verdict_of({score, true}).first.verdict, Verdict::within);  // exactly at it
    EXPECT_EQ(verdict_of({score, false}).first.verdict, Verdict::within);
    const auto [history, code] = verdict_of({0.999 * score, true});
    EXPECT_EQ(history.verdict, Verdict::exceeded);
    for (const PhaseScore& phase : history.phases)  // the one that is at fault
        EXPECT_EQ(phase_verdict(history, phase), phase.l2 == score ? Verdict::exceeded : Verdict::within);
    EXPECT_EQ(code, ExitCode::verdict);
    EXPECT_NE(verdict_line(synthetic_comparison({{"force_history", {0, true}}})).find("(force_history)"),
              std::string::npos);
    // Neither has it: what somebody asked for is missing, what nobody asked for is not shown.
    const FidelityGap gap = synthetic_comparison({{"projected_area_history", {0.1, true}}}).gap;
    EXPECT_EQ(gap.histories.back().verdict, Verdict::missing);
    EXPECT_EQ(overall_verdict(gap), Verdict::exceeded);
    for (const HistoryGap& row : synthetic_comparison().gap.histories) {
        EXPECT_EQ(row.verdict, Verdict::not_judged);
        EXPECT_NE(row.row->name, "projected_area_history");
    }
}

}  // namespace
}  // namespace twinchute::compare
