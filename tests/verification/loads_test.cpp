// Loads of both models: the impulse of an opening, the margins to the materials' strengths.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <string_view>

#include "lib/scene/read_scene.hpp"
#include "tests/support/c9_scene.hpp"
#include "tests/support/runs.hpp"

namespace twinchute {
namespace {

/// A C-9 on a coarse mesh, to just after full open at 1.62 s.
Scene opening() {
    Scene scene = test::c9_scene();
    scene.full.mesh = {1, 6, 4, 2};
    scene.stop = {Trigger::Kind::time, 1.75, 0.0};
    return scene;
}

/// Without drag of its own and straight down, the payload has m (g - dv/dt) on its risers: from snatch to
/// full open their impulse is m (g t_f + v_s - v(t_f)), whatever the canopy does.
double momentum_given_up(const RunRecord& record, const Scene& scene) {
    const Event& open = *record.find_event("full-open");
    return scene.payload.mass * (scene.environment.gravity * open.time + scene.release.speed - open.speed);
}

TEST(Loads, TheImpulseIsTheMomentumThatThePayloadGivesUp) {
    const Scene scene = opening();
    const RunRecord rom = test::run_rom(scene), full = test::run_full(scene);
    // Simpson's rule on the pieces of steps that are exact to 1e-8.
    EXPECT_NEAR(*rom.metric("impulse_N_s") / momentum_given_up(rom, scene), 1.0, 1e-5);
    // 200 rows a second of a force that is averaged over 5 ms, and a payload node that carries half a riser
    // element: 0.5 x 5.8 g/m x 28 x 1.22 m/2 = 0.05 kg of 152.4 kg.
    EXPECT_NEAR(*full.metric("impulse_N_s") / momentum_given_up(full, scene), 1.0, 1e-3);
    for (const RunRecord* record : {&rom, &full})
        EXPECT_EQ(record->find_metric("impulse_N_s")->note,
                  "of the opening force, from snatch until the drag area is full");
}

/// First time at which the projected area is at `share` of its mean over the last 2 s, from the history's
/// rows.
double filled_at(const RunRecord& record, double share) {
    const std::vector<double>&time = record.find_channel("time")->values,
          &area = record.find_channel("projected_area")->values;
    double sum = 0, span = 0;
    for (std::size_t i = time.size() - 1; time[i - 1] >= time.back() - 2.0 - 1e-9; --i) {
        sum += 0.5 * (time[i] - time[i - 1]) * (area[i] + area[i - 1]);
        span += time[i] - time[i - 1];
    }
    const double level = share * sum / span;
    std::size_t i = 0;
    while (area[i] < level)
        ++i;
    return time[i - 1] + (time[i] - time[i - 1]) * (level - area[i - 1]) / (area[i] - area[i - 1]);
}

TEST(Loads, ACanopyIsFullAt98PercentOfItsSteadyArea) {
    Scene scene = opening();
    scene.stop.value = 4.0;
    for (const bool added_mass : {true, false}) {
        if (!added_mass) scene.aerodynamics.added_mass.reset();
        const RunRecord record = test::run_full(scene);
        // From a row to the next one, 5 ms later, a straight line is off by h^2/8 A''/A', 3e-5 s where the
        // growth A' changes tenfold in a second.
        EXPECT_NEAR(*record.metric("filling_time_s"), filled_at(record, 0.98), 3e-5) << added_mass;
        EXPECT_EQ(record.find_event("canopy-filled")->time, *record.metric("filling_time_s"));
        // Speed and altitude are read between two rows. At 25 ms the straight line is off by dt^2/8 of the
        // second derivative at most, 5 mm/s at 60 m/s^3; the next row alone, by up to 0.5 m/s.
        Scene rare = scene;
        rare.full.output_rate = 40;
        const RunRecord of_few_rows = test::run_full(rare);
        const Event fine = *record.find_event("peak-force"), coarse = *of_few_rows.find_event("peak-force");
        EXPECT_EQ(coarse.time, fine.time);
        EXPECT_NEAR(coarse.speed, fine.speed, 0.005);
        EXPECT_NEAR(coarse.altitude, fine.altitude, 0.005);
        // Read off steps. The steady area is a mean of rows, which a breath between them changes by 1e-5;
        // what that does to the time is docs/theory/filling-time.md's (dt/t)/(dp/p), 1.8 at most at 98 %.
        // Rows alone miss 1e-3 of an impulse.
        EXPECT_NEAR(*of_few_rows.metric("filling_time_s"), *record.metric("filling_time_s"), 3e-5);
        EXPECT_NEAR(*of_few_rows.metric("impulse_N_s"), *record.metric("impulse_N_s"),
                    1e-5 * *record.metric("impulse_N_s"));
        // docs/theory/filling-time.md: near the prescribed 1.625 s, with and without overshoot.
        EXPECT_NEAR(*record.metric("filling_time_s"), 1.625, 0.1 * 1.625) << added_mass;
    }
}

TEST(Loads, MarginsAreStrengthOverFactoredLoadLessOne) {
    Scene scene = opening();
    scene.stop.value = 0.3;  // any loads will do
    Parachute& chute = scene.parachutes.front();
    const RunRecord bare = test::run_full(scene);
    EXPECT_FALSE(bare.metric("line_strength_margin"));  // no strength, no margin
    EXPECT_FALSE(bare.metric("membrane_strength_margin"));
    EXPECT_FALSE(bare.metric("membrane_strength_margin_p90"));

    chute.line.strength = 1779.0;
    chute.fabric.strength = 7355.0;
    chute.strength = {0.8, 1.5};
    const RunRecord record = test::run_full(scene);
    const double tension = *record.metric("max_line_tension_N"),
                 stress = *record.metric("max_membrane_stress_N_m");
    EXPECT_EQ(tension, *bare.metric("max_line_tension_N"));  // factors judge loads, they change none
    ASSERT_GT(tension, 0);
    EXPECT_DOUBLE_EQ(*record.metric("line_strength_margin"), 1779.0 * 0.8 / (1.5 * tension) - 1);
    EXPECT_DOUBLE_EQ(*record.metric("membrane_strength_margin"), 7355.0 * 0.8 / (1.5 * stress) - 1);
    const double wide = *record.metric("membrane_stress_p90_N_m");
    EXPECT_GT(wide, 0.0);
    EXPECT_LT(wide, stress);
    EXPECT_DOUBLE_EQ(*record.metric("membrane_strength_margin_p90"), 7355.0 * 0.8 / (1.5 * wide) - 1);
    EXPECT_EQ(record.find_metric("line_strength_margin")->note,
              "strength 1779 N, joint efficiency 0.8, design factor 1.5");
    EXPECT_FALSE(test::run_rom(scene).metric("line_strength_margin"));  // it has no lines to pull on

    // Lines or fabric that would have broken are said; with these strengths none would.
    const auto broken = [](const RunRecord& of) {
        return std::ranges::count_if(of.warnings, [](const Warning& warning) {
            return warning.what.find("would have broken") != std::string::npos;
        });
    };
    EXPECT_EQ(broken(record), 0);
    chute.line.strength = 0.9 * 1.5 / 0.8 * tension;
    chute.fabric.strength = 0.9 * 1.5 / 0.8 * wide;
    const RunRecord weak = test::run_full(scene);
    EXPECT_NEAR(*weak.metric("line_strength_margin"), -0.1, 1e-12);
    EXPECT_EQ(broken(weak), 2);
}

bool warns(const RunRecord& record, std::string_view what) {
    return std::ranges::any_of(record.warnings, [&](const Warning& warning) {
        return warning.what.find(what) != std::string::npos;
    });
}

// Thrown up at 25 m/s under a canopy that opens within 3 s: the payload comes to rest, and falls past it.
TEST(Loads, APayloadThatOvertakesItsCanopyIsSaid) {
    const auto thrown = [](const char* angle) {
        return read_scene(
            TWINCHUTE_SOURCE_DIR "/data/scenes/c9-inflation.toml",
            {std::string("release.path_angle='") + angle + "'", "release.speed='25 m/s'",
             "full.mesh={gore_columns=2,gore_rows=7,line_elements=8}", "full.contact='none'", "stop.time=4"});
    };
    EXPECT_TRUE(warns(test::run_full(thrown("-80 deg")), "the lines were slack for"));
    EXPECT_FALSE(warns(test::run_full(thrown("80 deg")), "the lines were slack for"));
    EXPECT_TRUE(warns(test::run_rom(thrown("-80 deg")), "opens while the payload climbs"));
    EXPECT_FALSE(warns(test::run_rom(thrown("-20 deg")), "opens while the payload climbs"));
}

// Half a diameter ahead of the filling takes 4.3 s at 1 m/s, in which the payload falls ever faster.
TEST(Loads, APredictedFillingThatBeginsTooSlowlyIsSaid) {
    const auto released = [](const char* speed) {
        return test::run_rom(read_scene(TWINCHUTE_SOURCE_DIR "/data/scenes/c9-predicted.toml",
                                        {std::string("release.speed=") + speed}));
    };
    EXPECT_TRUE(warns(released("1"), "too slow for a predicted filling"));
    EXPECT_FALSE(warns(released("21"), "too slow for a predicted filling"));
}

}  // namespace
}  // namespace twinchute
