// Fixture of the system tests: the program, run in a directory of its own.
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/process.hpp"
#include "tests/support/scratch_dir.hpp"

namespace twinchute::test {

using nlohmann::json;
using Words = std::vector<std::string>;

inline Words operator+(Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

/// Command line that runs the program with these words.
inline Words program(const Words& words) {
    return Words{TWINCHUTE_PROGRAM} + words;
}

/// File of a shipped scene, e.g. "paper/crane-drop".
inline std::string shipped_scene(const std::string& name) {
    return TWINCHUTE_SOURCE_DIR "/data/scenes/" + name + ".toml";
}
inline const std::string c9_inflation = shipped_scene("c9-inflation");

class ProgramTest : public testing::Test {
protected:
    /// Runs the program in the directory and waits for it.
    Ended run(const Words& words) const { return Process(program(words), here_.path()).wait(); }
    std::string text(const std::string& file) const { return content_of(here_ / file); }
    json read(const std::string& file) const { return json::parse(text(file)); }
    bool nothing_written() const { return tree_of(here_.path()).empty(); }

    ScratchDir here_;
};

}  // namespace twinchute::test
