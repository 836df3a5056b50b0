// The table of keys holds together, and what is printed of it is complete.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <sstream>

#include "lib/models/atmosphere.hpp"
#include "lib/record/metrics.hpp"
#include "lib/scene/keys.hpp"
#include "lib/scene/nearest.hpp"
#include "lib/scene/units.hpp"

namespace twinchute {
namespace {

std::vector<Key> all_keys() {
    std::vector<Key> keys(scene_keys().begin(), scene_keys().end());
    keys.insert(keys.end(), material_keys().begin(), material_keys().end());
    return keys;
}

TEST(Keys, RowsAreConsistent) {
    std::set<std::string_view> paths;
    const auto keys = all_keys();
    for (const Key& key : keys) {
        SCOPED_TRACE(key.path);
        EXPECT_TRUE(paths.insert(key.path).second);
        EXPECT_FALSE(key.meaning.empty());
        EXPECT_LE(key.range.low, key.range.high);
        EXPECT_EQ(key.kind == KeyKind::quantity || key.kind == KeyKind::quantity_or_word ||
                      key.kind == KeyKind::quantities,
                  !key.unit.empty());
        if (key.kind == KeyKind::list) {  // of words, of names of files, or of keys
            EXPECT_FALSE(key.choices != nullptr && !key.folder.empty());
        } else {
            EXPECT_EQ(key.kind == KeyKind::word || key.kind == KeyKind::quantity_or_word,
                      key.choices != nullptr);
            EXPECT_EQ(key.kind == KeyKind::data_file, !key.folder.empty());
        }
        if (!key.unit.empty()) {
            EXPECT_EQ(to_si("2 " + std::string(key.unit), key.unit), 2.0);
        }
        for (const std::string_view name : words_of(key.instead_of)) {
            const Key* other = find_key(keys, name);
            ASSERT_NE(other, nullptr);
            const auto back = words_of(other->instead_of);
            EXPECT_EQ(std::ranges::count(back, key.path), 1);
        }
        for (const std::string_view retired : words_of(key.formerly)) {
            EXPECT_EQ(find_key(scene_keys(), retired), nullptr) << retired;
            ASSERT_TRUE(find_successor(scene_keys(), retired)) << retired;
            EXPECT_EQ(find_successor(scene_keys(), retired)->path, key.path);
        }
        if (key.need != KeyNeed::defaulted) continue;
        ASSERT_FALSE(key.fallback.empty());
        if (key.is_number()) {
            EXPECT_TRUE(key.range.contains(plain_number(key.fallback)));
        } else if (key.choices) {
            const auto words = key.choices();
            EXPECT_NE(std::ranges::find(words, key.fallback), words.end());
        }
    }
}

TEST(Keys, ChoicesAreTheRowsOfTheModels) {
    const auto words = find_key(scene_keys(), "environment.atmosphere.model")->choices();
    ASSERT_EQ(words.size(), atmosphere_models().size());
    for (std::size_t i = 0; i < words.size(); ++i)
        EXPECT_EQ(words[i], atmosphere_models()[i].name);
}

TEST(Keys, DesignKeysAreThoseOfTheParachute) {
    EXPECT_NE(find_key(design_keys(), "parachute.gores"), nullptr);
    EXPECT_EQ(find_key(design_keys(), "parachute.design"), nullptr);
    EXPECT_EQ(find_key(design_keys(), "parachute.deploy.by"), nullptr);
    EXPECT_EQ(find_key(design_keys(), "payload.mass"), nullptr);
    EXPECT_EQ(fabric_keys().size() + cord_keys().size(), material_keys().size());
    EXPECT_EQ(fabric_keys().back().path, "fabric.permeability.speed");
    EXPECT_EQ(cord_keys().front().path, "cord.kind");
}

TEST(Keys, TableHasALineForEach) {
    std::istringstream lines(keys_table(keys_below("")));
    std::string line;
    std::getline(lines, line);
    const auto column = line.find("default");
    EXPECT_TRUE(line.starts_with("key "));
    for (const Key& key : all_keys()) {
        ASSERT_TRUE(std::getline(lines, line));
        EXPECT_TRUE(line.starts_with(std::string(key.path) + " ")) << line;
        EXPECT_EQ(line.substr(column).find(default_text(key)), 0u) << line;  // aligned
    }
    EXPECT_FALSE(std::getline(lines, line));
}

TEST(Keys, TextsOfARow) {
    EXPECT_EQ(default_text(*find_key(scene_keys(), "payload.mass")), "required");
    EXPECT_EQ(default_text(*find_key(scene_keys(), "payload.drag_area")), "left out");
    EXPECT_EQ(default_text(*find_key(scene_keys(), "environment.gravity")), "9.80665 m/s^2");
    EXPECT_EQ(default_text(*find_key(scene_keys(), "release.heading")), "90 deg");
    EXPECT_EQ(range_text(*find_key(scene_keys(), "parachute.initial_drag_area_ratio")), ">= 0 and < 1");
    EXPECT_EQ(range_text(*find_key(scene_keys(), "release.path_angle")), ">= -90 and <= 90 deg");
    EXPECT_EQ(range_text(*find_key(scene_keys(), "stop.at")),
              "steady-descent | peak-force | full-open | line-stretch | ground");
}

TEST(Keys, ToleranceUnitsAreUnits) {
    for (const MetricRow& metric : judgeable_rows())
        EXPECT_EQ(to_si("3 " + std::string(metric.tolerance_unit()), metric.tolerance_unit()), 3.0)
            << metric.name;
}

TEST(Nearest, CountsEdits) {
    const std::vector<std::string_view> words{"mass", "drag_area", "speed"};
    EXPECT_EQ(nearest("mas", words), "mass");   // one letter missing
    EXPECT_EQ(nearest("MASS", words), "mass");  // case is no edit
    EXPECT_EQ(nearest("sped", words), "speed");
    EXPECT_EQ(nearest("dragarea", words), "drag_area");
    EXPECT_EQ(nearest("colour", words), "");  // nothing within a third
    EXPECT_EQ(nearest("", words), "");
    EXPECT_EQ(suggest("mas", words), "did you mean 'mass'?");
    EXPECT_EQ(suggest("colour", words), "known: mass, drag_area, speed");
}

}  // namespace
}  // namespace twinchute
