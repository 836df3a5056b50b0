// Runs of campaigns by the reduced-order model: metrics alone and in batches, held against whole records.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "lib/scene/calibration.hpp"
#include "lib/scene/read_scene.hpp"
#include "lib/scene/scene_error.hpp"
#include "rom/fidelity.hpp"
#include "study/campaign/random.hpp"
#include "study/campaign/sampler.hpp"

namespace twinchute::study {
namespace {

Scene shipped(const std::string& name, const std::vector<std::string>& overrides = {}) {
    return read_scene(TWINCHUTE_SOURCE_DIR "/data/scenes/" + name + ".toml", overrides);
}

TEST(CampaignEngine, MetricsAloneAreThoseOfTheRecord) {
    for (const char* name : {"c9-inflation", "c9-inflation-oblique", "c9-drift", "c9-reefed", "c9-predicted",
                             "personnel", "cargo-cluster", "cargo-extraction", "rocket-dual-deploy"}) {
        const Scene scene = shipped(name);
        twinchute::Run run;
        const RunRecord record = rom::rom_fidelity().run(scene, run);
        std::vector<std::string> keys;
        for (const MetricRow& row : metric_rows())
            keys.emplace_back(row.key);
        for (const Metric& metric : record.metrics)  // of each of several parachutes, too
            if (find_metric_row(split_metric_key(metric.key).name) &&
                std::ranges::find(keys, metric.key) == keys.end())
                keys.push_back(metric.key);
        std::vector<double> values(keys.size());
        const RunStatus status = rom::rom_fidelity().metrics(scene, run, keys, values);
        EXPECT_EQ(status.code, record.status.code) << name;
        EXPECT_EQ(status.detail, record.status.detail) << name;
        for (std::size_t i = 0; i < keys.size(); ++i) {
            const auto metric = record.metric(keys[i]);
            ASSERT_EQ(metric.has_value(), !std::isnan(values[i])) << name << " " << keys[i];
            if (metric) {
                EXPECT_EQ(*metric, values[i]) << name << " " << keys[i];
            }
            // Alone, too: what one metric needs must not hang on another one that is asked for.
            double alone = 0.0;
            rom::rom_fidelity().metrics(scene, run, {&keys[i], 1}, {&alone, 1});
            ASSERT_EQ(metric.has_value(), !std::isnan(alone)) << name << " " << keys[i];
        }
    }
}

TEST(CampaignEngine, CalibratedParachutesAreThoseOfTheRecord) {
    Scene scene = shipped("c9-inflation", {"stop.at=\"peak-force\""});
    scene.parachutes.front().calibration =
        CalibrationTable{"c.csv", {{150, 20, 1.2}}, {{"drag_area", {1.07}}}};
    twinchute::Run run;
    const std::vector<std::string> peak{"peak_force_N"};
    std::vector<double> value(1);
    rom::rom_fidelity().metrics(scene, run, peak, value);
    EXPECT_EQ(value[0], rom::rom_fidelity().run(scene, run).metric("peak_force_N"));
    EXPECT_FALSE(rom::rom_fidelity().batches(scene, peak));
}

const std::vector<std::string> keys{"peak_force_N",   "max_force_N",     "max_deceleration_g",
                                    "filling_time_s", "mass_ratio",      "time_to_peak_force_s",
                                    "load_factor",    "snatch_speed_m_s"};

/// Scenes about one, as wide as a campaign may be: 10 % of each number, one standard deviation.
std::vector<Scene> dispersed(const Scene& about, std::uint64_t batch) {
    std::vector<Scene> scenes(rom::rom_fidelity().batch, about);
    for (std::size_t l = 0; l < scenes.size(); ++l) {
        const auto factor = [&](std::uint32_t dimension) {
            const std::uint64_t run = batch * scenes.size() + l;
            return 0.8 + 0.4 * unit_number(random_bits(1, run, dimension, RandomStream::test));
        };
        Scene& scene = scenes[l];
        Parachute& chute = scene.parachutes.front();
        scene.payload.mass *= factor(0);
        scene.release.speed *= factor(1);
        chute.fill_time.n *= factor(2);
        chute.drag_area *= factor(3);
        chute.initial_drag_area_ratio *= factor(4);
    }
    return scenes;
}

struct Batched {
    std::vector<double> values;
    std::vector<StatusCode> statuses;
};
Batched batched(const std::vector<Scene>& scenes) {
    Batched made{std::vector<double>(scenes.size() * keys.size()), std::vector<StatusCode>(scenes.size())};
    twinchute::Run run;
    rom::rom_fidelity().metrics_of_batch(scenes, run, keys, made.values, made.statuses);
    return made;
}

// The measure of the design: 5e-5 of the peak over 2000 runs, where run_rom is taken at a tolerance of 1e-9.
TEST(CampaignEngine, BatchesAgreeWithTightRuns) {
    for (const Scene& about :
         {shipped("c9-inflation", {"stop.at=\"peak-force\"", "environment.atmosphere=\"us76\""}),
          shipped("c9-inflation-oblique", {"stop.at=\"peak-force\"", "payload.drag_area=0.4"})}) {
        ASSERT_TRUE(rom::rom_fidelity().batches(about, keys));
        double worst = 0.0, worst_of_all = 0.0;
        for (std::uint64_t batch = 0; batch < 16; ++batch) {
            const std::vector<Scene> scenes = dispersed(about, batch);
            const Batched made = batched(scenes);
            for (std::size_t l = 0; l < scenes.size(); ++l) {
                Scene tight = scenes[l];
                tight.rom.rtol = 1e-9;
                twinchute::Run run;
                std::vector<double> exact(keys.size());
                ASSERT_EQ(made.statuses[l], rom::rom_fidelity().metrics(tight, run, keys, exact).code);
                for (std::size_t k = 0; k < keys.size(); ++k) {
                    const double error = std::abs(made.values[l * keys.size() + k] / exact[k] - 1.0);
                    ASSERT_TRUE(std::isfinite(error)) << keys[k];
                    (k == 0 ? worst : worst_of_all) = std::max(k == 0 ? worst : worst_of_all, error);
                }
            }
        }
        EXPECT_LT(worst, 5e-5);
        EXPECT_LT(worst_of_all, 5e-4);  // the time of a flat maximum
    }
}

// Every metric that a single run has, a batch has, in the column of its key.
TEST(CampaignEngine, BatchesHaveTheMetricsOfSingleRuns) {
    const std::vector<Scene> scenes =
        dispersed(shipped("c9-inflation-oblique", {"stop.at=\"peak-force\""}), 3);
    std::vector<std::string> all;
    for (const MetricRow& row : metric_rows())
        if (rom::rom_fidelity().batches(scenes[0], std::vector{std::string(row.key)}))
            all.emplace_back(row.key);
    for (const char* key : {"peak_force_N", "max_deceleration_g", "snatch_speed_m_s", "altitude_loss_m"})
        ASSERT_NE(std::ranges::find(all, key), all.end()) << key;
    std::vector<double> values(scenes.size() * all.size()), alone(all.size());
    std::vector<StatusCode> statuses(scenes.size());
    twinchute::Run run;
    ASSERT_TRUE(rom::rom_fidelity().batches(scenes[0], all));
    rom::rom_fidelity().metrics_of_batch(scenes, run, all, values, statuses);
    for (std::size_t l = 0; l < scenes.size(); ++l) {
        rom::rom_fidelity().metrics(scenes[l], run, all, alone);
        for (std::size_t k = 0; k < all.size(); ++k) {
            const double made = values[l * all.size() + k];
            ASSERT_EQ(std::isnan(made), std::isnan(alone[k])) << all[k];
            if (!std::isnan(made)) {
                EXPECT_NEAR(made, alone[k], 5e-4 * std::abs(alone[k])) << all[k];
            }
        }
    }
}

TEST(CampaignEngine, ABatchHangsOnItsScenesAlone) {
    const Scene about = shipped("c9-inflation", {"stop.at=\"peak-force\""});
    const Batched first = batched(dispersed(about, 0));
    batched(dispersed(about, 7));
    const Batched again = batched(dispersed(about, 0));
    EXPECT_EQ(std::bit_cast<std::uint64_t>(first.values[0]), std::bit_cast<std::uint64_t>(again.values[0]));
    EXPECT_EQ(first.values, again.values);
}

TEST(CampaignEngine, ALaneOfAnotherKindIsRunByItself) {
    const Scene about = shipped("c9-inflation", {"stop.at=\"peak-force\""});
    std::vector<Scene> scenes = dispersed(about, 0);
    scenes[3] = shipped("c9-reefed");
    scenes[5].release.altitude = 5.0;  // on the ground before it is full
    const Batched made = batched(scenes);
    for (const std::size_t l : {3u, 5u}) {
        twinchute::Run run;
        std::vector<double> alone(keys.size());
        EXPECT_EQ(made.statuses[l], rom::rom_fidelity().metrics(scenes[l], run, keys, alone).code);
        for (std::size_t k = 0; k < keys.size(); ++k)
            EXPECT_TRUE(made.values[l * keys.size() + k] == alone[k] || std::isnan(alone[k])) << keys[k];
    }
}

TEST(CampaignEngine, OtherKindsOfScenesGoOneByOne) {
    for (const char* name :
         {"c9-drift", "c9-reefed", "c9-predicted", "personnel", "cargo-cluster", "c9-inflation"})
        EXPECT_FALSE(rom::rom_fidelity().batches(shipped(name), keys)) << name;
    EXPECT_FALSE(rom::rom_fidelity().batches(shipped("c9-inflation", {"stop.at=\"peak-force\""}),
                                             std::vector<std::string>{"impulse_N_s"}));
}

const std::string campaign_head = "[campaign]\nruns = 10\n";

CampaignSpec spec_of(const std::string& base, const std::string& vary) {
    return read_campaign_text("base = \"" + base + ".toml\"\n" + campaign_head + vary,
                              TWINCHUTE_SOURCE_DIR "/data/campaigns/x.toml",
                              TWINCHUTE_SOURCE_DIR "/data/campaigns");
}

TEST(CampaignSampler, PutsWhatReadingGives) {
    const CampaignSpec spec = spec_of(
        "c9-inflation",
        "[[vary]]\nkey = \"parachute.drag_area\"\ndist = { uniform = { low = 40, high = 45 } }\n"
        "[[vary]]\nkey = \"parachute.drag_area_law\"\ndist = { discrete = { values = [\"ludtke\", "
        "\"power-2\"] } }\n"
        "[[vary]]\nkey = \"release.speed\"\ndist = { normal = { mean = \"70 ft/s\", sd = \"5 %\" } }\n");
    const Sampler sampler(spec, base_of(spec));
    EXPECT_TRUE(sampler.is_quick());
    const std::vector<double> values{41.0, 1.0, 22.0};
    Scene put = sampler.blank();
    sampler.put(put, values);
    const Scene read = sampler.scene_at(values);
    EXPECT_EQ(put.parachutes, read.parachutes);
    EXPECT_EQ(put.release, read.release);
    EXPECT_EQ(put.parachutes.front().drag_area_law->name, "power-2");
    EXPECT_NEAR(spec.inputs[2].distribution->at(0.5), 21.336, 1e-12);
}

// A release below the ground is refused by reading alone, and only where the one is low and the other high.
TEST(CampaignSampler, ReadsWhereKeysDoNotFitTogether) {
    const std::string altitude = "[[vary]]\nkey = \"release.altitude\"\ndist = { uniform = { low = ",
                      ground =
                          "[[vary]]\nkey = \"environment.ground\"\ndist = { uniform = { low = 0, high = ";
    for (const bool swapped : {false, true}) {
        const std::string one = altitude + "300, high = 1200 } }\n", other = ground + "1000 } }\n";
        const CampaignSpec spec = spec_of("c9-drift", swapped ? other + one : one + other);
        const Sampler sampler(spec, base_of(spec));
        EXPECT_FALSE(sampler.is_quick());
        Scene scene = sampler.blank();
        const double values[] = {swapped ? 600.0 : 412.0, swapped ? 412.0 : 600.0};
        EXPECT_THROW(sampler.put(scene, values), SceneError);
    }
    const CampaignSpec apart =
        spec_of("c9-drift", altitude + "300, high = 1200 } }\n" + ground + "200 } }\n");
    EXPECT_TRUE(Sampler(apart, base_of(apart)).is_quick());
}

TEST(CampaignSampler, RefusesWhatVariesWithoutEffect) {
    const auto refusal = [](const char* one, const char* other) {
        const auto vary = [](const char* key) {
            return fmt::format("[[vary]]\nkey = \"{}\"\ndist = {{ uniform = {{ low = 1, high = 2 }} }}\n",
                               key);
        };
        const CampaignSpec spec = spec_of("c9-drift", vary(one) + vary(other));
        try {
            const Sampler sampler(spec, base_of(spec));
        } catch (const SceneError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_NE(refusal("parachute.drag_area", "parachute.1.drag_area").find("varies without effect"),
              std::string::npos);
    EXPECT_NE(refusal("parachute.drag_area", "parachute.drag_coefficient").find("varies without effect"),
              std::string::npos);
    EXPECT_EQ(refusal("parachute.drag_area", "payload.mass"), "");
}

// A member of a list is set by reading.
TEST(CampaignSampler, PutsMembersOfLists) {
    const CampaignSpec spec =
        spec_of("cargo-cluster",
                "[[vary]]\nkey = \"parachute.lag.2\"\ndist = { uniform = { low = 0.1, high = "
                "0.4 } }\n");
    const Sampler sampler(spec, base_of(spec));
    Scene scene = sampler.blank();
    sampler.put(scene, std::vector{0.25});
    EXPECT_EQ(scene.parachutes.front().lag.at(1), 0.25);
}

TEST(CampaignSampler, TurnsAndScalesTheWindClockwise) {
    const CampaignSpec spec =
        spec_of("c9-drift",
                "[[vary]]\nkey = \"wind.scale\"\ndist = { uniform = { low = 0, high = 2 } }\n"
                "[[vary]]\nkey = \"wind.turn\"\ndist = { normal = { mean = 0, sd = \"10 deg\" } }\n");
    const Sampler sampler(spec, base_of(spec));
    Scene scene = sampler.blank();
    sampler.put(scene, std::vector{1.5, 0.5 * 3.14159265358979323846});
    sampler.put(scene,
                std::vector{1.5, 0.5 * 3.14159265358979323846});  // from the scene's own wind each time
    const auto &before = sampler.nominal().environment.wind->levels, &after = scene.environment.wind->levels;
    for (std::size_t i = 0; i < before.size(); ++i) {
        // A wind toward the east turns toward the south.
        EXPECT_NEAR(after[i].velocity.x(), 1.5 * before[i].velocity.y(), 1e-12);
        EXPECT_NEAR(after[i].velocity.y(), -1.5 * before[i].velocity.x(), 1e-12);
    }
}

}  // namespace
}  // namespace twinchute::study
