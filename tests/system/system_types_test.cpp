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

TEST_F(SystemTypes, WithArmsOrRibsAreRefusedByKey) {
    const auto before = tree_of(here_.path());
    for (const char* type : {"cross", "rotafoil", "guide-surface-ribbed"})
        for (const char* command : {"full", "compare", "ladder", "mesh"}) {
            const Ended ended = run(command, type);
            EXPECT_EQ(ended.code, 2) << command << ", " << type << ": " << ended.err;
            EXPECT_EQ(ended.out, "") << command;
            EXPECT_NE(ended.err.find("'parachute.type' ("), std::string::npos) << ended.err;
            EXPECT_NE(ended.err.find("`twinchute rom`"), std::string::npos) << ended.err;
        }
    EXPECT_EQ(tree_of(here_.path()), before);
    EXPECT_EQ(run("rom", "cross").code, 0);
}

TEST_F(SystemTypes, APlanNamesWhatIsLacking) {
    const Ended ended = run("plan", "cross", {"--json"});
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
