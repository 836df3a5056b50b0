// A directory with a scene whose runs take a moment, and the program in it.
#pragma once

#include <map>

#include "tests/support/program_test.hpp"

namespace twinchute::test {

class ShortScene : public ProgramTest {
protected:
    ShortScene() { here_.write("scene.toml", scene("")); }

    /// Just past full open on a coarse mesh; `more` stands at the top.
    static std::string scene(const std::string& more) {
        return "base = \"c9-inflation.toml\"\n" + more +
               "full.mesh = { gore_columns = 1, gore_rows = 4, line_elements = 4 }\nstop.time = 1.7\n"
               "compare.tolerance.peak_force = \"1000 %\"\ncompare.tolerance.descent_rate = \"1 m/s\"\n"
               "compare.tolerance.filling_time = \"1 s\"\n";
    }
    /// A file of results as standard output has it: only files carry their own checksum.
    nlohmann::json printed(const std::string& file) const {
        nlohmann::json content = read(file);
        EXPECT_EQ(content.erase("sha256"), 1u) << file;
        return content;
    }
    /// Writes changed content without a checksum, as an earlier version did: an edited file with one is
    /// refused.
    void write_without_checksum(const std::string& file, nlohmann::ordered_json content) const {
        content.erase("sha256");
        here_.write(file, content.dump());
    }

    /// Every file below a directory, by name.
    std::map<std::string, std::string> files(const std::string& directory) const {
        std::map<std::string, std::string> contents;
        for (const std::string& name : tree_of(here_ / directory)) {
            const auto file = here_ / (directory + "/" + name);
            if (std::filesystem::is_regular_file(file)) contents[name] = content_of(file);
        }
        return contents;
    }
};

}  // namespace twinchute::test
