// Keys of a predicted filling: what they stand in place of, what they need, and what is refused.
#include <gtest/gtest.h>

#include <algorithm>

#include "fullsim/fidelity.hpp"
#include "lib/scene/write_scene.hpp"
#include "rom/plan.hpp"
#include "rom/run_rom.hpp"
#include "tests/unit/scene_text.hpp"

namespace twinchute::test {
namespace {

const std::string told = R"(fill_time = { model = "fill-constant", n = 4.0 })";

std::string predicted_text(const std::string& keys = "filling = \"predicted\"") {
    return edited(good_scene, told, keys);
}

TEST(SceneFilling, OneWordIsShortForTheTable) {
    const Filling brief = read_text(predicted_text()).parachutes.front().filling;
    const Filling whole =
        read_text(predicted_text("filling = { model = \"predicted\", initial_mouth = 0.005, "
                                 "entrance_loss = 2, lowest_mouth = \"0.2 %\", "
                                 "highest_mouth = \"4 %\" }"))
            .parachutes.front()
            .filling;
    EXPECT_EQ(brief, whole);
    EXPECT_EQ(brief.model, find_filling("predicted"));
    EXPECT_EQ(
        read_text(predicted_text("filling = { initial_mouth = 0.01 }")).parachutes.front().filling.model,
        brief.model)
        << "its parameters imply it";
    EXPECT_FALSE(read_text(good_scene).parachutes.front().filling.is_predicted());
    EXPECT_FALSE(
        read_text(good_scene, {"parachute.filling=prescribed"}).parachutes.front().filling.is_predicted());
}

TEST(SceneFilling, SceneThatPrescribesAsWellIsRefused) {
    for (const char* key :
         {"drag_area_law = \"ludtke\"", "initial_drag_area_ratio = 0.04", "initial_phase = \"transit\"",
          "drag_area_table = \"growth.csv\"", "fill_time = { n = 4 }", "fill_time = { time = \"1 s\" }"}) {
        const std::string text = predicted_text("filling = \"predicted\"\n" + std::string(key));
        const std::string says = complaint(text);
        EXPECT_NE(says.find("test.toml:15:"), std::string::npos) << says;
        EXPECT_NE(says.find("is not used (parachute.filling is 'predicted'"), std::string::npos) << says;
        EXPECT_NE(says.find("filling = \"prescribed\""), std::string::npos) << says;
    }
}

TEST(SceneFilling, WhatIsLaidAboveDecides) {
    const Scene predicted = read_text(good_scene, {"parachute.filling=predicted"});
    EXPECT_TRUE(predicted.parachutes.front().filling.is_predicted());
    EXPECT_EQ(find_input(predicted, "parachute.fill_time.n"), nullptr) << "no input that nothing reads";
    const Scene told_again = read_text(predicted_text(), {"parachute.fill_time.n=5"});
    EXPECT_FALSE(told_again.parachutes.front().filling.is_predicted());
    EXPECT_EQ(told_again.parachutes.front().fill_time.n, 5.0);
}

TEST(SceneFilling, WhatADesignPrescribesIsLeftOutByName) {
    const Scene scene = read_text(predicted_text("filling = \"predicted\"\ntype = \"flat-circular\""));
    ASSERT_EQ(scene.overridden, std::vector<std::string>{"parachute.type"});
    const auto parts = rom::parts_of(scene);
    EXPECT_TRUE(std::ranges::any_of(
        parts, [](const PlanPart& part) { return part.name == "parachute.type" && !part.needed; }));
}

TEST(SceneFilling, NeedsLinesAndFabric) {
    const auto refused = [](const std::string& keys, const char* key, const char* problem) {
        const std::string says = complaint(predicted_text("filling = \"predicted\"\n" + keys));
        EXPECT_NE(says.find(std::string(key) + ": "), std::string::npos) << says;
        EXPECT_NE(says.find(problem), std::string::npos) << says;
    };
    refused("line_length = \"1 m\"", "parachute.line_length", "lines and risers of 0.26");
    refused("drag_area_mach_table = \"mach.csv\"", "parachute.drag_area_mach_table", "");
    const std::string bare =
        edited(edited(predicted_text(), "design = \"usaf-c9\"",
                      "nominal_diameter = 8\ndrag_area = 40\nmass = 5\n"
                      "projected_diameter_ratio = 0.65\nline_length = 8\nriser_length = 1"),
               "name = \"test\"", "name = \"bare\"");
    EXPECT_NE(complaint(bare).find("parachute.permeability: is missing"), std::string::npos)
        << complaint(bare);
    EXPECT_EQ(complaint(bare, {"parachute.permeability=0"}), "");
    EXPECT_EQ(complaint(bare, {"parachute.filling=wolf"}), "") << "that one knows no fabric";
    EXPECT_NE(
        complaint(bare, {"parachute.permeability=0", "parachute.deploy.by=inflated"}).find("does not fill"),
        std::string::npos);
    EXPECT_NE(complaint(bare, {"parachute.permeability=0", "parachute.filling.initial_mouth=0.2"})
                  .find("0.2 is outside its bracket"),
              std::string::npos);
}

TEST(SceneFilling, PermeabilityIsALawOrOnePoint) {
    const Scene fitted = read_text(predicted_text());
    EXPECT_EQ(fitted.parachutes.front().fabric.permeability, (Permeability{254.4, 37.6}));
    const Scene point = read_text(predicted_text(), {"parachute.permeability='90 cfm/ft2'"});
    EXPECT_NEAR(*point.parachutes.front().permeability, 0.4572, 1e-12);
}

TEST(SceneFilling, ComesBackFromWhatIsWritten) {
    const Scene scene =
        read_text(predicted_text("filling = { model = \"mass-balance\", initial_mouth = 0.01 }\n"
                                 "permeability = 0.3\ngeometric_porosity = \"5 %\""));
    const std::string text = write_scene(scene);
    EXPECT_TRUE(same_scene(scene, read_text(text))) << text;
}

TEST(SceneFilling, FullModelRefusesWhatItDoesNotPredictByItsKey) {
    const auto lacks = [](const std::string& text) {
        return fullsim::full_fidelity().unsupported_keys(read_text(text));
    };
    using Keys = std::vector<std::string>;
    EXPECT_EQ(lacks(predicted_text()), Keys{});
    EXPECT_EQ(lacks(predicted_text("filling = { model = \"wolf\" }")), Keys{"parachute.filling.model"});
    EXPECT_EQ(lacks(predicted_text("filling = { model = \"mass-balance\" }")),
              Keys{"parachute.filling.model"});
    EXPECT_EQ(lacks(predicted_text("filling = \"predicted\"\n"
                                   "reefing = [{ drag_area_ratio = 0.3, line_length = \"3 m\", until = { at "
                                   "= \"line-stretch\", delay = \"1 s\" } }]")),
              Keys{});
}

TEST(SceneFilling, RefusesAReefingLineThatDoesNotGoRoundTheMouth) {
    // pi D_p sqrt(0.04): 0.2 of the steady circumference.
    const auto with_line = [](double length) {
        return predicted_text(
            "filling = { model = \"predicted\", initial_mouth = 0.04 }\nreefing = [{ "
            "drag_area_ratio = 0.3, line_length = \"" +
            std::to_string(length) + " m\", until = { at = \"line-stretch\", delay = \"1 s\" } }]");
    };
    const Parachute chute = read_text(with_line(9.0)).parachutes.front();
    const double around = 0.2 * pi * chute.projected_diameter_ratio * chute.nominal_diameter;
    EXPECT_NO_THROW(read_text(with_line(1.001 * around)));
    EXPECT_THROW(read_text(with_line(0.999 * around)), SceneError);
}

}  // namespace
}  // namespace twinchute::test
