// The ladder in the page of a comparison: found where both commands write by default, and only where it is of
// the same scene.
#include "tests/support/explanations.hpp"
#include "tests/support/short_scene.hpp"

namespace twinchute::test {
namespace {

class SystemLadderPage : public ShortScene {
protected:
    /// Without --out both write into scene.out.
    SystemLadderPage() { ladder_ = run({"ladder", "scene.toml", "--quick"}); }
    bool page_has(std::string_view part) const {
        return text("scene.out/report.html").find(part) != std::string::npos;
    }
    static bool has(const std::string& text, std::string_view part) {
        return text.find(part) != std::string::npos;
    }

    Ended ladder_;
    static constexpr std::string_view drawn = "All levels, and what they are held against";
};

TEST_F(SystemLadderPage, IsThereWhereBothAreOfOneScene) {
    ASSERT_EQ(ladder_.code, 0) << ladder_.err;
    EXPECT_FALSE(has(ladder_.out, "twinchute report")) << ladder_.out;  // there is no page yet
    const Ended compared =
        run({"compare", "scene.toml", "--tolerance", "peak_force=2000%", "--fields", "20"});
    EXPECT_EQ(compared.err, "");
    EXPECT_TRUE(has(compared.out, "ladder    ./scene.out/ladder.json is in the report\n")) << compared.out;
    EXPECT_TRUE(page_has(drawn));
    for (const auto& level : read("scene.out/ladder.json")["rungs"])
        EXPECT_TRUE(page_has("<th scope=\"row\">" + level["name"].get<std::string>() + "</th>"))
            << level["name"];
    const std::string page = text("scene.out/report.html"), ladder = text("scene.out/ladder.json");
    EXPECT_LT(page.size(), 3'000'000u);
    const Ended again = run({"report", "scene.out"});
    EXPECT_TRUE(has(again.out, "ladder    scene.out/ladder.json is in the report\n")) << again.out;
    EXPECT_EQ(text("scene.out/report.html"), page);
    EXPECT_EQ(text("scene.out/ladder.json"), ladder);
    // The other way round: a ladder that comes later says how it gets there.
    std::filesystem::remove(here_ / "scene.out/ladder.json");
    run({"report", "scene.out", "--quiet"});
    EXPECT_FALSE(page_has("id=\"ladder\""));
    const Ended later = run({"ladder", "scene.toml", "--quick"});
    EXPECT_TRUE(has(later.out, "report    twinchute report ./scene.out shows it in report.html\n"))
        << later.out;
    run({"report", "scene.out", "--quiet"});
    EXPECT_TRUE(page_has(drawn));
}

TEST_F(SystemLadderPage, OfAnotherSceneOrEditedIsNotShown) {
    const Ended heavier = run({"compare", "scene.toml", "--set", "payload.mass=160 kg"});
    EXPECT_EQ(heavier.code,
              run({"compare", "scene.toml", "--set", "payload.mass=160 kg", "--out", "alone"}).code);
    const std::string why =
        "it is of the scene with other inputs (payload.mass is 152.4 kg there and 160 kg here)";
    EXPECT_TRUE(has(heavier.out, "ladder.json is not in the report: " + why)) << heavier.out;
    EXPECT_TRUE(page_has("A ladder lies beside this comparison and is not shown: " + why));
    EXPECT_FALSE(page_has(drawn));

    here_.write("scene.toml", text("scene.toml") + "\n# another state of the file\n");
    run({"compare", "scene.toml", "--quiet"});
    EXPECT_TRUE(page_has("not shown: it is of another scene file, or of an earlier state of it (scene.toml"));

    std::string edited = text("scene.out/ladder.json");
    edited.replace(edited.find("rtol 1e-3"), 9, "<b>");
    here_.write("scene.out/ladder.json", edited);
    const auto before = files("scene.out");
    const Ended refused = run({"report", "scene.out"});
    EXPECT_EQ(refused.code, 2);
    EXPECT_TRUE(refused.err.starts_with("twinchute: scene.out/ladder.json: is not the file that was written"))
        << refused.err;
    EXPECT_EQ(files("scene.out"), before);
    // Runs are not lost for it.
    const Ended compared = run({"compare", "scene.toml"});
    EXPECT_EQ(compared.err, "");
    EXPECT_TRUE(page_has("is not the file that was written"));
    EXPECT_FALSE(page_has(drawn));
}

}  // namespace
}  // namespace twinchute::test
