// Types of canopy that the full model cannot mesh. Promised: exit code 2, a message that names the key and
// the command that can run the scene, nothing written.
#include <string>
#include <vector>

#include "tests/support/program_test.hpp"

namespace twinchute::test {
namespace {

class SystemTypes : public ProgramTest {
protected:
    Ended run(const std::string& command, const std::string& type, const Words& more = {}) const {
        return ProgramTest::run(
            Words{command, shipped_scene("c9-inflation"), "--set", "parachute.type='" + type + "'"} + more);
    }
};

TEST_F(SystemTypes, WithRibsOrFullPanelsAreRefusedByKey) {
    const auto before = tree_of(here_.path());
    for (const char* type : {"rotafoil", "guide-surface-ribless", "guide-surface-ribbed"})
        for (const char* command : {"full", "compare", "ladder", "mesh"}) {
            const Ended ended = run(command, type);
            EXPECT_EQ(ended.code, 2) << command << ", " << type << ": " << ended.err;
            EXPECT_EQ(ended.out, "") << command;
            EXPECT_NE(ended.err.find("'parachute.type' ("), std::string::npos) << ended.err;
            EXPECT_NE(ended.err.find("`twinchute rom`"), std::string::npos) << ended.err;
        }
    EXPECT_EQ(tree_of(here_.path()), before);
    EXPECT_EQ(run("rom", "rotafoil").code, 0);
}

TEST_F(SystemTypes, APlanNamesWhatIsLacking) {
    const Ended ended = run("plan", "rotafoil", {"--json"});
    ASSERT_EQ(ended.code, 0) << ended.err;
    const json all = json::parse(ended.out);
    EXPECT_FALSE(all["plans"][0].contains("unsupported_keys"));
    EXPECT_EQ(all["plans"][1]["unsupported_keys"], json::array({"parachute.type"}));
}

TEST_F(SystemTypes, ASolidOneIsMeshedByItsOwnGores) {
    for (const char* type : {"conical", "extended-skirt-14", "hemispherical", "flat-circular"}) {
        const Ended ended = run("mesh", type, {"--json"});
        ASSERT_EQ(ended.code, 0) << ended.err;
        EXPECT_FALSE(json::parse(ended.out).contains("note")) << type;
    }
    EXPECT_NE(run("mesh", "conical", {"--json"}).out, run("mesh", "flat-circular", {"--json"}).out);
}

TEST_F(SystemTypes, ACrossIsMeshedFromItsOwnDesignAndRefusesAVent) {
    const Ended vented = run("mesh", "cross");  // the C-9's
    EXPECT_EQ(vented.code, 2);
    EXPECT_NE(vented.err.find("'parachute.vent_diameter' (a cross has no vent)"), std::string::npos)
        << vented.err;
    const Words design{"--set", "parachute.design='cross-example'", "--set", "full.contact='none'"};
    const auto of_design = [&](const Words& command, const Words& more) {
        return ProgramTest::run(command + Words{shipped_scene("c9-inflation")} + design + more);
    };
    const Ended mesh = of_design({"mesh"}, {});
    ASSERT_EQ(mesh.code, 0) << mesh.err;
    EXPECT_NE(mesh.out.find("two that cross, as cut"), std::string::npos) << mesh.out;
    EXPECT_NE(mesh.out.find("air passes between the arms unseen"), std::string::npos) << mesh.out;
    EXPECT_NE(of_design({"mesh"}, {"--out", "x.msh"}).err.find("name a .vtu file"), std::string::npos);
    const Ended plan = of_design({"plan"}, {"--json"});
    ASSERT_EQ(plan.code, 0) << plan.err;
    EXPECT_FALSE(json::parse(plan.out)["plans"][1].contains("unsupported_keys")) << plan.out;
}

TEST_F(SystemTypes, GapsAreNotedBesideTheMeshAndInTheRecord) {
    const Ended mesh = run("mesh", "disk-gap-band", {"--json"});
    ASSERT_EQ(mesh.code, 0) << mesh.err;
    EXPECT_NE(json::parse(mesh.out)["note"].get<std::string>().find("have gaps"), std::string::npos);
    const Ended full = run("full", "disk-gap-band", {"--json", "--set", "stop.at='peak-force'"});
    ASSERT_EQ(full.code, 0) << full.err;
    EXPECT_NE(full.out.find("air passes the gaps unseen"), std::string::npos) << full.out;
}

TEST_F(SystemTypes, SlotsAreNotedBesideTheMesh) {
    EXPECT_NE(run("mesh", "ringslot").err.find("it needs 'parachute.geometric_porosity'"), std::string::npos);
    const Ended ended = run("mesh", "ringslot", {"--json", "--set", "parachute.geometric_porosity=0.2"});
    ASSERT_EQ(ended.code, 0) << ended.err;
    EXPECT_NE(json::parse(ended.out)["note"].get<std::string>().find("slots are smeared"), std::string::npos)
        << ended.out;
}

}  // namespace
}  // namespace twinchute::test
