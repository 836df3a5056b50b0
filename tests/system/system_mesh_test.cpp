// A mesh of one's own, as its user meets it: exported, run, drawn wrong. Promised: exit code 2 with file,
// line and tag, and nothing written, from every command that runs the full model; the reduced-order model
// needs no mesh.
#include <fstream>

#include "tests/support/mesh_sketch.hpp"
#include "tests/support/program_test.hpp"

namespace twinchute::test {
namespace {

const std::string c9 = shipped_scene("c9-inflation");
const Words coarse_mesh{"--set", "full.mesh.gore_columns=1",  "--set", "full.mesh.gore_rows=4",
                        "--set", "full.mesh.line_elements=4", "--set", "stop.time=0.3",
                        "--set", "full.contact=none"};

class SystemMesh : public ProgramTest {
protected:
    Ended run(const Words& words, const Words& more = {}) const { return ProgramTest::run(words + more); }
    /// The C-9 with a mesh from here.
    std::string own_scene(const std::string& mesh) const {
        here_.write("own.toml", "base = \"c9.toml\"\nname = \"own\"\n[[parachute]]\nmesh = \"" + mesh +
                                    "\"\n[full]\ncontact = \"none\"\n");
        std::ifstream from(c9);
        here_.write("c9.toml", {std::istreambuf_iterator<char>(from), {}});
        return "own.toml";
    }
    bool has(const std::string& name) const { return std::filesystem::exists(here_ / name); }
};

TEST_F(SystemMesh, AnExportRunsAsTheGeneratedMesh) {
    for (const std::string version : {"4.1", "2.2"}) {
        SCOPED_TRACE(version);
        const Ended written =
            run({"mesh", c9, "--out", "c9.msh", "--msh-version", version, "--quiet"}, coarse_mesh);
        ASSERT_EQ(written.code, 0) << written.err;
        std::ifstream file(here_ / "c9.msh");
        std::string line;
        std::getline(file, line), std::getline(file, line);
        EXPECT_EQ(line, version + " 0 8");
        const auto peak = [&](const std::string& scene) {
            const Ended ended = run({"full", scene, "--json"}, coarse_mesh);
            EXPECT_EQ(ended.code, 0) << ended.err;
            return json::parse(ended.out)["metrics"]["max_force_N"].get<double>();
        };
        // A smooth opening: differences are those of rounding, see ImportedMesh.FliesAsTheGeneratedOne.
        const double generated = peak(c9);
        EXPECT_NEAR(peak(own_scene("c9.msh")), generated, 1e-6 * generated);
    }
}

TEST_F(SystemMesh, OnlyOurOwnFilesAreOverwritten) {
    here_.write("c9.msh", MeshSketch().text());
    const Ended refused = run({"mesh", c9, "--out", "c9.msh"}, coarse_mesh);
    EXPECT_EQ(refused.code, 2);
    EXPECT_NE(refused.err.find("is no mesh of twinchute"), std::string::npos) << refused.err;
    EXPECT_EQ(run({"mesh", c9, "--out", "other.msh"}, coarse_mesh).code, 0);
    EXPECT_EQ(run({"mesh", c9, "--out", "other.msh"}, coarse_mesh).code, 0);
    EXPECT_EQ(run({"mesh", c9, "--out", "other.msh", "--msh-version", "3"}, coarse_mesh).code, 2);
    EXPECT_EQ(run({"mesh", c9, "--out", "other.stl"}, coarse_mesh).code, 2);
    // Lines of 4 m do not reach across a canopy of 4.27 m.
    const Ended flat =
        run({"mesh", c9, "--out", "flat.msh", "--set", "parachute.line_length=4"}, coarse_mesh);
    EXPECT_EQ(flat.code, 2);
    EXPECT_NE(flat.err.find("cannot be laid flat"), std::string::npos) << flat.err;
}

TEST_F(SystemMesh, AWrongMeshIsRefusedBeforeAnythingIsWritten) {
    MeshSketch sketch;
    sketch.element(22).nodes = {2, 4};
    const std::string text = sketch.text();
    here_.write("wrong.msh", text);
    const std::string scene = own_scene("wrong.msh");
    const auto line =
        1 + std::count(text.begin(), text.begin() + static_cast<long>(text.find("\n22 ")) + 1, '\n');
    const std::string says = fmt::format("wrong.msh:{}:1: line 22 is a tape off the canopy's edges", line);
    for (const Words& words : {Words{"full", scene, "--out", "o"}, Words{"compare", scene, "--out", "o"},
                               Words{"full", scene, "--check"}, Words{"plan", scene}, Words{"mesh", scene}}) {
        const Ended ended = run(words);
        EXPECT_EQ(ended.code, 2) << words[0];
        EXPECT_NE(ended.err.find(says), std::string::npos) << words[0] << ": " << ended.err;
        EXPECT_FALSE(has("o")) << words[0];
    }
    // It is no affair of the reduced-order model.
    EXPECT_EQ(run({"rom", scene, "--quiet"}).code, 0);
    // A mesh that is not there is the scene's mistake, whoever reads it.
    const Ended missing = run({"rom", own_scene("no-such.msh")});
    EXPECT_EQ(missing.code, 2);
    EXPECT_NE(missing.err.find("parachute.mesh: there is no no-such.msh"), std::string::npos) << missing.err;
}

TEST_F(SystemMesh, TheShippedExampleRunsOnTheLayoutForAnyMesh) {
    const std::string window = shipped_scene("c9-window");
    const Ended ended = run({"full", window, "--json", "--set", "stop.time=0.3"});
    ASSERT_EQ(ended.code, 0) << ended.err;
    const json record = json::parse(ended.out);
    EXPECT_NE(record["provenance"]["instruction_set"].get<std::string>().find("unstructured"),
              std::string::npos);
    EXPECT_GT(record["metrics"]["max_force_N"].get<double>(), 100.0);
}

}  // namespace
}  // namespace twinchute::test
