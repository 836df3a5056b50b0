// `twinchute list keys`: all of them to search in, or wrapped to read; those of a table; one in full.
#include <sstream>

#include "lib/cli/text.hpp"
#include "tests/support/program_test.hpp"

namespace twinchute::test {
namespace {

class SystemList : public ProgramTest {
protected:
    Ended list(const std::string& columns, const Words& words) const {
        Words all{"/usr/bin/env", "-u", "COLUMNS"};
        if (!columns.empty()) all.push_back("COLUMNS=" + columns);
        return Process(all + program({"list", "keys"}) + words, here_.path()).wait();
    }
    static std::vector<std::string> lines_of(const std::string& text) {
        std::vector<std::string> lines;
        std::istringstream stream(text);
        for (std::string line; std::getline(stream, line);)
            lines.push_back(line);
        return lines;
    }
};

TEST_F(SystemList, APipeHasALineForEachKey) {
    const auto all = lines_of(list("", {}).out), of_json = lines_of(list("", {"--json"}).out);
    EXPECT_EQ(all.size(), json::parse(list("", {"--json"}).out).size() + 1);  // below its heads
    // A long range makes its own line long, no other.
    std::size_t longer = 0;
    for (const std::string& line : all)
        longer += columns_of(line) > 400 ? 1 : 0;
    EXPECT_LT(longer, 10u);
}

TEST_F(SystemList, LinesFitTheColumnsTheyAreGiven) {
    for (const std::string columns : {"60", "100"}) {
        for (const std::string path : {"", "parachute", "parachute.deploy.by"}) {
            const Ended ended = list(columns, path.empty() ? Words{} : std::vector{path});
            EXPECT_EQ(ended.code, 0) << ended.err;
            for (const std::string& line : lines_of(ended.out))
                // A single word may be longer than a line.
                EXPECT_TRUE(columns_of(line) <= std::stoul(columns) ||
                            line.find(' ', line.find_first_not_of(' ')) == std::string::npos)
                    << columns << ": " << line;
        }
    }
    // Nothing is lost on the way: the same words as in one line.
    const auto squeezed = [](const std::string& text) {
        std::string words, word;
        std::istringstream stream(text);
        while (stream >> word)
            words += word + " ";
        return words;
    };
    EXPECT_EQ(squeezed(list("60", {"parachute.deploy.by"}).out),
              squeezed(list("", {"parachute.deploy.by"}).out));
}

TEST_F(SystemList, ATableOfTheSceneHasItsKeysAlone) {
    const auto lines = lines_of(list("", {"parachute.deploy"}).out);
    ASSERT_GT(lines.size(), 5u);
    for (std::size_t i = 1; i < lines.size(); ++i)
        EXPECT_TRUE(lines[i].starts_with("parachute.deploy.") || lines[i].starts_with("parachute.deploy "))
            << lines[i];
    for (const json& row : json::parse(list("", {"payload", "--json"}).out))
        EXPECT_TRUE(row["key"].get<std::string>().starts_with("payload")) << row;
}

TEST_F(SystemList, OneKeyStandsInFull) {
    const std::string text = list("", {"parachute.deploy.by"}).out;
    EXPECT_TRUE(text.starts_with("parachute.deploy.by\n")) << text;
    for (const char* line : {"\n    meaning     how it leaves its pack", "\n    default     required\n",
                             "\n    used by     both\n"})
        EXPECT_NE(text.find(line), std::string::npos) << line << " in " << text;
    EXPECT_NE(list("", {"parachute.fill_time.n"})
                  .out.find("only with   parachute.fill_time.model = fill-constant, "),
              std::string::npos);
    // A member of a list has the row of the list.
    EXPECT_EQ(list("", {"parachute.reefing.2.drag_area_ratio"}).out,
              list("", {"parachute.reefing.drag_area_ratio"}).out);
}

TEST_F(SystemList, WhatIsNoKeyIsRefused) {
    const Ended ended = list("", {"payload.mas"});
    EXPECT_EQ(ended.code, 2);
    EXPECT_NE(ended.err.find("there is no key 'payload.mas', did you mean 'payload.mass'?"),
              std::string::npos)
        << ended.err;
    EXPECT_EQ(list("", {"payload", "release"}).code, 2);
    EXPECT_EQ(run({"list", "laws", "payload"}).code, 2);
}

}  // namespace
}  // namespace twinchute::test
