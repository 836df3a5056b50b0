// Cases that are run and judged: expected values from the law of the descent, v = sqrt(2 m g/(rho C_D S)),
// and from a synthetic model.
#include <gtest/gtest.h>

#include <cmath>

#include "compare/validate/report.hpp"
#include "compare/validate/run_suite.hpp"
#include "compare/validate/scatter_plot.hpp"
#include "lib/math/vec.hpp"
#include "rom/fidelity.hpp"
#include "tests/support/scratch_dir.hpp"

namespace twinchute::compare {
namespace {

/// Its only metric is the seed, or a line of the payload's mass.
RunRecord synthetic_run(const Scene& scene, Run&) {
    RunRecord record;
    const double seed = scene.full.noise ? static_cast<double>(scene.full.noise->seed) : 0.0;
    record.add_metric("peak_force_N", 100.0 + seed * seed);
    record.add_metric("impulse_N_s", 3.0 * scene.payload.mass);
    if (scene.payload.mass == 13.0) record.status = {StatusCode::strain_limit, "a line tore"};
    return record;
}
std::vector<std::string> lacks_nothing(const Scene&) {
    return {};
}
const Fidelity synthetic{"full", "synthetic model", synthetic_run, lacks_nothing};

class ValidateRun : public testing::Test {
protected:
    /// A canopy that is open and falls 10 kg in uniform air: steady at sqrt(2 m g/(rho C_D S)).
    ValidateRun() {
        here_.write("fall.toml", R"(schema = 1
name = "fall"
[environment]
atmosphere = { density = "1 kg/m^3" }
[payload]
mass = "10 kg"
[release]
height = "300 m"
speed = "10 m/s"
path_angle = "90 deg"
[[parachute]]
design = "usaf-c9"
drag_area = "2 m^2"
mass = 1e-9
deploy = { by = "inflated" }
fill_time = { n = 4 }
[stop]
height = "10 m"
)");
    }

    SuiteResult run(const std::string& cases, ValidationOptions options = {}) {
        here_.write("s.toml", "schema = 1\nname = \"s\"\ntitle = \"S\"\nevidence = \"measured\"\n" + cases);
        bool interrupted = false;
        const std::vector<const Fidelity*> fidelities{&rom::rom_fidelity(), &synthetic};
        return run_suite(read_suite(here_ / "s.toml"), fidelities, options, interrupted);
    }
    /// One case with these keys and a row.
    SuiteResult run_case(const std::string& keys, const std::string& row, ValidationOptions options = {}) {
        return run("[[case]]\nname = \"c\"\nsource = \"s\"\nbase = \"fall.toml\"\n" + keys + "\nrow = [{ " +
                       row + " }]\n",
                   options);
    }

    ScratchDir here_;
    const double speed_ = std::sqrt(2.0 * 10.0 * standard_gravity / 2.0);
};

TEST_F(ValidateRun, SaysOffsetsOfACaseInOneLine) {
    // 3 x 10 kg and 100 N of the synthetic model, against 28 N s and 104 N.
    const SuiteResult result =
        run("[[case]]\nname = \"c\"\nsource = \"s\"\nbase = \"fall.toml\"\nfidelities = [\"rom\", \"full\"]\n"
            "offsets = [\"impulse\", \"peak_force\"]\nrow = [\n"
            "{ quantity = \"peak_force\", expected = 104, judged = false, fidelities = [\"full\"] },\n"
            "{ quantity = \"impulse\", expected = 28, judged = false, fidelities = [\"full\"] } ]\n");
    ASSERT_EQ(result.offsets, std::vector<std::string>{"c, full: impulse +2 N s, peak force -4 N"});
    const Validation validation{{result}, false};
    EXPECT_NE(validation_markdown(validation, {}, "validate s").find("- c, full: impulse +2 N s, peak force"),
              std::string::npos);
    EXPECT_THROW(run("[[case]]\nname = \"c\"\nsource = \"s\"\nbase = \"fall.toml\"\noffsets = [\"impulse\"]\n"
                     "row = [{ quantity = \"peak_force\", expected = 104, judged = false }]\n"),
                 SceneError);
}

TEST_F(ValidateRun, AnExpectedValueIsWithinOrNot) {
    const std::string row = "quantity = \"fall_speed\", height = 20, tolerance = \"0.1 %\", expected = ";
    const SuiteResult right = run_case("", row + std::to_string(speed_));
    ASSERT_EQ(right.rows.size(), 1u);
    EXPECT_EQ(right.rows[0].verdict, RowVerdict::within);
    EXPECT_NEAR(*right.rows[0].predicted, speed_, 1e-4 * speed_);
    EXPECT_NEAR(*right.rows[0].tolerance, 1e-3 * speed_, 1e-6);
    const SuiteResult wrong = run_case("", row + std::to_string(1.01 * speed_));
    EXPECT_EQ(wrong.rows[0].verdict, RowVerdict::exceeded);
    EXPECT_NEAR(*wrong.rows[0].relative_error(), 1.0 / 1.01 - 1.0, 1e-4);
    EXPECT_TRUE((Validation{{right, wrong}, false}).failed());
    EXPECT_FALSE(
        (Validation{{right, wrong}, false, true}).failed());  // not exact, and exact ones alone decide
    SuiteResult exact = wrong;
    exact.evidence = Evidence::exact;
    EXPECT_TRUE((Validation{{right, exact}, false, true}).failed());
    EXPECT_FALSE((Validation{{right}, false}).failed());
    const SuiteResult counter_example = run_case("grade = \"D\"", row + "99");
    EXPECT_EQ(counter_example.rows[0].verdict, RowVerdict::not_judged);
}

TEST_F(ValidateRun, WhatARunDoesNotGiveIsExceeded) {
    const SuiteResult none =
        run_case("", "quantity = \"fall_speed\", height = 1, tolerance = 1, expected = 1");
    EXPECT_EQ(none.rows[0].verdict, RowVerdict::exceeded);
    EXPECT_EQ(none.rows[0].why, "the run does not give it");
    const SuiteResult failed = run_case("fidelities = [\"full\"]\nset = { \"payload.mass\" = 13 }",
                                        "quantity = \"impulse\", tolerance = 1, expected = 39");
    EXPECT_EQ(failed.rows[0].verdict, RowVerdict::exceeded);
    EXPECT_EQ(failed.rows[0].why, "strain_limit: a line tore");
    EXPECT_FALSE(failed.rows[0].predicted);
}

TEST_F(ValidateRun, WhatIsMissingIsListed) {
    const SuiteResult result =
        run("[[case]]\nname = \"a\"\nmissing = [\"mass\", \"type\"]\nsource = \"s\"\n"
            "row = [{ quantity = \"peak_force\", expected = 5, tolerance = 1 }]\n"
            "[[case]]\nname = \"b\"\nbase = \"fall.toml\"\ncanopy_type = \"disk_gap_band\"\nsource = \"s\"\n"
            "row = [{ quantity = \"peak_force\", expected = 5, tolerance = 1 }]\n"
            "[[case]]\nname = \"c\"\nshown_by = \"some_test.cpp\"\n");
    ASSERT_EQ(result.rows.size(), 3u);
    EXPECT_EQ(result.rows[0].verdict, RowVerdict::not_run);
    EXPECT_EQ(result.rows[0].why, "missing: mass, type");
    EXPECT_EQ(result.rows[1].verdict, RowVerdict::not_run);
    EXPECT_NE(result.rows[1].why.find("'disk_gap_band' are not in data/reference/parachute_types.csv"),
              std::string::npos);
    EXPECT_EQ(result.rows[2].verdict, RowVerdict::by_test);
    EXPECT_EQ(result.judged(), 0);
}

TEST_F(ValidateRun, SeedsGiveAMedianAndARangeOnAnyNumberOfThreads) {
    const std::string keys =
        "fidelities = [\"rom\", \"full\"]\nseeds = 6\nset = { \"full.noise.amplitude\" = 0.001 }";
    const std::string row =
        "quantity = \"peak_force\", fidelities = [\"full\"], tolerance = 0.1, expected = 112.5";
    const SuiteResult six = run_case(keys, row);
    ASSERT_EQ(six.rows.size(), 1u);            // the reduced-order model was not asked
    EXPECT_EQ(*six.rows[0].predicted, 112.5);  // 100 + the mean of 3^2 and 4^2
    EXPECT_EQ(*six.rows[0].low, 101.0);
    EXPECT_EQ(*six.rows[0].high, 136.0);
    EXPECT_EQ(six.rows[0].verdict, RowVerdict::within);
    ValidationOptions options;
    options.threads = 4;
    EXPECT_EQ(*run_case(keys, row, options).rows[0].predicted, 112.5);
    options.quick = true;
    EXPECT_EQ(*run_case(keys, row, options).rows[0].predicted, 101.0);
}

TEST_F(ValidateRun, UncertainInputsArePropagated) {
    // v ~ sqrt(m): 8 % of the mass are 4 % of the speed, at 200 samples to 5 % of that (four times held);
    // samples are cut off at three deviations (1.3 % less).
    const SuiteResult result = run_case(
        "uncertain = { \"payload.mass\" = \"8 %\" }",
        "quantity = \"fall_speed\", height = 20, sigma = \"3 %\", expected = " + std::to_string(speed_));
    EXPECT_NEAR(*result.rows[0].sigma_inputs / speed_, 0.04, 0.2 * 0.04);
    EXPECT_NEAR(*result.rows[0].sigma_measured / speed_, 0.03, 1e-9);
    EXPECT_NEAR(*result.rows[0].tolerance,
                2.0 * std::hypot(*result.rows[0].sigma_inputs, *result.rows[0].sigma_measured), 1e-12);
}

TEST_F(ValidateRun, ABracketedInputIsPredictedAtBothEnds) {
    // Impulse 3 m: 24 to 36 for 10 kg within 20 %, and one sigma beyond.
    const auto verdict = [&](const std::string& expected) {
        return run_case("fidelities = [\"full\"]\nbracket = { \"payload.mass\" = \"20 %\" }",
                        "quantity = \"impulse\", sigma = 2, expected = " + expected)
            .rows[0];
    };
    EXPECT_EQ(verdict("37.9").verdict, RowVerdict::within);
    EXPECT_EQ(verdict("38.1").verdict, RowVerdict::exceeded);
    EXPECT_EQ(verdict("22.1").verdict, RowVerdict::within);
    EXPECT_EQ(verdict("21.9").verdict, RowVerdict::exceeded);
    EXPECT_NEAR(*verdict("30").low, 24.0, 1e-12);
    EXPECT_NEAR(*verdict("30").high, 36.0, 1e-12);
}

TEST_F(ValidateRun, AFittedRowJudgesNothingButTheOthersDo) {
    // The mass at which the impulse is 60 N s is 20 kg; it falls at sqrt(2) times the speed.
    here_.write("s.toml", "");
    const SuiteResult result =
        run("[[case]]\nname = \"c\"\nsource = \"s\"\nbase = \"fall.toml\"\n"
            "fit = { key = \"payload.mass\", low = 1, high = 100 }\nrow = [\n"
            "{ quantity = \"fall_speed\", height = 20, expected = " +
            std::to_string(std::sqrt(2.0) * speed_) +
            ", sigma = 1 },\n{ quantity = \"fall_speed\", height = 30, expected = 1, tolerance = 0.1 }]\n");
    ASSERT_EQ(result.rows.size(), 2u);
    EXPECT_EQ(result.rows[0].verdict, RowVerdict::fitted);
    EXPECT_EQ(result.rows[0].why, "payload.mass = 20");
    EXPECT_EQ(result.rows[1].verdict, RowVerdict::exceeded);
    EXPECT_NEAR(*result.rows[1].predicted, std::sqrt(2.0) * speed_, 0.01);
    // Ends of a bracket lie about what was found, and about what the scene says where nothing was.
    const RowResult around =
        run("[[case]]\nname = \"c\"\nsource = \"s\"\nbase = \"fall.toml\"\n"
            "fit = { key = \"payload.mass\", low = 1, high = 100 }\n"
            "bracket = { \"payload.mass\" = \"19 %\" }\nrow = [\n"
            "{ quantity = \"fall_speed\", height = 20, expected = " +
            std::to_string(std::sqrt(2.0) * speed_) +
            ", sigma = 1 },\n{ quantity = \"fall_speed\", height = 30, expected = 1, sigma = "
            "0.1 }]\n")
            .rows[1];
    EXPECT_NEAR(*around.low, std::sqrt(2.0 * 0.81) * speed_, 0.01);
    EXPECT_NEAR(*around.high, std::sqrt(2.0 * 1.19) * speed_, 0.02);
    const SuiteResult hopeless = run_case("fit = { key = \"payload.mass\", low = 1, high = 2 }",
                                          "quantity = \"fall_speed\", height = 20, expected = 90, sigma = 1");
    EXPECT_EQ(hopeless.rows[0].verdict, RowVerdict::exceeded);  // no value meets it
    EXPECT_EQ(hopeless.rows[0].why, "no payload.mass from 1 to 2 gives the expected value");
}

TEST_F(ValidateRun, SharesAreSharesHoweverTheyAreSpelled) {
    for (const char* five : {"5 %", "5 percent", "5 Percent ", "5 % "})
        EXPECT_NEAR(
            *run_case("",
                      std::string("quantity = \"fall_speed\", height = 20, expected = 40, tolerance = \"") +
                          five + "\"")
                 .rows[0]
                 .tolerance,
            2.0, 1e-12)
            << five;
}

// A spread is over the size of the mean, whatever its sign; grades and sigma hold for trends as for numbers.
TEST_F(ValidateRun, TrendsAreJudgedAsNumbersAre) {
    here_.write("ser.toml",
                "base = \"fall.toml\"\nname = \"wind\"\nstop.at = \"ground\"\n"
                "[series]\nx = \"drift\"\ny = \"landing_east\"\n"
                "[[case]]\nname = \"a\"\nset = { \"environment.wind.speed\" = \"2 m/s\", "
                "\"environment.wind.from\" = \"90 deg\" }\n"
                "[[case]]\nname = \"b\"\nset = { \"environment.wind.speed\" = \"8 m/s\", "
                "\"environment.wind.from\" = \"90 deg\" }\n");
    const auto judged = [&](const std::string& keys) {
        return run("[[case]]\nname = \"c\"\nsource = \"s\"\nseries = \"ser.toml\"\nrow = [{ trend = "
                   "\"spread\", "
                   "y = \"landing_east\", " +
                   keys + " }]\n")
            .rows[0];
    };
    const RowResult west = judged("expected = 0, tolerance = 0.01");
    EXPECT_EQ(west.verdict, RowVerdict::exceeded);
    EXPECT_NEAR(west.predicted.value_or(0.0), 1.2, 0.1);  // (8 - 2)/5 of drifts that go with the wind
    EXPECT_EQ(judged("expected = 0, tolerance = 0.01, grade = \"D\"").verdict, RowVerdict::not_judged);
    EXPECT_EQ(judged("expected = 1.2, sigma = 0.1").verdict, RowVerdict::within);
}

TEST_F(ValidateRun, EveryLineOfATableIsARunAndTheWorstIsShown) {
    here_.write("t.csv", "# made up\nm,eta,I\n10,0,30\n20,0,61\n20,1,99\n");
    const SuiteResult result = run_case(
        "fidelities = [\"full\"]\ntable = \"t.csv\"\nonly = \"eta=0\"\ngiven = { m = { key = "
        "\"payload.mass\" } }",
        "quantity = \"impulse\", column = \"I\", tolerance = 0.5");
    ASSERT_EQ(result.rows.size(), 2u);
    EXPECT_EQ(result.rows[0].verdict, RowVerdict::within);
    EXPECT_EQ(result.rows[1].verdict, RowVerdict::exceeded);
    EXPECT_EQ(result.rows[1].line, 4);
    const std::vector<ShownRow> shown = shown_rows(result);
    ASSERT_EQ(shown.size(), 1u);
    EXPECT_EQ(shown[0].row, &result.rows[1]);
    EXPECT_EQ(shown[0].lines, 2);
    EXPECT_EQ(shown[0].within, 1);
}

TEST_F(ValidateRun, ARecordingGivesWhatIsExpected) {
    here_.write("r.csv", "time,height\ns,m\n0,200\n1,100\n2,0\n");  // 100 m/s
    const SuiteResult result =
        run_case("recording = \"r.csv\"", "quantity = \"fall_speed\", height = 50, tolerance = \"10 %\"");
    EXPECT_NEAR(*result.rows[0].expected, 100.0, 1e-9);
    EXPECT_EQ(result.rows[0].verdict, RowVerdict::exceeded);
}

TEST_F(ValidateRun, ABadSceneIsRefusedWithThePlaceOfItsCase) {
    const auto complaint = [&](const std::string& keys) -> std::string {
        try {
            run_case(keys, "quantity = \"peak_force\", expected = 1, tolerance = 1");
        } catch (const SceneError& error) {
            return error.what();
        }
        return "no complaint";
    };
    const std::string place = (here_ / "s.toml").string() + ":5:1: case 'c': ";
    EXPECT_TRUE(complaint("set = { \"payload.mas\" = 3 }").starts_with(place + "payload.mas: unknown key"));
    EXPECT_TRUE(complaint("set = { \"payload.mass\" = -3 }").starts_with(place + "payload.mass:"));
    EXPECT_NE(complaint("fidelities = [\"cfd\"]").find("there is no fidelity 'cfd'"), std::string::npos);
    EXPECT_NE(complaint("table = \"no.csv\"").find("there is no file 'no.csv'"), std::string::npos);
    EXPECT_NE(complaint("uncertain = { \"payload.drag_area\" = 1 }").find("is no number of this scene"),
              std::string::npos);
}

TEST_F(ValidateRun, HostileNamesStayText) {
    const std::string evil = "<script>alert(1)</script> | [x](y) \\u001b[2J";
    const std::string rows =
        "row = [{ quantity = \"impulse\", expected = 30, sigma = 1, group = \"<b>|\", note = \"" + evil +
        "\" }]\n";
    std::string cases;
    for (const char* name : {"1", "2", "3"})
        cases += "[[case]]\nname = \"" + evil + name + "\"\nbase = \"fall.toml\"\nsource = \"" + evil +
                 "\"\nfidelities = [\"full\"]\n" + rows;
    const Validation validation{{run(cases)}, false};
    const SuiteResult& suite = validation.suites.front();
    ASSERT_EQ(suite.groups().size(), 1u);
    const std::string svg = scatter_svg(suite, suite.groups().front());
    const std::string markdown = validation_markdown(validation, current_provenance(), "twinchute validate");
    for (const std::string& text : {svg, markdown, validation_terminal(validation, {})})
        EXPECT_EQ(text.find('\x1b'), std::string::npos) << text;
    for (const std::string& text : {svg, markdown})
        EXPECT_EQ(text.find("<script"), std::string::npos) << text;
    EXPECT_EQ(markdown.find("alert(1)</script> |"), std::string::npos);
    EXPECT_EQ(plot_name(suite, suite.groups().front()).find_first_of("<>|/"), std::string::npos);
}

TEST_F(ValidateRun, GroupsLeaveOutCounterExamplesAndFittedRows) {
    const std::string row = "row = [{ quantity = \"impulse\", expected = 30, sigma = 1, group = \"g\" }]\n";
    std::string cases;
    for (const char* grade : {"A", "B", "D"})
        cases += std::string("[[case]]\nname = \"") + grade +
                 "\"\nbase = \"fall.toml\"\nsource = \"s\"\ngrade = \"" + grade +
                 "\"\nfidelities = [\"full\"]\n" + row;
    const SuiteResult result = run(cases);
    ASSERT_EQ(result.groups().size(), 1u);
    EXPECT_EQ(result.groups()[0].rows.size(), 2u);
    EXPECT_FALSE(result.groups()[0].agreement);
}

}  // namespace
}  // namespace twinchute::compare
