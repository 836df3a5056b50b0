// Reading suites and the tables that they name.
#include <gtest/gtest.h>

#include "compare/validate/suite.hpp"
#include "compare/validate/tables.hpp"
#include "tests/support/c9_scene.hpp"

namespace twinchute::compare {
namespace {

const std::string head = "schema = 1\nname = \"s\"\ntitle = \"S\"\nevidence = \"exact\"\n";
const std::string row =
    "row = [{ quantity = \"peak_force\", expected = \"5 kN\", tolerance = \"10 %\", source = \"a book\" }]\n";
const std::string one_case = "[[case]]\nname = \"c\"\nbase = \"x.toml\"\n" + row;

ValidationSuite read(const std::string& text) {
    return read_suite_text(text, "dir/s.toml");
}

std::string complaint(const std::string& text) {
    try {
        read(text);
    } catch (const SceneError& error) {
        return error.what();
    }
    return "no complaint";
}

TEST(ValidateSuite, ReadsWhatItSays) {
    const ValidationSuite suite = read(
        head + "about = \"text\"\n" +
        "[[case]]\nname = \"c\"\nbase = \"x.toml\"\nset = { \"payload.mass\" = \"80 kg\", \"release.speed\" "
        "= 21 }\n"
        "fidelities = [\"rom\", \"full\"]\nseeds = 7\nsource = \"a book\"\ngrade = \"B\"\nwhere = \"5.2\"\n"
        "uncertain = { \"release.speed\" = \"2 m/s\", \"parachute.drag_area\" = \"10 %\" }\n"
        "[[case.row]]\nquantity = \"mean_peak_load\"\nwindow = \"50 ms\"\nexpected = 12.9\nsigma = \"30 "
        "%\"\ngroup = \"g\"\n"
        "[[case.row]]\nquantity = \"max_deceleration\"\nexpected = \"4 g0\"\ntolerance = 1\ngrade = "
        "\"D\"\n");
    ASSERT_EQ(suite.cases.size(), 1u);
    const ValidationCase& one = suite.cases.front();
    EXPECT_EQ(one.scene, "base = 'x.toml'\n");
    EXPECT_EQ(one.set, (std::vector<std::string>{"payload.mass='80 kg'", "release.speed=21"}));
    EXPECT_EQ(one.seeds, 7);
    ASSERT_EQ(one.uncertain.size(), 2u);
    EXPECT_EQ(one.uncertain[0].first, "parachute.drag_area");
    EXPECT_TRUE(one.uncertain[0].second.relative);
    EXPECT_EQ(one.uncertain[1].second, (Tolerance{2.0, false}));
    ASSERT_EQ(one.rows.size(), 2u);
    EXPECT_EQ(one.rows[0].arguments.window, 0.05);
    EXPECT_EQ(one.rows[0].source, "a book");
    EXPECT_EQ(one.rows[0].where, "5.2");
    EXPECT_EQ(one.rows[0].sigma, (Tolerance{0.3, true}));
    EXPECT_EQ(*one.rows[1].expected, 4.0);
    EXPECT_EQ(one.rows[1].grade, "D");
}

TEST(ValidateSuite, RefusesWithFileLineAndKey) {
    const auto with = [](const std::string& key_line) {
        return head + "[[case]]\nname = \"c\"\nbase = \"x.toml\"\n" + key_line + row;
    };
    const auto with_row = [](const std::string& keys) {
        return head + "[[case]]\nname = \"c\"\nbase = \"x.toml\"\nrow = [{ " + keys + " }]\n";
    };
    const std::vector<std::pair<std::string, std::string>> wrong{
        {"schema = 1\nname = ", "dir/s.toml:2"},
        {"name = \"s\"\n" + one_case, "schema: is missing"},
        {head + "tittle = \"x\"\n" + one_case, "dir/s.toml:5:1: tittle: unknown key, did you mean 'title'?"},
        {head, "case: is missing"},
        {head + "case = []\n", "case: a list of tables belongs here"},
        {"schema = 1\nname = \"../s\"\ntitle = \"S\"\nevidence = \"exact\"\n" + one_case,
         "name: '../s' is not fit"},
        {"schema = 1\nname = \"s\"\ntitle = \"S\"\nevidence = \"seen\"\n" + one_case,
         "evidence: 'seen' is unknown"},
        {with("seeds = 0\n"), "dir/s.toml:8:9: case.seeds: a whole number from 1 to 1000"},
        {with("set = 3\n"), "case.set: a table belongs here"},
        {with("set = { payload = { mass = 3 } }\n"), "case.set: 'payload' is not a plain value"},
        {with("scene = { name = \"x\" }\n"), "case.scene: stands beside base"},
        {with("uncertain = { \"payload.mas\" = \"1 kg\" }\n"),
         "case.uncertain.payload.mas: 'payload.mas' is no number"},
        {with("uncertain = { \"payload.mass\" = \"1 m\" }\n"), "case.uncertain.payload.mass"},
        {with("bracket = { \"payload.mass\" = \"1 kg\" }\n"), "case.bracket.payload.mass"},
        {with("fit = { key = \"parachute.fill_time.n\", low = 5, high = 2 }\n"), "case.fit: low and high"},
        {with("calibrate = { vary = [\"payload.mass\"] }\n"), "case.calibrate.to: is missing"},
        {with("calibrate = { to = [] }\n"), "case.calibrate.to: "},
        {with("calibrate = { to = [\"a.csv\"] }\nfidelities = [\"full\"]\n"), "case.calibrate: goes with"},
        {with("calibrate = { to = [\"a.csv\"] }\nfit = { key = \"payload.mass\", low = 1, high = 2 }\n"),
         "case.calibrate: stands beside fit"},
        {with_row("quantity = \"peek_force\", expected = 1, tolerance = 1, source = \"s\""),
         "case.row.quantity: 'peek_force' is unknown, did you mean 'peak_force'?"},
        {with_row("quantity = \"peak_force\", expected = \"1 m\", tolerance = 1, source = \"s\""),
         "case.row.expected"},
        {with_row("quantity = \"peak_force\", expected = 1, source = \"s\""),
         "case.row.tolerance: is missing"},
        {with_row("quantity = \"peak_force\", tolerance = 1, source = \"s\""),
         "case.row.expected: is missing"},
        {with_row("quantity = \"peak_force\", expected = 1, tolerance = 1"), "case.row.source: is missing"},
        {with_row("quantity = \"peak_force\", expected = 1, tolerance = -1, source = \"s\""), "is negative"},
        {with_row("quantity = \"peak_force\", expected = nan, tolerance = 1, source = \"s\""),
         "is not finite"},
        {with_row("quantity = \"peak_force\", window = 1, expected = 1, tolerance = 1, source = \"s\""),
         "case.row.window: 'peak_force' does not depend on it"},
        {with_row("quantity = \"fall_time\", from = 1, expected = 1, tolerance = 1, source = \"s\""),
         "case.row.to: is missing"},
        {with_row("quantity = \"peak_force\", column = \"x\", tolerance = 1, source = \"s\""),
         "case.row.column: needs a table"},
        {head + "[[case]]\nname = \"c\"\n" + row, "case.base: is missing"},
        {head + "[[case]]\nname = \"c\"\nbase = \"x.toml\"\n", "case.row: is missing"},
    };
    for (const auto& [text, part] : wrong) {
        const std::string found = complaint(text);
        EXPECT_NE(found.find(part), std::string::npos) << text << "\n" << found;
        EXPECT_TRUE(found.starts_with("dir/s.toml:")) << found;
    }
}

TEST(ValidateSuite, WhatIsNotRunNeedsNoScene) {
    const ValidationSuite suite =
        read(head +
             "[[case]]\nname = \"c\"\nmissing = [\"mass\"]\n[[case]]\nname = \"d\"\nshown_by = \"t.cpp\"\n");
    EXPECT_EQ(suite.cases[0].missing, (std::vector<std::string>{"mass"}));
    EXPECT_EQ(suite.cases[1].shown_by, "t.cpp");
}

TEST(ValidateSuite, EveryShippedSuiteIsFoundAndRead) {
    const std::vector<std::string> names = suite_names();
    for (const std::string name : {"closed-forms", "structures", "paper", "measured"})
        EXPECT_NE(std::ranges::find(names, name), names.end()) << name;
    for (const std::string& name : names)
        EXPECT_EQ(read_suite(suite_file(name)).name, name);
    EXPECT_EQ(read_suite(suite_file("example/own-test")).evidence, Evidence::synthetic);
    EXPECT_THROW(suite_file("closed-form"), SceneError);
    EXPECT_THROW(suite_file("../scenes/c9-inflation"), SceneError);
}

TEST(ValidateTables, ReferenceTablesAreTextWithNumbers) {
    const ReferenceTable table = read_reference_table("# source\na,b\n1,x\r\n\n8 (reefed 6),\n", "t.csv");
    EXPECT_EQ(table.names, (std::vector<std::string>{"a", "b"}));
    ASSERT_EQ(table.lines.size(), 2u);
    EXPECT_EQ(table.numbers, (std::vector<int>{3, 5}));
    EXPECT_EQ(table.number(0, 0), 1.0);
    EXPECT_EQ(table.number(1, 0), 8.0);
    EXPECT_FALSE(table.number(0, 1));
    EXPECT_FALSE(table.number(1, 1));
    // A unit behind a number would be lost.
    EXPECT_FALSE(read_reference_table("a\n120 lb\n", "t.csv").number(0, 0));
    EXPECT_THROW(read_reference_table("a,b\n1\n", "t.csv"), SceneError);
    EXPECT_THROW(read_reference_table("# nothing\na,b\n", "t.csv"), SceneError);
}

TEST(ValidateTables, CanopyTypesGiveTheMiddleOfTheirRanges) {
    const ReferenceTable table = read_reference_table(
        "type,Dp_over_D0_lo,Dp_over_D0_hi,CD0_lo,CD0_hi,n_unreefed,j\n"
        "flat_circular,0.67,0.70,0.75,0.80,8,2\nconical,0.70,0.70,0.75,0.90,,2\n",
        "t.csv");
    const auto keys = canopy_type_keys(table, "flat_circular");
    ASSERT_TRUE(keys);
    EXPECT_EQ(*keys, (std::vector<std::string>{"parachute.fill_time.n=8", "parachute.drag_coefficient=0.775",
                                               "parachute.projected_diameter_ratio=0.685",
                                               "parachute.drag_area_law=power-2"}));
    EXPECT_FALSE(canopy_type_keys(table, "conical"));  // no fill constant
    EXPECT_FALSE(canopy_type_keys(table, "disk_gap_band"));
}

TEST(ValidateTables, RecordingsAreHistories) {
    Scene scene = test::c9_scene();
    scene.environment.ground = 100.0;
    const RunRecord record =
        read_recording("time,height,speed,force\nms,ft,ft/s,kN\n0,100,10,1\n500,90,10,2\n", "r.csv", scene);
    EXPECT_EQ(record.find_channel("time")->values, (std::vector<double>{0.0, 0.5}));
    EXPECT_NEAR(record.find_channel("altitude")->values[0], 130.48, 1e-9);
    EXPECT_NEAR(record.find_channel("vertical_speed")->values[0], -3.048, 1e-9);
    EXPECT_EQ(record.find_channel("force")->values[1], 2000.0);
    EXPECT_THROW(read_recording("time\ns\n0\n1\n", "r.csv", scene), SceneError);
    EXPECT_THROW(read_recording("time,force\ns,N\n0,1\n0,2\n", "r.csv", scene), SceneError);
}

}  // namespace
}  // namespace twinchute::compare
