// summary.json against the keys that scripts rely on (the table of the record in the user's guide).
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "lib/record/metrics.hpp"
#include "lib/record/record_json.hpp"

namespace twinchute {
namespace {

using nlohmann::json;

std::set<std::string> keys_of(const json& object) {
    std::set<std::string> keys;
    for (const auto& [key, value] : object.items())
        keys.insert(key);
    return keys;
}

RunRecord record_to_write() {
    RunRecord record;
    record.scene = {"a scene", "a.toml", "ff"};
    record.fidelity = "rom";
    record.status = {StatusCode::energy_grew, "at 1 s"};
    record.inputs = {
        {"payload.mass", 152.4, "kg", InputOrigin::given, ""},
        {"parachute.fill_time.model", std::string("fill-constant"), "", InputOrigin::fallback, "a book"}};
    record.add_metric("peak_force_N", 0.1 + 0.2, MetricKind::mixed, "n is an input");
    record.provenance = current_provenance();
    return record;
}

TEST(RecordJson, HasTheTopLevelKeysOfTheContract) {
    const json summary = json::parse(summary_json(record_to_write()));
    EXPECT_EQ(keys_of(summary),
              (std::set<std::string>{"generator", "schema", "scene", "inputs", "fidelity", "status",
                                     "metrics", "standing", "cost", "warnings", "left_out", "provenance"}));
    EXPECT_EQ(summary["generator"], "twinchute");
    EXPECT_EQ(summary["schema"], 1);
    EXPECT_EQ(keys_of(summary["scene"]), (std::set<std::string>{"name", "file", "sha256"}));
    EXPECT_EQ(summary["status"], (json{{"code", "energy_grew"}, {"detail", "at 1 s"}}));
    EXPECT_EQ(keys_of(summary["provenance"]),
              (std::set<std::string>{"version", "commit", "compiler", "flags", "instruction_set", "host_cpu",
                                     "date", "threads"}));
}

TEST(RecordJson, NumbersReadBackToTheSameBits) {
    const json summary = json::parse(summary_json(record_to_write()));
    // 0.1 + 0.2 is the classic: 0.3 in 15 digits, 0.30000000000000004 in 17.
    EXPECT_EQ(summary["metrics"]["peak_force_N"].get<double>(), 0.1 + 0.2);
    EXPECT_NE(summary["metrics"]["peak_force_N"].get<double>(), 0.3);
}

TEST(RecordJson, InputsSayValueUnitAndOrigin) {
    const json inputs = json::parse(summary_json(record_to_write()))["inputs"];
    EXPECT_EQ(inputs["payload.mass"], (json{{"value", 152.4}, {"unit", "kg"}, {"origin", "given"}}));
    EXPECT_EQ(inputs["parachute.fill_time.model"],
              (json{{"value", "fill-constant"}, {"origin", "default"}, {"source", "a book"}}));
}

TEST(RecordJson, SaysWhatIsInputAndWhatIsResult) {
    const json standing = json::parse(summary_json(record_to_write()))["standing"];
    EXPECT_EQ(standing["peak_force_N"], (json{{"input_or_result", "mixed"}, {"note", "n is an input"}}));
}

TEST(RecordJson, PhysicsLeftOutHasNoKey) {
    RunRecord record = record_to_write();
    EXPECT_FALSE(json::parse(summary_json(record)).contains("energy"));
    record.energy = EnergyLedger{.kinetic = 1, .gravity_work = 3, .drag_work = -2, .residual_fraction = 0};
    const json summary = json::parse(summary_json(record));
    EXPECT_EQ(keys_of(summary["energy"]),
              (std::set<std::string>{"kinetic_J", "gravity_work_J", "drag_work_J", "residual_fraction"}));
    EXPECT_FALSE(summary["cost"].contains("element_steps"));
    EXPECT_FALSE(summary["cost"].contains("ns_per_element_step"));
    EXPECT_FALSE(summary["cost"].contains("blocks"));

    record.cost.element_steps = 7;
    record.cost.blocks = {{"membrane", 0.5}};
    const json cost = json::parse(summary_json(record))["cost"];
    EXPECT_EQ(cost["element_steps"], 7);
    EXPECT_EQ(cost["blocks"], (json{{"membrane", 0.5}}));
}

TEST(RecordJson, NeverWritesWhatIsNotFinite) {
    RunRecord record = record_to_write();
    record.add_metric("impulse_N_s", std::numeric_limits<double>::quiet_NaN());
    record.add_metric("load_factor", std::numeric_limits<double>::infinity());
    const std::string text = summary_json(record);
    json summary = json::parse(text);
    summary.erase("provenance");  // names compiler flags, which may have the word
    EXPECT_EQ(summary.dump().find("null"), std::string::npos);
    EXPECT_FALSE(summary["metrics"].contains("impulse_N_s"));
    EXPECT_FALSE(summary["metrics"].contains("load_factor"));
    ASSERT_EQ(summary["missing"].size(), 2u);  // so that a gate does not pass for want of them
    EXPECT_EQ(summary["missing"][0]["metric"], "impulse_N_s");
    EXPECT_EQ(summary["missing"][0]["not_reached"], false);
    ASSERT_EQ(summary["warnings"].size(), 2u);  // one for each, in words
    EXPECT_NE(summary["warnings"][0]["what"].get<std::string>().find("impulse_N_s"), std::string::npos);
}

TEST(RecordJson, SurvivesHostileText) {
    RunRecord record = record_to_write();
    record.scene.name = "a \"quoted\" \\ name\n\x1b[31m";
    record.scene.file = "not utf-8 \xff.toml";
    const json summary = json::parse(summary_json(record));
    EXPECT_EQ(summary["scene"]["name"], record.scene.name);
    EXPECT_EQ(summary["scene"]["file"], "not utf-8 \xEF\xBF\xBD.toml");
}

TEST(RecordMetricKey, TakesTheUnitOffTheName) {
    const auto expect = [](std::string_view key, std::string_view name, std::string_view unit) {
        EXPECT_EQ(split_metric_key(key).name, name) << key;
        EXPECT_EQ(split_metric_key(key).unit, unit) << key;
    };
    expect("peak_force_N", "peak_force", "N");
    expect("impulse_N_s", "impulse", "N s");  // not "impulse_N" in seconds
    expect("snatch_speed_m_s", "snatch_speed", "m/s");
    expect("max_membrane_stress_N_m", "max_membrane_stress", "N/m");
    expect("max_deceleration_g", "max_deceleration", "g");
    expect("peak_force_ratio", "peak_force_ratio", "");
    EXPECT_EQ(metric_words("time_to_peak_force_s"), "time to peak force");
}

}  // namespace
}  // namespace twinchute
