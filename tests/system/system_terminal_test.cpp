// Colour on a terminal, and only there.
#include <fcntl.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <regex>
#include <sstream>
#include <thread>

#include "lib/cli/text.hpp"
#include "tests/support/short_scene.hpp"

namespace twinchute::test {
namespace {

class SystemTerminal : public ShortScene {
protected:
    /// Containers need not have pseudo-terminals.
    void SetUp() override {
        const int master = ::posix_openpt(O_RDWR | O_NOCTTY);
        const bool has = master >= 0 && ::grantpt(master) == 0 && ::unlockpt(master) == 0 &&
                         ::access(::ptsname(master), R_OK | W_OK) == 0;
        if (!has) why_not_ = std::strerror(errno);
        if (master >= 0) ::close(master);
    }

    /// Output of the program on a terminal. The other end is read meanwhile: a terminal holds some kB.
    std::string on_terminal(const Words& environment, const Words& words, unsigned short columns = 0) {
        const int master = ::posix_openpt(O_RDWR | O_NOCTTY);
        if (master < 0 || ::grantpt(master) != 0 || ::unlockpt(master) != 0) return "no terminal";
        const std::string device = ::ptsname(master);
        const int held =
            ::open(device.c_str(), O_RDWR | O_NOCTTY);  // so that the end of the program is no hang-up
        const winsize size{50, columns, 0, 0};
        EXPECT_EQ(::ioctl(held, TIOCSWINSZ, &size), 0);
        Words all{"/usr/bin/env", "-u", "NO_COLOR", "-u", "COLUMNS", "TERM=xterm"};
        all.insert(all.end(), environment.begin(), environment.end());
        all.push_back(TWINCHUTE_PROGRAM);
        all.insert(all.end(), words.begin(), words.end());
        std::string text;
        std::thread reader([&] {
            char buffer[4096];
            while (text.find("<end>") == std::string::npos) {
                const ssize_t count = ::read(master, buffer, sizeof buffer);
                if (count <= 0) break;
                text.append(buffer, static_cast<std::size_t>(count));
            }
        });
        Process(all, here_.path(), device).wait();
        EXPECT_EQ(::write(held, "<end>", 5), 5);
        reader.join();
        ::close(held);
        ::close(master);
        text.resize(text.find("<end>"));
        return std::regex_replace(text, std::regex("\r\n"), "\n");
    }
    static bool has_colour(const std::string& text) { return text.find('\x1b') != std::string::npos; }

    std::string why_not_;  // there are pseudo-terminals here
};

TEST_F(SystemTerminal, KeysAreWrappedToItsWidth) {
    if (!why_not_.empty()) GTEST_SKIP() << "no pseudo-terminals here: " << why_not_;
    const Words keys{"list", "keys"};
    for (const int columns : {60, 120}) {
        std::istringstream text(on_terminal({}, keys, static_cast<unsigned short>(columns)));
        std::size_t widest = 0;
        for (std::string line; std::getline(text, line);)
            if (line.find(' ', line.find_first_not_of(' ')) != std::string::npos)  // not one long word
                widest = std::max(widest, columns_of(line));
        EXPECT_LE(widest, static_cast<std::size_t>(columns));
        EXPECT_GT(widest, static_cast<std::size_t>(columns - 20));
    }
}

TEST_F(SystemTerminal, ColourOnlyOnATerminalThatWantsIt) {
    if (!why_not_.empty()) GTEST_SKIP() << "no pseudo-terminals here: " << why_not_;
    run({"compare", "scene.toml", "--quiet", "--out", "out", "--tolerance", "force_history=1%"});
    const Words report{"report", "out"};
    const std::string piped = run(report).out, painted = on_terminal({}, report);
    EXPECT_FALSE(has_colour(piped));
    ASSERT_TRUE(has_colour(painted));
    // Colour takes no columns: without its codes it is the same text.
    EXPECT_EQ(std::regex_replace(painted, std::regex("\x1b\\[[0-9;]*m"), ""), piped);
    EXPECT_NE(painted.find("\x1b[32mwithin"), std::string::npos) << painted;
    EXPECT_NE(painted.find("\x1b[31mmissing"), std::string::npos) << painted;
    for (const char* environment : {"NO_COLOR=1", "TERM=dumb"})
        EXPECT_EQ(on_terminal({environment}, report), piped) << environment;
    EXPECT_TRUE(has_colour(on_terminal({"NO_COLOR="}, report)));  // no-color.org: when not empty
}

TEST_F(SystemTerminal, ColumnsAreAligned) {
    run({"compare", "scene.toml", "--quiet", "--out", "out"});
    std::istringstream text(run({"report", "out"}).out);
    std::string line;
    while (std::getline(text, line) && !line.starts_with("metric")) {
    }
    // The difference column is aligned right: its last character stands under that of its head, in every row.
    const std::size_t end = line.find("difference") + std::string("difference").size();
    int rows = 0;
    while (std::getline(text, line) && !line.starts_with("Differences are")) {
        ASSERT_GT(columns_of(line), end) << line;
        EXPECT_NE(line[end - 1], ' ') << line;
        EXPECT_EQ(line[end], ' ') << line;
        ++rows;
    }
    EXPECT_GT(rows, 10);
}

}  // namespace
}  // namespace twinchute::test
