// Help, manual pages and completions: one table of options stands behind all of them, so that each says what
// `COMMAND --help` says. Tools of the system read them: man pages are checked by mandoc and groff,
// completions are asked for in the shells themselves.
#include <regex>
#include <set>

#include "tests/support/program_test.hpp"

namespace twinchute::test {
namespace {

class SystemManual : public ProgramTest {
protected:
    /// Runs a line in a shell, with the program as $T.
    Ended shell(const std::string& line) {
        return Process({"/usr/bin/env", std::string("T=") + TWINCHUTE_PROGRAM, "/bin/bash", "-c", line},
                       here_.path())
            .wait();
    }
    bool there_is(const std::string& tool) { return shell("command -v " + tool).code == 0; }

    /// As the help of the program lists them.
    std::vector<std::string> commands() {
        std::vector<std::string> names;
        const std::string help = run({"--help"}).out;
        const std::regex row("^  ([a-z]+) ", std::regex::ECMAScript | std::regex::multiline);
        for (std::sregex_iterator at(help.begin(), help.end(), row), end; at != end; ++at)
            names.push_back((*at)[1]);
        return names;
    }

    /// As the help of a command lists them, without the dashes.
    std::set<std::string> options(const std::string& command) {
        std::set<std::string> names;
        const std::string help = run({command, "--help"}).out;
        const std::regex row("^  (?:-h, )?--([a-z-]+)", std::regex::ECMAScript | std::regex::multiline);
        for (std::sregex_iterator at(help.begin(), help.end(), row), end; at != end; ++at)
            names.insert((*at)[1]);
        return names;
    }

    /// Words that bash proposes for the last of these.
    std::set<std::string> proposals(const Words& words) {
        std::string line = "source completion.bash; complete -p twinchute >/dev/null || exit 9; COMP_WORDS=(";
        for (const std::string& word : words)
            line += "'" + word + "' ";
        line += "); COMP_CWORD=" + std::to_string(words.size() - 1) +
                "; _twinchute twinchute; printf '%s\\n' \"${COMPREPLY[@]}\"";
        const Ended ended = shell(line);
        EXPECT_EQ(ended.err, "") << line;
        std::set<std::string> found;
        std::istringstream lines(ended.out);
        for (std::string proposal; std::getline(lines, proposal);)
            if (!proposal.empty()) found.insert(proposal);
        return found;
    }
};

using Set = std::set<std::string>;

TEST_F(SystemManual, HelpOfACommandIsItsPage) {
    EXPECT_EQ(run({"help"}).out, run({"--help"}).out);
    EXPECT_EQ(run({"-V"}).out, run({"--version"}).out);
    const std::vector<std::string> names = commands();
    ASSERT_GE(names.size(), 16u);
    for (const std::string& command : names) {
        const Ended page = run({"help", command});
        EXPECT_EQ(page.code, 0);
        EXPECT_EQ(page.out, run({command, "--help"}).out);
    }
    const Ended wrong = run({"help", "compar"});
    EXPECT_EQ(wrong.code, 2);
    EXPECT_NE(wrong.err.find("unknown command 'compar', did you mean 'compare'?"), std::string::npos)
        << wrong.err;
    EXPECT_EQ(run({"manual", "compar"}).code, 2);
    const Ended csh = run({"completion", "csh"});
    EXPECT_EQ(csh.code, 2);
    EXPECT_NE(csh.err.find("did you mean 'zsh'?"), std::string::npos) << csh.err;
    EXPECT_TRUE(nothing_written());
}

TEST_F(SystemManual, EveryOptionOfEveryCommandStandsInItsPageAndInAllCompletions) {
    const std::string bash = run({"completion", "bash"}).out, zsh = run({"completion", "zsh"}).out,
                      fish = run({"completion", "fish"}).out, whole = run({"manual"}).out;
    // From the row of a command to the next one.
    const auto part = [](const std::string& text, const std::string& from, const std::string& to) {
        const std::size_t begin = text.find(from);
        EXPECT_NE(begin, std::string::npos) << from;
        return begin == std::string::npos ? "" : text.substr(begin, text.find(to, begin) - begin);
    };
    for (const std::string& command : commands()) {
        EXPECT_NE(whole.find("twinchute\\-" + command + "\\fR(1)"), std::string::npos) << command;
        const std::string page = run({"manual", command}).out,
                          of_bash = part(bash, "    " + command + ")\n", "        ;;\n"),
                          of_zsh = part(zsh, "    " + command + ")\n", "        ;;\n");
        const std::set<std::string> names = options(command);
        EXPECT_TRUE(names.contains("help"));
        for (const std::string& option : names) {
            const std::string roff = std::regex_replace("--" + option, std::regex("-"), "\\-");
            EXPECT_NE(page.find("\\fB" + roff + "\\fR"), std::string::npos) << command << " " << option;
            for (const std::string& script : {of_bash, of_zsh})
                EXPECT_TRUE(std::regex_search(script, std::regex("--" + option + "[^a-z-]")))
                    << command << " " << option;
            EXPECT_NE(fish.find(command + "'" + (option == "help" ? " -s h" : "") + " -l " + option + " "),
                      std::string::npos)
                << command << " " << option;
        }
    }
}

TEST_F(SystemManual, TheDateOfAPageCanBePinned) {
    EXPECT_TRUE(
        shell("SOURCE_DATE_EPOCH=0 $T manual rom").out.starts_with(".TH TWINCHUTE-ROM 1 1970-01-01 "));
    EXPECT_EQ(run({"manual", "--out", "pages", "rom"}).code, 2);
    EXPECT_EQ(run({"manual", "--out", "pages"}).code, 0);
    EXPECT_EQ(tree_of(here_ / "pages").size(), commands().size() + 1);
    EXPECT_EQ(text("pages/twinchute-rom.1"), run({"manual", "rom"}).out);
}

TEST_F(SystemManual, MandocAndGroffHaveNothingToComplainOf) {
    EXPECT_EQ(run({"manual", "--out", "pages"}).code, 0);
    const bool mandoc = there_is("mandoc"), groff = there_is("groff");
    if (!mandoc && !groff) GTEST_SKIP() << "neither mandoc nor groff is installed";
    if (mandoc) {
        // References between pages lead into the directory itself.
        const Ended lint = shell("mandoc -T lint -W style pages/*.1");
        EXPECT_EQ(lint.out + lint.err, "");
    }
    if (groff) {
        const Ended printed = shell("for p in pages/*.1; do groff -man -ww -Tascii -z \"$p\"; done");
        EXPECT_EQ(printed.out + printed.err, "");
    }
}

TEST_F(SystemManual, BashCompletesCommandsOptionsValuesFilesAndKeys) {
    here_.write("completion.bash", run({"completion", "bash"}).out);
    here_.write("scene.toml", "");
    here_.write("scene.txt", "");
    here_.write("scenes/a b.toml", "");
    here_.write("drop.csv", "");
    const std::vector<std::string> names = commands();
    Set all(names.begin(), names.end());
    for (const char* option : {"-h", "--help", "-V", "--version"})
        all.insert(option);
    EXPECT_EQ(proposals({"twinchute", ""}), all);
    EXPECT_EQ(proposals({"twinchute", "com"}), (Set{"compare", "completion"}));
    EXPECT_EQ(proposals({"twinchute", "rom", "--s"}), (Set{"--set", "--sensitivity"}));
    Set of_rom{"-h"};
    for (const std::string& option : options("rom"))
        of_rom.insert("--" + option);
    EXPECT_EQ(proposals({"twinchute", "rom", "scene.toml", "-"}), of_rom);
    EXPECT_EQ(proposals({"twinchute", "rom", "sc"}), (Set{"scene.toml", "scenes"}));
    EXPECT_EQ(proposals({"twinchute", "rom", "scenes/a"}), (Set{"scenes/a b.toml"}));
    EXPECT_EQ(proposals({"twinchute", "rom", "--out", "s"}), (Set{"scenes"}));
    EXPECT_EQ(proposals({"twinchute", "rom", "--out", "=", "s"}), (Set{"scenes"}));
    EXPECT_EQ(proposals({"twinchute", "rom", "--out", "="}), (Set{"scenes"}));
    EXPECT_EQ(proposals({"twinchute", "ladder", "--reference", "d"}), (Set{"drop.csv"}));
    EXPECT_EQ(proposals({"twinchute", "rom", "--set", "payload.ma"}), (Set{"payload.mass="}));
    EXPECT_EQ(proposals({"twinchute", "rom", "--set", "payload.mass", "=", ""}), Set{});
    EXPECT_EQ(proposals({"twinchute", "compare", "--tolerance", "filling_"}), (Set{"filling_time="}));
    EXPECT_EQ(proposals({"twinchute", "compare", "--threads", ""}), Set{});
    EXPECT_EQ(proposals({"twinchute", "mesh", "--msh-version", ""}), (Set{"2.2", "4.1"}));
    EXPECT_EQ(proposals({"twinchute", "completion", ""}), (Set{"bash", "fish", "zsh"}));
    EXPECT_EQ(proposals({"twinchute", "help", "cal"}), (Set{"calibrate"}));
    EXPECT_EQ(proposals({"twinchute", "list", "t"}), (Set{"types"}));
    EXPECT_EQ(proposals({"twinchute", "list", "keys", "payload.mas"}), (Set{"payload.mass"}));
    EXPECT_EQ(proposals({"twinchute", "stability", ""}), Set{});
}

TEST_F(SystemManual, ZshReadsItsScript) {
    if (!there_is("zsh")) GTEST_SKIP() << "zsh is not installed";
    here_.write("_twinchute", run({"completion", "zsh"}).out);
    const Ended read = shell(
        "zsh -n _twinchute && zsh -fc 'fpath=($PWD $fpath); autoload -Uz compinit && "
        "compinit -D -u && echo ${_comps[twinchute]}; source ./_twinchute'");
    EXPECT_EQ(read.out, "_twinchute\n");
    EXPECT_EQ(read.err, "");
}

TEST_F(SystemManual, FishProposesWhatBashDoes) {
    if (!there_is("fish")) GTEST_SKIP() << "fish is not installed";
    here_.write("twinchute.fish", run({"completion", "fish"}).out);
    here_.write("scene.toml", "");
    here_.write("drop.csv", "");
    const auto fish = [&](const std::string& line) {
        const Ended ended =
            shell("HOME=$PWD XDG_CONFIG_HOME=$PWD fish --private -c 'source twinchute.fish; complete -C \"" +
                  line + "\"' | cut -f1 | sort | tr '\\n' ' '");
        EXPECT_EQ(ended.err, "") << line;
        return ended.out;
    };
    EXPECT_EQ(fish("twinchute com"), "compare completion ");
    EXPECT_EQ(fish("twinchute rom --s"), "--sensitivity --set ");
    EXPECT_EQ(fish("twinchute rom sc"), "scene.toml ");
    EXPECT_EQ(fish("twinchute help cal"), "calibrate ");
    EXPECT_EQ(fish("twinchute rom --set payload.ma"), "payload.mass= ");
    EXPECT_EQ(fish("twinchute mesh --msh-version "), "2.2 4.1 ");
    EXPECT_EQ(fish("twinchute list keys payload.mas"), "payload.mass ");
    EXPECT_EQ(fish("twinchute compare --tolerance filling_"), "filling_time= ");
}

}  // namespace
}  // namespace twinchute::test
