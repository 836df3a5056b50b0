// Inputs that the full model takes from a scene, and those that it must not: its mesh has the parachute's
// mass, a type of canopy is meshed or refused, the drag area may go by the Mach number.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "fullsim/fidelity.hpp"
#include "fullsim/mesh/start.hpp"
#include "lib/scene/read_scene.hpp"
#include "tests/support/c9_scene.hpp"
#include "tests/support/runs.hpp"

namespace twinchute {
namespace {

Scene coarse_scene() {
    Scene scene = test::c9_scene();
    scene.full.mesh = {1, 6, 4, 2};
    scene.stop = {Trigger::Kind::time, 0.1, 0.0};
    return scene;
}

const std::vector<double>& force(const RunRecord& record) {
    return record.find_channel("force_raw")->values;
}

bool warns(const RunRecord& record, const std::string& of) {
    return std::ranges::any_of(record.warnings, [&](const Warning& warning) {
        return (warning.what + ": " + warning.why).find(of) != std::string::npos;
    });
}

TEST(FullInputs, TheMassOfTheReducedOrderModelIsNotTheMeshs) {
    // The rows of two runs agree to the last bit, from the stretch of the lines at the start on.
    Scene light = coarse_scene(), heavy = coarse_scene();
    heavy.parachutes.front().mass = 60.0;
    const RunRecord one = test::run_full(light), other = test::run_full(heavy);
    ASSERT_GT(force(one).front(), 0.0);
    EXPECT_EQ(force(one), force(other));
    EXPECT_TRUE(warns(other, "kg, parachute.mass says 60.000 kg"));
    // A balance of mass fills by the mass of payload and parachute: the mesh's, too.
    for (Scene* scene : {&light, &heavy}) {
        FillTime& fill = scene->parachutes.front().fill_time;
        fill = {};
        fill.model = find_fill_time("ludtke");
        fill.balance.emplace();
    }
    EXPECT_EQ(force(test::run_full(light)), force(test::run_full(heavy)));
}

TEST(FullInputs, AScaledMassGoesAsThatOfTheMesh) {
    // Four times the diameter: the ratio of the scaled masses against that of the meshes, whose fabric, seams
    // and cords are what they are. Chords of a coarse mesh are alike in both but for a curved panel's.
    for (const char* design : {"usaf-c9", "conical-example", "biconical-example", "ringslot-example",
                               "extended-skirt-10-example", "annular-example", "cross-example"}) {
        const auto scene_of = [&](const std::vector<std::string>& more) {
            std::vector<std::string> keys{fmt::format("parachute.design='{}'", design)};
            keys.insert(keys.end(), more.begin(), more.end());
            return read_scene(TWINCHUTE_SOURCE_DIR "/data/scenes/c9-inflation.toml", keys);
        };
        const Scene made = scene_of({"full.contact='none'"});
        const double diameter = 4.0 * made.parachutes.front().nominal_diameter;
        const Scene large =
            scene_of({"full.contact='none'", fmt::format("parachute.nominal_diameter={}", diameter)});
        const double of_mesh =
            fullsim::built_mesh(large).parachute_mass() / fullsim::built_mesh(made).parachute_mass();
        EXPECT_NEAR(large.parachutes.front().mass / made.parachutes.front().mass / of_mesh, 1.0, 0.005)
            << design;
    }
}

TEST(FullInputs, ADiameterFarFromTheMeshsIsSaid) {
    // The C-9 settles at 0.65 of D0 (docs/generated/canopies.md), a coarse one at 0.6: 0.15 either way is
    // far.
    Scene scene = coarse_scene();
    scene.stop = {Trigger::Kind::time, 4.5, 0.0};
    const std::string says = "parachute.projected_diameter_ratio says";
    const RunRecord told = test::run_full(scene);
    ASSERT_TRUE(told.metric("projected_diameter_ratio"));
    EXPECT_FALSE(warns(told, says));
    scene.parachutes.front().projected_diameter_ratio = 0.5;
    EXPECT_TRUE(warns(test::run_full(scene), says + " 0.5"));
    scene.parachutes.front().projected_diameter_ratio = 0.8;
    EXPECT_TRUE(warns(test::run_full(scene), says + " 0.8"));
}

TEST(FullInputs, TheLinesAreStretchedByTheMassOfTheMesh) {
    // m_l D/(m_l + m_p) without added mass, D = q (C_D S)_i at release. The raw force of the first row is of
    // lines that carry just that; the canopy's fabric takes its share of the drag along: 2 %.
    Scene scene = coarse_scene();
    scene.aerodynamics = {};
    scene.parachutes.front().mass = 60.0;
    const double mass = fullsim::built_mesh(scene).parachute_mass();
    const double drag = 0.5 * 1.225 * 21.0 * 21.0 * 0.04 * 42.56;
    EXPECT_NEAR(force(test::run_full(scene)).front() / (drag * 152.4 / (152.4 + mass)), 1.0, 0.02);
}

TEST(FullInputs, AStandInForATypeIsSaid) {
    Scene scene = coarse_scene();
    CanopyType& type = scene.parachutes.front().type.emplace();
    type.title = "conical";
    type.meshed = {MeshedCanopy::Shape::flat_circular, "gores of a cone", {}, {}};
    EXPECT_TRUE(warns(test::run_full(scene), "a flat circular canopy stands in for a conical one: gores of"));
    type.meshed.shape = MeshedCanopy::Shape::own;
    EXPECT_FALSE(warns(test::run_full(scene), "stands in"));
}

TEST(FullInputs, ACanopyWhoseBreathingNothingDampsIsSaidToRing) {
    // And does: with the drag area prescribed, the force above the damped one's is ringing.
    Scene scene = test::c9_scene();
    scene.full.mesh = {2, 9, 5, 2};
    scene.stop = {Trigger::Kind::time, 2.5, 0.0};
    const auto peak = [&] { return *test::run_full(scene).metric("max_force_N"); };
    const auto says = [&] { return warns(test::run_full(scene), "nothing damps the canopy's breathing"); };
    const double damped = peak();
    EXPECT_FALSE(says());
    scene.aerodynamics.breathing_damping = 0.0;
    EXPECT_TRUE(says());
    EXPECT_GT(peak(), 1.1 * damped);
    scene.aerodynamics.breathing_damping.reset();
    EXPECT_TRUE(says());
    scene.full.alpha = 1.0;
    EXPECT_FALSE(says());
}

TEST(FullInputs, TheDragAreaGoesByTheMachNumber) {
    // Half the drag area is half the drag area, whichever way it is said: 0.5 changes no digit. One of 1
    // changes nothing.
    Scene scene = coarse_scene();
    scene.environment.atmosphere = {find_atmosphere("us76")};
    const RunRecord without = test::run_full(scene);
    Scene same = scene, by_mach = scene, half = scene;
    same.parachutes.front().drag_area_mach_table = MachDrag("m.csv", {0.0, 1.0}, {1.0, 1.0});
    by_mach.parachutes.front().drag_area_mach_table = MachDrag("m.csv", {0.0, 1.0}, {0.5, 0.5});
    half.parachutes.front().drag_area *= 0.5;
    EXPECT_EQ(force(test::run_full(same)), force(without));
    EXPECT_EQ(force(test::run_full(by_mach)), force(test::run_full(half)));
    EXPECT_NE(force(test::run_full(half)), force(without));
    // 21 m/s is Mach 0.0617 at 300 m, where sound goes at 339.1 m/s (US76); halfway to 0.1234 on a straight
    // line from 1 to 3 the factor is 2, and it falls with the speed.
    Scene rising = scene;
    rising.parachutes.front().drag_area_mach_table =
        MachDrag("m.csv", {0.0, 2.0 * 21.0 / 339.141}, {1.0, 3.0});
    const RunRecord record = test::run_full(rising);
    const auto& area = record.find_channel("drag_area")->values;
    EXPECT_NEAR(area.front() / without.find_channel("drag_area")->values.front(), 2.0, 1e-4);
    EXPECT_TRUE(record.metric("snatch_mach_number"));
    EXPECT_NEAR(*record.metric("snatch_mach_number"), 21.0 / 339.141, 1e-6);
}

TEST(FullInputs, LinesAreJudgedByTheirReynoldsNumber) {
    // rho v d/mu of 4 mm at the fastest, in 1.225 kg/m^3 with mu of 288.15 K (US76: 1.7894e-5 Pa s): 5750 at
    // the 21 m/s of the release, and it falls faster before the canopy fills.
    const RunRecord record = test::run_full(coarse_scene());
    const double fastest = std::ranges::max(record.find_channel("canopy_airspeed")->values);
    ASSERT_TRUE(record.metric("max_line_reynolds_number"));
    EXPECT_GT(fastest, 21.0);
    EXPECT_NEAR(*record.metric("max_line_reynolds_number") / (1.225 * fastest * 4e-3 / 1.7894e-5), 1.0, 1e-4);
    EXPECT_FALSE(warns(record, "cylinder drag"));
    // Cord of 0.7 m across the air is beyond Wieselsberger's 8.1e5.
    Scene thick = coarse_scene();
    thick.parachutes.front().line.diameter = 0.7;
    thick.parachutes.front().line.density *= 1e-4;
    thick.stop.value = 0.005;
    EXPECT_TRUE(warns(test::run_full(thick), "cylinder drag of the lines from 0.116 to 810000"));
}

}  // namespace
}  // namespace twinchute
