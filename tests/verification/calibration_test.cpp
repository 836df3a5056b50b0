// Inputs that are known come back from drops that were made with them, and what is wrong with a test is
// named.
#include <gtest/gtest.h>

#include "lib/cli/command.hpp"
#include "tests/support/calibration_coverage.hpp"

namespace twinchute::test {
namespace {

using study::Calibration;
using study::Parameter;

constexpr const char *fill_constant = "parachute.fill_time.n", *drag_area = "parachute.drag_area",
                     *initial_ratio = "parachute.initial_drag_area_ratio";

bool any_finding_says(const Calibration& calibration, const std::string& words) {
    return std::ranges::any_of(calibration.findings, [&](const study::Finding& f) {
        return (f.what + f.why).find(words) != std::string::npos;
    });
}

std::string what_is_found(const Calibration& calibration) {
    std::string text;
    for (const study::Finding& f : calibration.findings)
        text += f.what + " (" + f.why + ")\n";
    for (const Parameter& p : calibration.parameters)
        text += p.unknown.name + " " + std::to_string(p.estimate) + (p.held ? " held " : " ") + p.why + "\n";
    return text;
}

void expect_holds(const Calibration& calibration, const char* key, double truth) {
    const Parameter* p = calibration.find(key);
    ASSERT_NE(p, nullptr) << key;
    EXPECT_TRUE(p->identified) << key << ": " << p->why;
    EXPECT_LE(p->interval.low, truth) << key;
    EXPECT_GE(p->interval.high, truth) << key;
}

/// Not far wider than it has to be, either.
void expect_narrow(const Calibration& calibration, const char* key, double share) {
    const Parameter* p = calibration.find(key);
    EXPECT_LT((p->interval.high - p->interval.low) / p->estimate, share) << key;
}

// The truth that a fit of one number once missed by a fifth: n = 5.5, 39 m^2, 0.06.
TEST(CalibrationOfASyntheticDrop, GivesTheTruthBack) {
    const Calibration calibration = calibrated({SyntheticDrop{}.test()});
    expect_holds(calibration, fill_constant, 5.5);
    expect_holds(calibration, drag_area, 39.0);
    expect_holds(calibration, initial_ratio, 0.06);
    expect_narrow(calibration, fill_constant, 0.02);
    expect_narrow(calibration, drag_area, 0.1);
    expect_narrow(calibration, initial_ratio, 0.1);
    EXPECT_TRUE(calibration.is_consistent()) << calibration.findings.front().what;
}

// A height is above the ground of its own test.
TEST(CalibrationOfASyntheticDrop, CountsHeightsFromTheGroundOfTheTest) {
    SyntheticDrop drop;
    drop.more = {"environment.ground='8 m'"};
    Scene scene = demo_scene_with(drop.truth());
    scene.stop = {Trigger::Kind::time, 4.0, 0.0, {}};
    twinchute::Run run;
    std::vector<double> times;
    for (int i = 0; i < 80; ++i)
        times.push_back(0.05 * i);
    run.samples = times;
    const RunRecord record = rom::rom_fidelity().run(scene, run);
    study::DropTest test;
    test.name = "heights";
    test.clock_known = true;
    test.conditions = {"environment.ground='8 m'"};
    study::MeasuredHistory history{study::find_history_kind("height"), times, {}, 0.02, {}};
    for (const double altitude : record.find_channel("altitude")->values)
        history.value.push_back(altitude - 8.0);
    test.histories.push_back(std::move(history));
    const Calibration calibration = calibrated({test});
    const Parameter* n = calibration.find(fill_constant);
    EXPECT_NEAR(n->estimate, 5.5, 0.02) << what_is_found(calibration);
}

// From seconds away a descent of the sum of squares alone ends in a peak that lies beside the readings.
TEST(CalibrationOfASyntheticDrop, FindsTheClockAsWell) {
    for (const double offset : {-0.7, 4.2}) {
        SyntheticDrop drop;
        drop.offset = offset;
        const Calibration calibration = calibrated({drop.test(false)});
        expect_holds(calibration, fill_constant, 5.5);
        expect_holds(calibration, drag_area, 39.0);
        expect_holds(calibration, initial_ratio, 0.06);
        expect_holds(calibration, study::clock_offset, offset);
        EXPECT_TRUE(calibration.is_consistent()) << calibration.findings.front().what;
    }
}

// By the power of the growth as well, where the scene has one: four inputs of one history.
TEST(CalibrationOfASyntheticDrop, FindsThePowerOfTheGrowth) {
    constexpr const char* exponent = "parachute.drag_area_exponent";
    SyntheticDrop drop;
    drop.more = {std::string(exponent) + "=4.3"};
    const study::DropTest test = drop.test();
    const Calibration calibration = study::calibrate(
        [&](const std::vector<std::string>& more) {
            std::vector<std::string> all{std::string(exponent) + "=6"};
            all.insert(all.end(), more.begin(), more.end());
            return demo_scene_with(all);
        },
        {test}, rom::rom_fidelity(), {});
    expect_holds(calibration, fill_constant, 5.5);
    expect_holds(calibration, drag_area, 39.0);
    expect_holds(calibration, initial_ratio, 0.06);
    expect_holds(calibration, exponent, 4.3);
    EXPECT_TRUE(calibration.is_consistent()) << what_is_found(calibration);
}

TEST(CalibrationOfASyntheticDrop, LearnsTheNoiseWhereNobodyStatesIt) {
    study::DropTest test = SyntheticDrop{}.test();
    const double sigma = *test.histories[0].sigma;
    test.histories[0].sigma.reset();
    const Calibration calibration = calibrated({test});
    expect_holds(calibration, fill_constant, 5.5);
    // 600 readings know a standard deviation to 3 %.
    EXPECT_NEAR(calibration.histories[0].noise.sigma / sigma, 1.0, 0.1);
}

// Without its filter the model would lead the readings by 8 ms at 20 Hz, which a fit takes for a longer
// filling: 0.008 s of 2.2 s are ten times what 0.1 % of noise leaves open.
TEST(CalibrationOfASyntheticDrop, NeedsTheFilterOfTheInstrument) {
    SyntheticDrop drop;
    drop.noise = 1e-3;
    drop.bandwidth = 20.0;
    study::DropTest test = drop.test();
    expect_holds(calibrated({test}), fill_constant, 5.5);
    test.histories[0].bandwidth.reset();
    EXPECT_GT(calibrated({test}).find(fill_constant)->interval.low, 5.5);
}

TEST(CalibrationOfASyntheticDrop, ReportsWhatGoesTogether) {
    // Before the canopy is full the clock, the fill constant and the initial ratio all shift the same rise.
    SyntheticDrop drop;
    drop.length = 1.6;
    const Calibration calibration = calibrated({drop.test(false)});
    EXPECT_FALSE(calibration.pairs.empty());
    // One peak is the same for a slow filling from little and a quick one from much.
    study::DropTest peak;
    peak.name = "peak";
    peak.clock_known = true;
    peak.scalars.push_back({find_metric_row("peak_force"), 3900.0, 20.0});
    peak.priors = {{fill_constant, 5.0, 1.0}, {initial_ratio, 0.06, 0.03}};
    study::CalibrationSettings settings;
    settings.vary = {{fill_constant, {}, {}}, {initial_ratio, {}, {}}};
    const Calibration of_peak = calibrated({peak}, settings);
    ASSERT_EQ(of_peak.pairs.size(), 1u) << what_is_found(of_peak);
    EXPECT_LT(of_peak.pairs[0].correlation, -0.9);
}

// A steady descent has no filling in it.
TEST(CalibrationOfADescent, HoldsWhatItDoesNotSee) {
    study::DropTest test;
    test.name = "descent";
    test.clock_known = true;
    test.scalars.push_back({find_metric_row("descent_rate"), 8.0, 0.1});
    const Calibration calibration = calibrated({test});
    EXPECT_TRUE(calibration.find(fill_constant)->held);
    EXPECT_TRUE(calibration.find(initial_ratio)->held);
    EXPECT_DOUBLE_EQ(calibration.find(fill_constant)->estimate, 4.0);  // the scene's
    const Parameter* area = calibration.find(drag_area);
    ASSERT_TRUE(area->identified) << area->why;
    // (m_l + m_p) g = 1/2 rho C_D S w^2, and sigma(C_D S)/(C_D S) = 2 sigma(w)/w.
    const double expected = 2.0 * (152.4 + 5.19) * 9.80665 / (1.225 * 8.0 * 8.0);
    EXPECT_NEAR(area->estimate / expected, 1.0, 0.01);  // a rate is steady to 0.5 %
    EXPECT_NEAR((area->interval.high - area->interval.low) / area->estimate, 2 * 1.96 * 2 * 0.1 / 8.0, 0.005);
}

TEST(CalibrationOfASyntheticDrop, ThatLiesBesideItsClockIsRefused) {
    // Four seconds late, with a clock that may be a tenth off: no input moves what was read.
    SyntheticDrop drop;
    drop.offset = 4.2;
    study::CalibrationSettings settings;
    settings.vary = {{study::clock_offset, -0.1, 0.1}, {fill_constant, {}, {}}, {drag_area, {}, {}}};
    try {
        calibrated({drop.test(false)}, settings);
        FAIL() << "it was fitted";
    } catch (const UsageError& error) {
        EXPECT_NE(std::string(error.what()).find("see none of its inputs"), std::string::npos)
            << error.what();
    }
}

TEST(CalibrationOfADescent, WeighsItsPrior) {
    study::DropTest test;
    test.name = "descent";
    test.clock_known = true;
    test.scalars.push_back({find_metric_row("descent_rate"), 8.0, 0.1});
    test.priors.push_back({drag_area, 42.0, 1.0});
    study::CalibrationSettings settings;
    settings.vary = {{drag_area, {}, {}}};
    const double alone = 2.0 * (152.4 + 5.19) * 9.80665 / (1.225 * 8.0 * 8.0),
                 sigma = 2.0 * 0.1 / 8.0 * alone;
    const double weight = 1.0 / (sigma * sigma);
    EXPECT_NEAR(calibrated({test}, settings).find(drag_area)->estimate,
                (weight * alone + 42.0) / (weight + 1.0), 0.005 * alone);
}

TEST(CalibrationFindsWhatIsWrong, TheScaleOfASensor) {
    SyntheticDrop drop;
    drop.scale = 1.06;
    const Calibration calibration = calibrated({drop.test()});
    EXPECT_TRUE(any_finding_says(calibration, "scale of the force sensor")) << what_is_found(calibration);
}

TEST(CalibrationFindsWhatIsWrong, AClockThatIsSaidToBeKnown) {
    SyntheticDrop drop;
    drop.offset = 0.2;
    const Calibration calibration = calibrated({drop.test()});
    ASSERT_EQ(calibration.findings.size(), 1u) << what_is_found(calibration);
    EXPECT_TRUE(any_finding_says(calibration, "clock looks wrong")) << what_is_found(calibration);
}

// A sensor off by a third drives the drag area to its bound, and a wrong clock would explain half of it: all
// of that is gone once the scale is right, so that the scale alone is a cause.
TEST(CalibrationFindsWhatIsWrong, TheLikeliestFaultAloneWithWhatFollowsFromIt) {
    for (const double scale : {0.7, 1.3}) {
        SyntheticDrop drop;
        drop.scale = scale;
        study::DropTest test = drop.test();
        *test.histories[0].sigma *= scale;  // 3 % of its own largest reading
        const Calibration calibration = calibrated({test});
        ASSERT_EQ(calibration.findings.size(), 1u) << what_is_found(calibration);
        const study::Finding& found = calibration.findings.front();
        EXPECT_NE(found.what.find("scale of the force sensor"), std::string::npos) << found.what;
        // 3 % of noise leave 1 % of the scale open.
        const double said = std::stod(found.what.substr(found.what.find("readings are ") + 13));
        EXPECT_NEAR(said, 100.0 * scale, 4.0 * scale) << found.what;
        const auto explains = [&](const char* words) {
            return std::ranges::any_of(found.explains, [&](const std::string& what) {
                return what.find(words) != std::string::npos;
            });
        };
        EXPECT_TRUE(explains("is on its bound")) << what_is_found(calibration);
        EXPECT_TRUE(explains("times their uncertainty")) << what_is_found(calibration);
    }
}

// Two faults, neither of which explains the other: both are named, the likelier first.
TEST(CalibrationFindsWhatIsWrong, TwoFaultsAtOnce) {
    SyntheticDrop drop;
    drop.scale = 1.06;
    drop.offset = 0.2;
    const Calibration calibration = calibrated({drop.test()});
    ASSERT_EQ(calibration.findings.size(), 2u) << what_is_found(calibration);
    EXPECT_TRUE(any_finding_says(calibration, "scale of the force sensor")) << what_is_found(calibration);
    EXPECT_TRUE(any_finding_says(calibration, "clock looks wrong")) << what_is_found(calibration);
}

TEST(CalibrationFindsWhatIsWrong, AnotherCanopy) {
    SyntheticDrop drop;
    drop.more = {"parachute.drag_area_law=power-1"};
    drop.drag_area = 60.0;
    const Calibration calibration = calibrated({drop.test()});
    EXPECT_TRUE(any_finding_says(calibration, "another shape")) << what_is_found(calibration);
    EXPECT_FALSE(any_finding_says(calibration, "scale of the force sensor")) << what_is_found(calibration);
}

TEST(CalibrationOfSeveralDrops, TellsScatterFromNoise) {
    std::vector<study::DropTest> alike, apart;
    for (const double n : {5.0, 5.5, 6.0}) {
        SyntheticDrop drop;
        drop.seed = static_cast<unsigned long>(10 * n);
        alike.push_back(drop.test());
        drop.n = n;
        apart.push_back(drop.test());
    }
    const Parameter one = *calibrated(alike).find(fill_constant),
                    other = *calibrated(apart).find(fill_constant);
    EXPECT_LT(*one.scatter, 0.005);
    EXPECT_NEAR(*other.scatter, 0.5 / 5.5, 0.02);  // standard deviation of 5, 5.5 and 6
    EXPECT_GT(other.interval.high - other.interval.low, 3.0 * (one.interval.high - one.interval.low));
}

// The short form of CalibrationCoverage: of 30 intervals at 95 %, fewer than 25 hold the truth in one case of
// two hundred (binomial), and a mean of 30 is beyond 0.6 sigma in one of a thousand.
TEST(CalibrationOfASyntheticDrop, IntervalsHoldTheTruth) {
    for (const Coverage& one : coverage_of(30, 1)) {
        EXPECT_GE(one.identified, 27) << one.parameter;
        EXPECT_GE(one.held_truth, one.identified - 5) << one.parameter;
        EXPECT_LT(std::abs(one.bias), 0.6) << one.parameter;
    }
}

// Ten readings of an opening: whatever is called identified holds its truth as often. An input that is held
// is not known for that: the intervals of the others once took it for known, and held 25 of 30.
TEST(CalibrationOfASyntheticDrop, IntervalsHoldTheTruthOfFewReadings) {
    for (const Coverage& one : coverage_of(30, 1, 0.3)) {
        EXPECT_GE(one.held_truth, one.identified - 4) << one.parameter;
    }
}

// A pulse between two readings can be anything: the output says that nothing of it was seen.
TEST(CalibrationOfASyntheticDrop, SaysWhereFewReadingsLieInTheFilling) {
    const auto says = [](const Calibration& calibration) {
        return std::ranges::any_of(calibration.notes, [](const std::string& note) {
            return note.find("readings lie within the filling") != std::string::npos;
        });
    };
    SyntheticDrop drop;
    const Calibration dense = calibrated({drop.test()});
    EXPECT_FALSE(says(dense));
    EXPECT_TRUE(dense.find(fill_constant)->identified);
    drop.step = 0.6;
    drop.length = 6.0;
    const Calibration sparse = calibrated({drop.test()});
    EXPECT_TRUE(says(sparse));
    EXPECT_FALSE(sparse.find(fill_constant)->identified);
    EXPECT_FALSE(sparse.find(initial_ratio)->identified);
    // A descent of three seconds knows the drag area, or says itself that it does not.
    EXPECT_EQ(sparse.find(drag_area)->why.find("readings"), std::string::npos);
}

TEST(CalibrationOfASyntheticDrop, IsTheSameAgain) {
    const Calibration one = calibrated({SyntheticDrop{}.test()}),
                      other = calibrated({SyntheticDrop{}.test()});
    for (std::size_t i = 0; i < one.parameters.size(); ++i) {
        EXPECT_EQ(one.parameters[i].estimate, other.parameters[i].estimate);
        EXPECT_EQ(one.parameters[i].interval.low, other.parameters[i].interval.low);
    }
}

}  // namespace
}  // namespace twinchute::test
