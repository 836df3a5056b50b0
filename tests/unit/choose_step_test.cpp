// Which step is taken, and how many subcycles of lines in it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "fullsim/time/choose_step.hpp"

namespace twinchute::fullsim {
namespace {

/// A canopy that could take five times the step of its lines.
constexpr CriticalSteps light_lines{1e-5, 5e-5, 1e-5};

StepRules rules_with(int most_subcycles) {
    StepRules rules;
    rules.most_subcycles = most_subcycles;
    return rules;
}

TEST(ChooseStep, WithoutSubcyclesItIsTheBoundTimesTheFactor) {
    StepRules rules;
    rules.factor = 0.95;
    const ChosenStep step = choose_step(light_lines, rules);
    EXPECT_DOUBLE_EQ(step.dt, 0.95 * 1e-5);
    EXPECT_EQ(step.subcycles, 1);
}

TEST(ChooseStep, LinesThatHoldNothingBackTakeNone) {
    // Two subcycles would make no step longer, and cost.
    const ChosenStep step = choose_step({5e-5, 5e-5, 9e-5}, rules_with(12));
    EXPECT_DOUBLE_EQ(step.dt, 5e-5);
    EXPECT_EQ(step.subcycles, 1);
}

TEST(ChooseStep, TakesSubcyclesUntilTheCanopyHoldsItBack) {
    // Up to five, each makes the step longer by the first's length for an eighth of its cost; the sixth does
    // not.
    const ChosenStep step = choose_step(light_lines, rules_with(12));
    EXPECT_DOUBLE_EQ(step.dt, 5e-5);
    EXPECT_EQ(step.subcycles, 5);
}

TEST(ChooseStep, TakesNoMoreSubcyclesThanItMay) {
    const ChosenStep step = choose_step(light_lines, rules_with(3));
    EXPECT_DOUBLE_EQ(step.dt, 3e-5);
    EXPECT_EQ(step.subcycles, 3);
}

TEST(ChooseStep, LeavesSubcyclesThatMakeTooLittleOfIt) {
    // Lines at 0.95 of the canopy's bound: the step would be 5 % longer and cost 12 % more.
    const ChosenStep step = choose_step({0.95e-5, 1e-5, 0.95e-5}, rules_with(12));
    EXPECT_EQ(step.subcycles, 1);
}

TEST(ChooseStep, KeepsLinesFromRinging) {
    StepRules rules = rules_with(12);
    rules.resonance_limit = 3e-5;
    rules.factor = 0.5;
    // The resonance limit has its factor already: 2.5e-5 is below it, and 3.5e-5 is not.
    EXPECT_DOUBLE_EQ(choose_step(light_lines, rules).dt, 2.5e-5);
    const ChosenStep longer = choose_step({1e-5, 7e-5, 1e-5}, rules);
    EXPECT_DOUBLE_EQ(longer.dt, 3e-5);
    EXPECT_EQ(longer.subcycles, 6);
    // Without subcycles nothing rings.
    rules.most_subcycles = 1;
    rules.resonance_limit = 1e-6;
    EXPECT_DOUBLE_EQ(choose_step(light_lines, rules).dt, 0.5e-5);
}

TEST(ChooseStep, ChatteringFabricWithSubcyclesTakesHalfOfEitherBound) {
    StepRules rules = rules_with(12);
    rules.chatters = true;
    const ChosenStep step = choose_step(light_lines, rules);
    EXPECT_DOUBLE_EQ(step.dt, 2.5e-5);
    EXPECT_EQ(step.subcycles, 5);
    // Half with whatever factor, and no more where that is half already.
    rules.factor = 0.8;
    EXPECT_DOUBLE_EQ(choose_step(light_lines, rules).dt, 2.5e-5);
    rules.factor = 0.4;
    EXPECT_DOUBLE_EQ(choose_step(light_lines, rules).dt, 0.4 * 5e-5);
    // Alone it takes its own.
    rules.most_subcycles = 1;
    EXPECT_DOUBLE_EQ(choose_step(light_lines, rules).dt, 0.4 * 1e-5);
}

TEST(ChooseStep, GivesImpactsTheirShareOfEveryBound) {
    StepRules rules = rules_with(12);
    rules.share = 0.3;
    EXPECT_DOUBLE_EQ(choose_step(light_lines, rules).dt, 0.3 * 5e-5);
    rules.chatters = true;
    EXPECT_DOUBLE_EQ(choose_step(light_lines, rules).dt, 0.3 * 2.5e-5);
    rules.most_subcycles = 1;
    EXPECT_DOUBLE_EQ(choose_step(light_lines, rules).dt, 0.3 * 1e-5);
}

TEST(ChooseStep, IsNeverAboveAnyBound) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> decade(-6.0, -3.0), share(0.2, 1.0);
    for (int k = 0; k < 10'000; ++k) {
        CriticalSteps stable{0.0, std::pow(10.0, decade(random)), std::pow(10.0, decade(random))};
        stable.all = std::min(stable.canopy, stable.lines) * share(random);
        StepRules rules = rules_with(1 + k % 12);
        rules.factor = share(random);
        rules.chatters = k % 2 == 0;
        rules.share = share(random);
        if (k % 3 == 0) rules.resonance_limit = std::pow(10.0, decade(random));
        const ChosenStep step = choose_step(stable, rules);
        const double most = rules.factor * (1.0 + 1e-12);
        ASSERT_GT(step.dt, 0.0);
        ASSERT_LE(step.dt, most * stable.canopy);
        if (step.subcycles == 1) {
            ASSERT_LE(step.dt, most * stable.all);
        } else {
            ASSERT_LE(step.dt, most * step.subcycles * stable.lines);
            ASSERT_LE(step.dt, rules.resonance_limit * (1.0 + 1e-12));
        }
    }
}

TEST(ImpactWatch, ACraneDropKeepsItsSteps) {
    // It uses 0.56 of the largest residual, little by little.
    ImpactWatch impacts;
    for (int k = 0; k <= 28; ++k)
        impacts.look(0.02 * k, 0.0);
    EXPECT_EQ(impacts.share(), 1.0);
    EXPECT_FALSE(impacts.alert());
}

TEST(ImpactWatch, StaysBelowTheLargestResidualWhereImpactsUseItInProportionToTheStep) {
    // Whatever impacts would use of it at full steps, up to a fifth of all between two looks; gains or
    // losses.
    for (const double sign : {1.0, -1.0})
        for (const double at_full_steps : {0.02, 0.1, 0.2}) {
            ImpactWatch impacts;
            impacts.expect();
            double used = 0.0;
            for (int k = 0; k < 300; ++k) {
                used += sign * at_full_steps * impacts.share() * impacts.share();
                impacts.look(used, 0.0);
            }
            EXPECT_LT(std::abs(used), 1.0) << at_full_steps;
            EXPECT_TRUE(impacts.alert());
        }
}

TEST(ImpactWatch, GivesStepsBackWhereNothingHappens) {
    ImpactWatch impacts;
    impacts.expect();
    EXPECT_LT(impacts.share(), 0.2);
    for (int k = 0; k < 50; ++k)  // 250 steps
        impacts.look(0.01, 0.0);
    EXPECT_EQ(impacts.share(), 1.0);
}

TEST(ImpactWatch, GivesStepsBackWhereNothingHappensEvenWhenAllIsUsed) {
    ImpactWatch impacts;
    for (int k = 0; k < 20; ++k)
        impacts.look(0.1 * k, 0.0);
    EXPECT_LT(impacts.share(), 0.1);
    for (int k = 0; k < 50; ++k)
        impacts.look(1.9, 0.0);
    EXPECT_EQ(impacts.share(), 1.0);
}

TEST(ImpactWatch, LeavesStepsAloneUpToWhatIsTolerated) {
    ImpactWatch impacts;
    for (const double used : {0.2, 0.39, -0.39}) {
        impacts.look(used, 0.0, 0.4);
        EXPECT_EQ(impacts.share(), 1.0) << used;
    }
    impacts.look(0.8, 0.0, 0.4);
    EXPECT_LT(impacts.share(), 0.5);
}

TEST(ImpactWatch, IsDueWhenAThousandthHasBeenDissipated) {
    ImpactWatch impacts;
    impacts.look(0.0, 50.0);
    EXPECT_FALSE(impacts.is_due(59.0, 1e4));
    EXPECT_TRUE(impacts.is_due(61.0, 1e4));
}

TEST(StepToFirstImpact, HalvesTheSlackInTwentySteps) {
    // An edge that lacks 0.4 of its length and lengthens by twice its length a second.
    EXPECT_DOUBLE_EQ(20.0 * 2.0 * step_to_first_impact(-0.4, 2.0), 0.2);
    EXPECT_DOUBLE_EQ(2.0 * step_to_first_impact(-0.01, 2.0), 0.005);
    EXPECT_EQ(step_to_first_impact(0.01, 2.0), infinity);
    EXPECT_EQ(step_to_first_impact(-0.4, -1.0), infinity);
}

TEST(StepInImpacts, IsOneInWhichNothingOvershootsByMoreThanAFifthOfAPerCent) {
    EXPECT_DOUBLE_EQ(500.0 * step_in_impacts(500.0), 0.002);
    EXPECT_EQ(step_in_impacts(0.0), infinity);
}

TEST(CostOf, IsThatOfAStepAndAnEighthForEachFurtherSubstep) {
    // Measured: a subcycle of lines takes a tenth to an eighth of a step of everything (docs/cost.md).
    EXPECT_DOUBLE_EQ(cost_of(1), 1.0);
    EXPECT_NEAR(cost_of(9), 2.0, 0.2);
}

}  // namespace
}  // namespace twinchute::fullsim
