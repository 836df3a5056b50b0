// The command line: what is understood, what is refused, and what the refusal says.
#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "lib/cli/program.hpp"
#include "lib/record/write_error.hpp"

namespace twinchute {
namespace {

Verb synthetic_verb() {
    return {"make",
            "make it up",
            "SCENE",
            "twinchute make a.toml",
            {{"out", "DIR", "where", false},
             {"set", "KEY=VALUE", "override", true},
             {"json", "", "as JSON", false}},
            [](const Arguments&) { return ExitCode::done; }};
}

std::string refusal(const std::vector<std::string>& words) {
    try {
        parse_arguments(synthetic_verb(), words);
    } catch (const UsageError& error) {
        return error.what();
    }
    return "not refused";
}

int run(Verb verb, const std::vector<const char*>& words) {
    const std::array verbs{std::move(verb)};
    std::vector<const char*> all{"twinchute"};
    all.insert(all.end(), words.begin(), words.end());
    return run_program(verbs, static_cast<int>(all.size()), all.data());
}

int run_throwing(auto error) {
    Verb verb = synthetic_verb();
    verb.run = [error](const Arguments&) -> ExitCode { throw error; };
    return run(verb, {"make", "a.toml"});
}

TEST(CliArguments, OptionsMayStandAnywhere) {
    const Arguments arguments = parse_arguments(
        synthetic_verb(), {"--set", "a=1", "scene.toml", "--json", "--set=b = 2", "--out", "dir"});
    EXPECT_EQ(arguments.operand, "scene.toml");
    EXPECT_EQ(arguments.values("set"), (std::vector<std::string>{"a=1", "b = 2"}));
    EXPECT_EQ(arguments.value("out"), "dir");
    EXPECT_TRUE(arguments.has("json"));
    EXPECT_FALSE(arguments.has("check"));
    EXPECT_FALSE(arguments.value("check"));
}

TEST(CliArguments, WhatIsEmptyNamesNothing) {
    EXPECT_EQ(refusal({"a.toml", "--out", ""}),
              "--out is given nothing (its DIR is empty), name one or leave it out");
    EXPECT_NE(refusal({"a.toml", "--out="}), "not refused");
    EXPECT_NE(refusal({"a.toml", "--set", "a=1", "--set", ""}).find("--set is given nothing"),
              std::string::npos);
    EXPECT_NE(refusal({""}).find("is empty"), std::string::npos);
}

TEST(CliArguments, AnUnknownOptionNamesTheNearest) {
    EXPECT_NE(refusal({"a.toml", "--jason"}).find("did you mean '--json'?"), std::string::npos);
}

TEST(CliArguments, RefusesWhatItCannotMean) {
    EXPECT_NE(refusal({}).find("no SCENE given"), std::string::npos);
    EXPECT_NE(refusal({"a.toml", "b.toml"}).find("'b.toml'"), std::string::npos);
    EXPECT_NE(refusal({"a.toml", "--out"}).find("--out"), std::string::npos);  // its argument is missing
    EXPECT_NE(refusal({"a.toml", "--out", "x", "--out", "y"}).find("twice"), std::string::npos);
    EXPECT_NE(refusal({"a.toml", "--js"}), "not refused");  // no guessing of shortened names
    EXPECT_NE(refusal({"a.toml", "--json=yes"}), "not refused");
    EXPECT_NE(refusal({"--operand", "a.toml"}), "not refused");  // a name for our own use
}

TEST(CliProgram, ExitCodesAreTheDocumentedOnes) {
    EXPECT_EQ(run(synthetic_verb(), {"make", "a.toml"}), 0);
    EXPECT_EQ(run(synthetic_verb(), {"make", "--help"}), 0);
    EXPECT_EQ(run(synthetic_verb(), {"--version"}), 0);
    EXPECT_EQ(run(synthetic_verb(), {}), 2);
    EXPECT_EQ(run(synthetic_verb(), {"mke"}), 2);
    EXPECT_EQ(run(synthetic_verb(), {"--jsn"}), 2);
    EXPECT_EQ(run(synthetic_verb(), {"make"}), 2);
    EXPECT_EQ(run_throwing(UsageError("no")), 2);
    EXPECT_EQ(run_throwing(WriteError("a", "full")), 4);
    EXPECT_EQ(run_throwing(std::runtime_error("surprise")), 3);
}

TEST(CliProgram, StatusesMapToExitCodes) {
    EXPECT_EQ(exit_code(StatusCode::completed), ExitCode::done);
    EXPECT_EQ(exit_code(StatusCode::stopped_by_event), ExitCode::done);
    EXPECT_EQ(exit_code(StatusCode::not_opened), ExitCode::verdict);
    EXPECT_EQ(exit_code(StatusCode::refused), ExitCode::usage);
    EXPECT_EQ(exit_code(StatusCode::interrupted), ExitCode::interrupted);
    EXPECT_EQ(exit_code(StatusCode::strain_limit), ExitCode::numerical);
    EXPECT_EQ(static_cast<int>(ExitCode::interrupted), 130);
}

TEST(CliProgram, HelpShowsEveryOptionAndTheExample) {
    const std::string help = verb_help(synthetic_verb());
    for (const char* text :
         {"--out DIR", "--set KEY=VALUE", "--json", "-h, --help", "twinchute make a.toml"}) {
        EXPECT_NE(help.find(text), std::string::npos) << text;
    }
    EXPECT_NE(version_text().find("commit "), std::string::npos);
    EXPECT_NE(version_text().find("compiler "), std::string::npos);
}

}  // namespace
}  // namespace twinchute
