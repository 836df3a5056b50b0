// Line ratio and forebody wake: what a scene's drag area becomes, and what is said of it. The figures
// themselves are readings, with 0.004 (Fig. 5-20) and one digitisation (Fig. 5-21) behind them: tests ask
// that the rows keep what they read, not that the figures are right.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lib/math/vec.hpp"
#include "lib/models/drag_correction.hpp"
#include "lib/scene/drag_area.hpp"
#include "lib/scene/write_scene.hpp"
#include "tests/unit/scene_text.hpp"

namespace twinchute::test {
namespace {

/// The C-9's lines and risers are 8.53 m, its own D0, to the digits given.
constexpr double c9_area = 42.56;

std::string with(const std::string& aerodynamics, const std::string& parachute = "") {
    return edited(edited(good_scene, "added_mass =", aerodynamics + "\nadded_mass ="),
                  "deploy =", parachute + "\ndeploy =");
}

std::string warnings_of(const Scene& scene) {
    std::string text;
    for (const Warning& warning : scene.warnings)
        text += warning.what + " (" + warning.why + ")\n";
    return text;
}

TEST(LineRatio, KnackeFig5_20) {
    // Own readings of the symbols of the 28-ft flat circular canopy in free flight.
    const LineRatioModel& row = *find_line_ratio("flat-circular");
    EXPECT_EQ(row.factor(0.62).value, 0.895);
    EXPECT_EQ(row.factor(1.20).value, 1.053);
    EXPECT_EQ(row.factor(1.40).value, 1.085);
    for (const LineRatioModel& model : line_ratio_models()) {
        EXPECT_EQ(model.factor(1.0).value, 1.0) << model.name;  // by the definition of the ordinate
        for (double x = 0.4; x < 2.0; x += 0.01)                // longer lines never cost drag
            EXPECT_LE(model.factor(x).value, model.factor(x + 0.01).value) << model.name << " " << x;
        EXPECT_FALSE(model.factor(0.5).inside) << model.name;
        EXPECT_FALSE(model.factor(2.0).inside) << model.name;
        EXPECT_TRUE(model.factor(1.1).inside) << model.name;
    }
}

TEST(ForebodyWake, KnackeFig5_21) {
    const ForebodyWakeModel& row = *find_forebody_wake("knacke");
    EXPECT_EQ(row.factor(5.0223, 1.0).value, 0.800);  // the digitised points that the row quotes
    EXPECT_EQ(row.factor(6.6632, 3.0).value, 0.921);
    for (const double size : {1.0, 1.5, 2.0, 3.0})
        for (double x = 1.2; x < 17.0; x += 0.1) {
            EXPECT_LT(row.factor(x, size).value, row.factor(x + 0.1, size).value) << x;  // farther costs less
            const double wider = std::min(size + 0.1, 3.0);
            EXPECT_LE(row.factor(x, size).value, row.factor(x, wider).value) << x;
            EXPECT_LT(row.factor(x, size).value, 1.0);
        }
    EXPECT_TRUE(row.factor(5.0, 2.0).inside);
    EXPECT_FALSE(row.factor(30.0, 2.0).inside);
    EXPECT_FALSE(row.factor(5.0, 4.0).inside);
    EXPECT_EQ(row.factor(5.0, 4.0).value, row.factor(5.0, 3.0).value);  // held, and said
}

TEST(DragArea, IsCorrectedByTheLines) {
    const Scene scene = read_text(with("line_ratio = {}", "line_length = 10.236\nriser_length = 1.706"));
    // (10.236 + 1.706)/8.53 = 1.4, whose reading is 1.085.
    EXPECT_NEAR(scene.parachutes.front().drag_area, c9_area * 1.085, 1e-9);
    EXPECT_EQ(stated_drag_area(scene.parachutes.front()), c9_area);
}

TEST(DragArea, IsCorrectedByTheWake) {
    const std::string text =
        edited(with("forebody_wake = {}"), "mass = \"152.4 kg\"", "mass = \"152.4 kg\"\ndiameter = 1.84817");
    const Scene scene = read_text(text);
    // D_p/D_B = 0.65 8.53/1.84817 = 3.0000 and L_T/D_B = 8.53/1.84817 = 4.6154, between the quoted points
    // (3.1757, 0.891) and (6.6632, 0.921) over the logarithm: 0.891 + 0.030
    // ln(4.6154/3.1757)/ln(6.6632/3.1757).
    const double factor = 0.891 + 0.030 * std::log(4.6154 / 3.1757) / std::log(6.6632 / 3.1757);
    EXPECT_NEAR(scene.parachutes.front().drag_area, c9_area * factor, 1e-4 * c9_area);
}

TEST(DragArea, IsLeftAloneUnlessAsked) {
    const Scene scene = read_text(good_scene);
    EXPECT_EQ(scene.parachutes.front().drag_area, c9_area);
    EXPECT_FALSE(scene.parachutes.front().uncorrected_drag_area);
    EXPECT_EQ(warnings_of(scene), "");
}

TEST(DragArea, IsNotCorrectedTwiceWhenItIsWritten) {
    const Scene scene = read_text(with("line_ratio = {}", "line_length = 9"));
    const Scene again = read_text(write_scene(scene));
    EXPECT_NE(again.parachutes.front().drag_area, c9_area);
    EXPECT_EQ(again.parachutes.front().drag_area, scene.parachutes.front().drag_area);
    EXPECT_TRUE(same_scene(scene, again));
}

TEST(DragArea, SaysWhatACorrectionNeeds) {
    EXPECT_NE(complaint(with("forebody_wake = {}")).find("payload.diameter: is missing"), std::string::npos);
}

TEST(DragArea, WarnsOfLinesThatAreFarFromTheDiameter) {
    const auto lines = [](const char* length) {
        return with("", std::string("type = \"flat-circular\"\nline_length = ") + length);
    };
    EXPECT_EQ(warnings_of(read_text(lines("7.31"))), "");
    // (5.4 + 1.22)/8.53 = 0.776: 0.895 + 0.105 (0.776 - 0.62)/0.38 = 0.938, more than 5 % off.
    EXPECT_NE(warnings_of(read_text(lines("5.4"))).find("line ratio 0.78"), std::string::npos);
    EXPECT_NE(warnings_of(read_text(lines("5.4"))).find("94 %"), std::string::npos);
    // A stated area of unknown origin without a type: nothing is said.
    EXPECT_EQ(warnings_of(read_text(with("", "line_length = 5.4"))), "");
    // Asked for, and beyond the figure.
    const Scene far = read_text(with("line_ratio = {}", "line_length = 14"));
    EXPECT_NE(warnings_of(far).find("lines beyond the figure"), std::string::npos);
    EXPECT_NEAR(far.parachutes.front().drag_area, c9_area * 1.085, 1e-12);
}

}  // namespace
}  // namespace twinchute::test
