// Test files as people have them, and what is wrong with them in words.
#include <gtest/gtest.h>

#include "lib/scene/logged_table.hpp"
#include "lib/scene/read_scene.hpp"
#include "lib/scene/scene_error.hpp"
#include "study/calibrate/drop_test.hpp"
#include "tests/support/scratch_dir.hpp"

namespace twinchute::test {
namespace {

using study::DropTest;

DropTest of_csv(const std::string& text) {
    return study::read_drop_test_csv(text, "drop.csv");
}

std::string complaint_of_csv(const std::string& text) {
    try {
        of_csv(text);
    } catch (const SceneError& error) {
        return error.what();
    }
    return "accepted";
}

using Numbers = std::vector<double>;

TEST(LoggedTest, ReadsWhatLoggersAndSpreadsheetsWrite) {
    for (const char* text : {
             "time,force\ns,kN\n0,1.5\n0.1,2\n",                        // a line of units
             "time [s],force [kN]\n0,1.5\n0.1,2",                       // in the names, no line feed
             "\"Time (ms)\";\"Force (kN)\"\r\n0;1,5\r\n100;2\r\n\r\n",  // quoted, ';', decimal comma
             "# rig 3\nt\tforce\n% units\ns\tkN\n0\t1,5\n\n# dropped\n0.1\t2\n",  // tabs, comments
             "\xEF\xBB\xBFtime,force,\n0,1500,\n0.1,2000,\n",                    // SI, a separator at the end
             "time,force,temperature [degC]\ns,N,\n0,1.5e3,20\n0.1,+2000,20\n",  // a column that is none
             "time,force\ns,N\n0,1500\n0.05,\n0.07,nan\n0.1,2000\n",             // readings that are missing
         }) {
        const DropTest test = of_csv(text);
        ASSERT_EQ(test.histories.size(), 1u) << text;
        EXPECT_EQ(test.histories[0].time, (Numbers{0.0, 0.1})) << text;
        EXPECT_EQ(test.histories[0].value, (Numbers{1500.0, 2000.0})) << text;
        EXPECT_FALSE(test.clock_known);
    }
}

TEST(LoggedTest, CountsAccelerationsInStandardGravities) {
    const DropTest test =
        of_csv("time,specific_force [g],acceleration [m/s^2],height [m]\n0,1,0,3\n1,2,4,5\n");
    EXPECT_EQ(test.histories[0].value, (Numbers{9.80665, 2 * 9.80665}));
    EXPECT_EQ(test.histories[1].value, (Numbers{0.0, 4.0}));
    EXPECT_EQ(test.histories[2].kind->channel, "altitude");  // once the ground of its scene is known
    EXPECT_EQ(test.histories[2].value, (Numbers{3.0, 5.0}));
}

TEST(LoggedTest, SaysWhatItLeavesAside) {
    const DropTest test = of_csv("time,force,forse\n0,1,1\n1,2,2\n");
    ASSERT_EQ(test.notes.size(), 1u);
    EXPECT_NE(test.notes[0].find("'forse'"), std::string::npos);
}

TEST(LoggedTest, SaysWhereItIsWrong) {
    const std::pair<const char*, const char*> cases[] = {
        {"time,force\n0,1\n0.1,x\n", "drop.csv:3:5: 'x' is not a number"},
        {"time,force\n0,1\n0.1\n", "drop.csv:3:1: 1 cells where the first line has 2"},
        {"time,force\n0,1\n0,2\n", "drop.csv:3:1: time does not rise"},
        {"time,force\n0,\"1\n1,2\n", "drop.csv:2:3: a quote is not closed"},
        {"force\n1\n2\n", "drop.csv:1:1: the column 'time' is missing"},
        {"time,load\n0,1\n1,2\n", "drop.csv:1:1: there is no history beside the time"},
        {"time,force,force\n0,1,1\n1,2,2\n", "drop.csv:1:12: the column 'force' stands here twice"},
        {"time,force\ns,m\n0,1\n1,2\n", "drop.csv:2:3: force: "},
        {"time,force\n0,inf\n1,2\n", "drop.csv:2:3: an infinite number"},
        {"time,force\n", "drop.csv:1:1: too few lines of numbers"},
        {"", "drop.csv:1:1: too few lines of numbers"},
        {"time,force\n-2,1\n-1,2\n0,3\n", "drop.csv:4:1: the history lies wholly before the release"},
    };
    for (const auto& [text, expected] : cases)
        EXPECT_TRUE(complaint_of_csv(text).starts_with(expected)) << complaint_of_csv(text) << "\n" << text;
}

DropTest of_toml(const std::string& text, const ScratchDir& folder) {
    return study::read_drop_test_toml(text, "drop.toml", folder.path());
}

TEST(DescribedTest, CarriesUncertaintyInstrumentConditionsAndPriors) {
    const ScratchDir folder;
    std::ofstream(folder / "drop.csv") << "time,force\ns,N\n0,100\n1,2000\n";
    const DropTest test = of_toml(R"(schema = 1
file = "drop.csv"
clock = "known"
set = { "payload.mass" = "120 kg", "release.speed" = 30 }
[force]
sigma = "3 %"
bandwidth = "50 Hz"
[max_deceleration]
value = "3 g0"
sigma = "10 %"
[[prior]]
key = "parachute.drag_area"
mean = "42 m^2"
sigma = "5 %"
)",
                                  folder);
    EXPECT_TRUE(test.clock_known);
    EXPECT_EQ(test.conditions, (std::vector<std::string>{"payload.mass='120 kg'", "release.speed=30"}));
    EXPECT_DOUBLE_EQ(*test.histories[0].sigma, 60.0);  // of the largest reading
    EXPECT_DOUBLE_EQ(*test.histories[0].bandwidth, 50.0);
    ASSERT_EQ(test.scalars.size(), 1u);
    EXPECT_NEAR(test.scalars[0].value, 3.0, 1e-12);
    EXPECT_NEAR(test.scalars[0].sigma, 0.3, 1e-12);
    ASSERT_EQ(test.priors.size(), 1u);
    EXPECT_DOUBLE_EQ(test.priors[0].sigma, 2.1);
}

TEST(DescribedTest, SaysWhereItIsWrong) {
    const ScratchDir folder;
    std::ofstream(folder / "drop.csv") << "time,force\ns,N\n0,100\n1,2000\n";
    const std::pair<const char*, const char*> cases[] = {
        {"schema = 1\n", "nothing was measured"},
        {"file = \"drop.csv\"\nclock = \"good\"\n", "drop.toml:2:9: clock: unknown word 'good'"},
        {"file = \"drop.csv\"\n[force]\nsigma = \"-1 N\"\n", "force.sigma: is negative"},
        {"file = \"drop.csv\"\n[force]\nsigma = 0\n", "force.sigma: is not positive"},
        {"file = \"drop.csv\"\n[force]\nbandwidth = \"50 m\"\n", "force.bandwidth: "},
        {"file = \"drop.csv\"\n[speed]\nsigma = 1\n", "speed: unknown key"},
        {"[peak_force]\nvalue = \"5 kN\"\n", "peak_force.sigma: is missing"},
        {"file = \"drop.csv\n", "is not TOML"},
    };
    for (const auto& [text, expected] : cases) {
        try {
            of_toml(text, folder);
            ADD_FAILURE() << text;
        } catch (const SceneError& error) {
            EXPECT_NE(std::string(error.what()).find(expected), std::string::npos) << error.what();
        }
    }
}

}  // namespace
}  // namespace twinchute::test
