// A small right scene that tests break, one line at a time.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "lib/scene/read_scene.hpp"
#include "lib/scene/scene_error.hpp"

namespace twinchute::test {

/// Lines are counted from 1 in what the tests expect; keep them in place.
inline const std::string good_scene = R"(schema = 1
name = "test"
[environment]
atmosphere = { density = "1.225 kg/m^3" }
[payload]
mass = "152.4 kg"
[release]
height = "300 m"
speed = "21 m/s"
path_angle = "90 deg"
[[parachute]]
design = "usaf-c9"
deploy = { by = "line-stretch" }
fill_time = { model = "fill-constant", n = 4.0 }
[aerodynamics]
added_mass = { model = "hemisphere" }
[stop]
time = "6 s"
)";

/// The text with one occurrence of `from` replaced; fails the test when there is not exactly one.
inline std::string edited(std::string text, std::string_view from, std::string_view to) {
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << "nothing to replace: " << from;
    EXPECT_EQ(text.find(from, at + 1), std::string::npos) << "ambiguous: " << from;
    if (at != std::string::npos) text.replace(at, from.size(), to);
    return text;
}

inline Scene read_text(const std::string& text, const std::vector<std::string>& overrides = {}) {
    return read_scene_text(text, "test.toml", TWINCHUTE_SOURCE_DIR "/data", overrides);
}

/// Complaint of the reader; empty when there is none.
inline std::string complaint(const std::string& text, const std::vector<std::string>& overrides = {}) {
    try {
        read_text(text, overrides);
    } catch (const SceneError& error) {
        return error.what();
    }
    return {};
}

inline const Input* find_input(const Scene& scene, std::string_view key) {
    for (const Input& input : scene.inputs)
        if (input.key == key) return &input;
    return nullptr;
}

}  // namespace twinchute::test
