// The rest of a fall by another model: where the same model goes on nothing may change, and where the
// reduced-order one takes over from the full one the landing hangs on how far apart their descents are.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "fullsim/fidelity.hpp"
#include "lib/scene/read_scene.hpp"
#include "lib/solve/hand_over.hpp"
#include "rom/fidelity.hpp"

namespace twinchute {
namespace {

const std::array<const Fidelity*, 2> both{&rom::rom_fidelity(), &fullsim::full_fidelity()};

RunRecord fly(const Fidelity& fidelity, const std::string& file, const std::vector<std::string>& more) {
    Run run;
    return run_scene(fidelity, read_scene(std::string(TWINCHUTE_SOURCE_DIR) + "/data/scenes/" + file, more),
                     run, both);
}

double at_end(const RunRecord& record, const char* channel) {
    return record.find_channel(channel)->values.back();
}

TEST(HandOver, FromTheReducedOrderModelToItselfChangesNothing) {
    // The continued run begins in the state that the whole one passes: what differs is the tolerance of two
    // integrations, set to 1e-8 each, a hundred times that is allowed; and of the velocity across, which is
    // found from the last five places: rows 25 ms apart and a speed that settles in 0.4 s leave 1e-4 m/s,
    // which are gone after 0.4 s: 1e-4 m is allowed. Steady and just open; in wind that turns with height, in
    // a wind across, straight down, reefed, after a drogue that is cut, and with one that stays.
    for (const char* file : {"c9-drift.toml", "c9-crosswind.toml", "c9-inflation.toml", "c9-reefed.toml",
                             "c9-drogue.toml", "rocket-dual-deploy.toml"})
        for (const char* stop : {"stop.at='steady-descent'", "stop.at='full-open'"}) {
            SCOPED_TRACE(std::string(file) + ", " + stop);
            const std::string tight = "rom.rtol=1e-8";
            const RunRecord whole = fly(rom::rom_fidelity(), file, {"stop.at='ground'", tight}),
                            two = fly(rom::rom_fidelity(), file, {stop, "stop.then='rom'", tight});
            ASSERT_EQ(two.status.code, StatusCode::completed) << two.status.detail;
            ASSERT_TRUE(two.handed_over);
            // A fifth of the fall is left at least; the crosswind descends steadily after three fourths.
            EXPECT_LT(two.handed_over->time, 0.8 * at_end(two, "time"));
            EXPECT_NEAR(*two.metric("flight_time_s"), *whole.metric("flight_time_s"),
                        1e-6 * *whole.metric("flight_time_s"));
            for (const char* key : {"landing_east_m", "landing_north_m"})
                EXPECT_NEAR(*two.metric(key), *whole.metric(key), 1e-4) << key;
            EXPECT_NEAR(two.find_event("ground")->speed, whole.find_event("ground")->speed, 1e-5);
            // That of the last second: before the hand-over, or before the ground in both.
            if (std::string(stop) == "stop.at='full-open'") {
                EXPECT_NEAR(*two.metric("descent_rate_m_s"), *whole.metric("descent_rate_m_s"), 1e-6);
            }
        }
}

struct Landing {
    double time, drift;
};

Landing landing_of(const RunRecord& record) {
    return {*record.metric("flight_time_s"),
            std::hypot(*record.metric("landing_east_m"), *record.metric("landing_north_m"))};
}

/// The full model all the way down, and as far as the steady descent.
void expect_same_landing(const std::vector<std::string>& more) {
    std::vector<std::string> all_of_it = more, part = more;
    all_of_it.emplace_back("stop.at='ground'");
    part.insert(part.end(), {"stop.at='steady-descent'", "stop.then='rom'"});
    const RunRecord whole = fly(fullsim::full_fidelity(), "c9-crosswind.toml", all_of_it),
                    handed = fly(fullsim::full_fidelity(), "c9-crosswind.toml", part);
    ASSERT_EQ(whole.status.code, StatusCode::completed) << whole.status.detail;
    ASSERT_EQ(handed.status.code, StatusCode::completed) << handed.status.detail;
    const Landing a = landing_of(whole), b = landing_of(handed);
    // Both fall with the scene's drag area; their descent rates differ by 0.1 % (docs/verification.md).
    EXPECT_NEAR(b.time, a.time, 0.005 * a.time);
    EXPECT_NEAR(b.drift, a.drift, 0.01 * a.drift);
    EXPECT_LT(handed.cost.steps, whole.cost.steps);
}

TEST(HandOver, FromTheFullModelLandsWhereThatWouldHave) {
    expect_same_landing({"release.height='200 m'", "full.mesh.gore_rows=6", "full.mesh.gore_columns=1",
                         "full.mesh.line_elements=4"});
}

TEST(HandOver, MakesOneRecordThatSaysWhatIsWhose) {
    const std::vector<std::string> coarse{"full.mesh.gore_rows=4", "full.mesh.gore_columns=1",
                                          "full.mesh.line_elements=3", "stop.at='full-open'",
                                          "stop.then='rom'"};
    const RunRecord record = fly(fullsim::full_fidelity(), "c9-crosswind.toml", coarse);
    ASSERT_EQ(record.status.code, StatusCode::completed);
    const double then = record.handed_over->time;
    EXPECT_EQ(record.handed_over->to, "rom");
    EXPECT_EQ(record.status.detail.find("ground reached, by rom from t = "), 0u) << record.status.detail;
    // One time, rising throughout; one set of columns; what only the full model has is unknown after it.
    const std::vector<double>& time = record.find_channel("time")->values;
    ASSERT_TRUE(std::ranges::is_sorted(time));
    for (const Channel& channel : record.channels)
        ASSERT_EQ(channel.values.size(), time.size()) << channel.name;
    const std::size_t first = static_cast<std::size_t>(std::ranges::upper_bound(time, then) - time.begin());
    ASSERT_LT(first, time.size());
    EXPECT_TRUE(std::isnan(record.find_channel("projected_area")->values[first]));
    EXPECT_FALSE(std::isnan(record.find_channel("projected_area")->values[first - 1]));
    for (const char* goes_on : {"altitude", "east", "north", "speed", "vertical_speed", "force", "drag_area"})
        EXPECT_TRUE(std::isfinite(record.find_channel(goes_on)->values[first])) << goes_on;
    // Place and speed go on from where they were: by no more than one row of this moves.
    for (const char* smooth : {"altitude", "east", "north"}) {
        const std::vector<double>& x = record.find_channel(smooth)->values;
        EXPECT_NEAR(x[first], x[first - 1], 25.0 * (time[first] - time[first - 1])) << smooth;
    }
    const Event* event = record.find_event("handed-over");
    ASSERT_NE(event, nullptr);
    EXPECT_EQ(event->time, then);
    EXPECT_EQ(record.events.back().name, "ground");
    EXPECT_TRUE(std::ranges::is_sorted(record.events, {}, &Event::time));
    for (const std::string& key : record.handed_over->metrics) {
        EXPECT_EQ(record.find_metric(key)->note.find("by rom from t = "), 0u) << key;
    }
    EXPECT_EQ(record.handed_over->metrics,
              (std::vector<std::string>{"flight_time_s", "landing_east_m", "landing_north_m",
                                        "landing_vertical_speed_m_s", "landing_energy_J", "descent_rate_m_s",
                                        "descent_rate_amplitude", "descent_rate_remaining_change",
                                        "descent_altitude_m", "altitude_loss_m", "drift_m"}));
    EXPECT_NEAR(
        *record.metric("drift_m"),
        std::hypot(record.find_channel("east")->values.back(), record.find_channel("north")->values.back()),
        1e-9);
    EXPECT_NEAR(*record.metric("altitude_loss_m"), 100.0 - *record.metric("descent_altitude_m"), 1e-9);
    EXPECT_EQ(*record.metric("flight_time_s"), time.back());
}

TEST(HandOver, IsNotMadeFromACanopyThatIsNotOpen) {
    const RunRecord record =
        fly(fullsim::full_fidelity(), "c9-inflation.toml",
            {"full.mesh.gore_rows=4", "full.mesh.gore_columns=1", "stop.time=0.3", "stop.then='rom'"});
    EXPECT_EQ(record.status.code, StatusCode::completed);
    EXPECT_FALSE(record.handed_over);
    EXPECT_FALSE(record.metric("flight_time_s"));
    ASSERT_FALSE(record.warnings.empty());
    EXPECT_EQ(record.warnings.back().what, "the fall was not handed over to rom");
}

TEST(HandOver, OfACanopyThatOverInflatesWaitsUntilItHasSettled) {
    // Open at first at 1, 1.3 times the steady drag area at 1.3, steady from 2 fillings on: what goes on with
    // the steady drag area must not begin before.
    Scene scene = read_scene(TWINCHUTE_SOURCE_DIR "/data/scenes/c9-inflation.toml");
    scene.parachutes.front().drag_area_table.emplace(
        "t.csv", std::vector<double>{0.0, 0.5, 1.0, 1.3, 1.35, 1.4, 1.7, 2.0},
        std::vector<double>{0.0, 0.4, 1.0, 1.3, 1.35, 1.3, 1.1, 1.0});
    scene.then = "rom";
    scene.rom.rtol = 1e-8;
    const auto run = [&](Trigger::Kind kind) {
        scene.stop = {kind, 0.0, 0.0, ""};
        twinchute::Run control;
        return run_scene(rom::rom_fidelity(), scene, control, both);
    };
    const RunRecord early = run(Trigger::Kind::full_open);
    EXPECT_FALSE(early.handed_over);
    ASSERT_FALSE(early.warnings.empty());
    EXPECT_EQ(early.warnings.back().why, "the run stopped before the canopy had settled from over-inflating");
    EXPECT_EQ(early.warnings.back().suggestion, "stop later, e.g. at = \"steady-descent\"");
    const RunRecord settled = run(Trigger::Kind::steady_descent);
    ASSERT_TRUE(settled.handed_over);
    const RunRecord whole = run(Trigger::Kind::ground);
    EXPECT_NEAR(*settled.metric("flight_time_s"), *whole.metric("flight_time_s"),
                1e-6 * *whole.metric("flight_time_s"));
}

/// A drogue and a main that come out open, on a slow fall handed over after 4 s.
Scene two_that_come_out_open() {
    Scene two = read_scene(std::string(TWINCHUTE_SOURCE_DIR) + "/data/scenes/c9-drogue.toml",
                           {"release.altitude=100", "release.speed=8", "release.path_angle='90 deg'",
                            "full.mesh={gore_rows=4,gore_columns=1,line_elements=3}"});
    for (Parachute& chute : two.parachutes) {
        chute.deploy = {};
        chute.deploy.by = DeployBy::inflated;
        chute.deploy_when.reset();
        chute.cut.reset();
    }
    two.stop = {Trigger::Kind::time, 4.0, 0.0, ""};
    two.then = "rom";
    return two;
}

RunRecord run_of(const Fidelity& fidelity, const Scene& scene) {
    twinchute::Run run;  // not that of a test
    return run_scene(fidelity, scene, run, both);
}

TEST(HandOver, TakesCanopiesThatCameOutOpen) {
    // Full as soon as they are out: the main at release, the drogue 2 s later, the only one of all at
    // release.
    Scene two = two_that_come_out_open();
    two.parachutes[0].deploy_when = Trigger{Trigger::Kind::time, 2.0, 0.0, ""};
    Scene one = two;
    one.parachutes.erase(one.parachutes.begin());
    for (const Scene& scene : {one, two}) {
        const bool several = scene.parachutes.size() > 1;
        Scene to_the_ground = scene;
        to_the_ground.stop = {Trigger::Kind::ground, 0.0, 0.0, ""};
        to_the_ground.then.clear();
        const double landing = *run_of(rom::rom_fidelity(), to_the_ground).metric("flight_time_s");
        for (const Fidelity* fidelity : both) {
            SCOPED_TRACE(fidelity->name);
            const RunRecord record = run_of(*fidelity, scene);
            ASSERT_TRUE(record.handed_over) << record.warnings.back().why;
            const Event* full = record.find_event(several ? "main.full-open" : "full-open");
            ASSERT_NE(full, nullptr);
            EXPECT_EQ(full->time, 0.0);
            if (several) {
                ASSERT_NE(record.find_event("drogue.full-open"), nullptr);
                EXPECT_EQ(record.find_event("drogue.full-open")->time, 2.0);
            }
            // Both fall with the scene's drag area and differ in how they come to their descent.
            EXPECT_NEAR(*record.metric("flight_time_s"), landing, 0.01 * landing);
        }
    }
}

TEST(HandOver, ColumnsOfTheOnlyParachuteLeftGoOn) {
    // In the rest it is the only one, and its columns are those of all. Where two fly on the rest has
    // columns of each by itself, as far as its model does.
    Scene cut = two_that_come_out_open(), stays = cut;
    cut.parachutes[1].name = "The-Main";  // a column has it in small letters
    cut.parachutes[0].cut = Trigger{Trigger::Kind::time, 1.0, 0.0, ""};
    for (const Scene& scene : {cut, stays}) {
        const RunRecord record = run_of(fullsim::full_fidelity(), scene);
        ASSERT_TRUE(record.handed_over) << record.warnings.back().why;
        const auto end = [&](const char* channel) { return at_end(record, channel); };
        EXPECT_TRUE(std::isnan(end("drogue_force")));
        if (scene.parachutes[0].cut) {
            EXPECT_EQ(end("the_main_force"), end("force"));
            EXPECT_EQ(end("the_main_drag_area"), end("drag_area"));
            EXPECT_GT(end("the_main_force"), 0.0);
            EXPECT_TRUE(std::isnan(end("the_main_projected_area")));  // the reduced-order model has no shape
        } else {
            EXPECT_TRUE(std::isnan(end("main_force")));
            EXPECT_TRUE(std::isnan(end("main_projected_area")));
        }
    }
}

TEST(HandOver, IsNotMadeWhileAParachuteHasYetToOpenOrToBeCut) {
    const auto why_not = [](const std::vector<std::string>& more) {
        std::vector<std::string> all = more;
        all.emplace_back("stop.then='rom'");
        const RunRecord record = fly(rom::rom_fidelity(), "c9-drogue.toml", all);
        EXPECT_FALSE(record.handed_over);
        for (const Warning& warning : record.warnings)
            if (warning.what == "the fall was not handed over to rom") return warning.why;
        return std::string("no warning");
    };
    // The drogue comes out at 0.5 s and is cut at 4 s, when the main leaves its pack.
    EXPECT_EQ(why_not({"stop.time=0.55"}), "the run stopped before drogue was open");
    EXPECT_EQ(why_not({"stop.time=3"}), "drogue is still to be cut");
    EXPECT_EQ(why_not({"stop.time=4.2"}), "the run stopped before main was open");
}

TEST(HandOver, KeepsARunThatDidNotStopAsItIs) {
    std::stop_source stop;
    stop.request_stop();
    twinchute::Run run;  // not that of a test
    run.stop = stop.get_token();
    const Scene scene =
        read_scene(std::string(TWINCHUTE_SOURCE_DIR) + "/data/scenes/c9-inflation.toml", {"stop.then='rom'"});
    const RunRecord record = run_scene(fullsim::full_fidelity(), scene, run, both);
    EXPECT_EQ(record.status.code, StatusCode::interrupted);
    EXPECT_FALSE(record.handed_over);
}

TEST(HandOver, IsRefusedWhereNothingCouldBeHandedOver) {
    const auto why_not = [](const std::vector<std::string>& more,
                            const std::string& file = "c9-inflation.toml") {
        try {
            read_scene(std::string(TWINCHUTE_SOURCE_DIR) + "/data/scenes/" + file, more);
        } catch (const std::exception& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_EQ(why_not({"stop.then='rom'"}), "");
    EXPECT_NE(why_not({"stop.then='full'"}).find("stop.then"), std::string::npos);
    EXPECT_NE(why_not({"stop.then='cfd'"}).find("rom"), std::string::npos);
    EXPECT_NE(why_not({"stop.then='rom'", "stop.at='ground'"}).find("nothing is left to fly"),
              std::string::npos);
    EXPECT_NE(why_not({"stop.then='rom'", "stop.at='line-stretch'"}).find("before the canopy is open"),
              std::string::npos);
    EXPECT_NE(why_not({"stop.then='rom'", "parachute.cut={time='3 s'}"}).find("parachute.cut lets it go"),
              std::string::npos);
    EXPECT_NE(why_not({"stop.then='rom'", "parachute.main.cut={time='20 s'}"}, "c9-drogue.toml")
                  .find("each of the parachutes is cut"),
              std::string::npos);
    EXPECT_EQ(why_not({"stop.then='rom'"}, "c9-drogue.toml"), "");
}

}  // namespace
}  // namespace twinchute
