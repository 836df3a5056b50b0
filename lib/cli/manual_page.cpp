#include "lib/cli/manual_page.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "lib/cli/program.hpp"

namespace twinchute {
namespace {

/// A word that roff prints as it is: a hyphen stays the character that a shell takes.
std::string escaped(std::string_view text) {
    std::string roff;
    for (const char c : text) {
        if (c == '\\')
            roff += "\\e";
        else if (c == '-')
            roff += "\\-";
        else
            roff += c;
    }
    return roff;
}

/// Running text: a line a sentence, none longer than 80 bytes where words allow, none taken for a request.
std::string prose(std::string_view text) {
    constexpr std::size_t width = 76;
    std::string roff, line;
    const auto flush = [&] {
        if (line.empty()) return;
        roff += (line[0] == '.' || line[0] == '\'' ? "\\&" : "") + line + "\n";
        line.clear();
    };
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find_first_of(" \n", begin), text.size());
        const std::string word = escaped(text.substr(begin, end - begin));
        begin = end + 1;
        if (word.empty()) continue;
        if (line.size() + 1 + word.size() > width) flush();
        line += (line.empty() ? "" : " ") + word;
        const bool ends =
            word.ends_with('.') && begin < text.size() && text[begin] >= 'A' && text[begin] <= 'Z';
        if (ends) flush();  // a sentence
    }
    flush();
    return roff;
}

/// "DIR..." in italics, the brackets around what is optional not.
std::string placeholder(std::string_view text) {
    std::string roff;
    bool italic = false;
    for (const char c : text) {
        const bool is_name = c != '[' && c != ']' && c != '.' && c != '=' && c != '/';
        if (is_name != italic) roff += is_name ? "\\fI" : "\\fR";
        italic = is_name;
        roff += escaped({&c, 1});
    }
    return roff + (italic ? "\\fR" : "");
}

std::string head(const std::string& name, const std::string& summary) {
    const Provenance build = current_provenance();
    std::string title = name;
    std::ranges::transform(title, title.begin(),
                           [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c; });
    return fmt::format(".TH {} 1 {} \"twinchute {}\" \"User Commands\"\n.SH NAME\n", title,
                       build.date.substr(0, 10), build.version) +
           prose(name + " - " + summary);
}

std::string synopsis(const Command& command) {
    return fmt::format("\\fBtwinchute {}\\fR {}{}[\\fIoptions\\fR]\n", command.name,
                       placeholder(command.operand), command.operand.empty() ? "" : " ");
}

std::string options_section(const std::vector<Option>& options) {
    std::string text = ".SH OPTIONS\n";
    for (const Option& option : options) {
        const std::string dashes = escaped("--" + option.name);
        text += ".TP\n";
        text += option.name == "help"
                    ? fmt::format("\\fB\\-h\\fR, \\fB{}\\fR\n", dashes)
                    : fmt::format("\\fB{}\\fR{}{}\n", dashes, option.value.empty() ? "" : " ",
                                  placeholder(option.value));
        text += prose(option.meaning + (option.repeatable ? " (may be repeated)" : ""));
    }
    return text;
}

std::string example_section(const std::string& example) {
    return fmt::format(".SH EXAMPLES\n.EX\n{}\n.EE\n", escaped(example));
}

}  // namespace

std::string manual_page(const Command& command) {
    std::string text = head("twinchute-" + command.name, command.summary);
    text += ".SH SYNOPSIS\n" + synopsis(command);
    if (command.operand == "SCENE") text += ".SH DESCRIPTION\n" + prose(scene_operand_text);
    if (!command.operand_words.empty()) {
        std::string words;
        for (const std::string& word : command.operand_words)
            words += (words.empty() ? "" : ", ") + word;
        text += ".SH DESCRIPTION\n" + prose("The first argument is one of: " + words + ".");
    }
    text += options_section(options_of(command)) + example_section(command.example);
    return text + ".SH SEE ALSO\n.BR twinchute (1)\n";
}

std::string manual_page(std::span<const Command> commands) {
    std::string text = head("twinchute", "parachutes at two fidelities, and the gap between them");
    text += ".SH SYNOPSIS\n\\fBtwinchute\\fR \\fICOMMAND\\fR [\\fIoptions\\fR]\n.SH DESCRIPTION\n";
    text += prose(
        "twinchute runs one parachute scene at two fidelities and reports the gap. The reduced-order model "
        "moves a rigid body along its trajectory; the full model follows every panel of fabric and every "
        "line.");
    text += ".PP\n" + prose(scene_operand_text) +
            prose(
                "`twinchute list keys` says what a scene may hold, `twinchute list scenes` names those to "
                "start from.");
    text += ".SH COMMANDS\n";
    for (const Command& command : commands)
        text += ".TP\n" + synopsis(command) + prose(command.summary + ".") +
                fmt::format("See \\fBtwinchute\\-{}\\fR(1).\n", escaped(command.name));
    text += ".SH OPTIONS\n.TP\n\\fB\\-h\\fR, \\fB\\-\\-help\\fR\n" +
            prose("the commands; after a command: its options and an example") +
            ".TP\n\\fB\\-V\\fR, \\fB\\-\\-version\\fR\n" + prose("version, commit and compiler");
    text += ".SH EXIT STATUS\n";
    for (const ExitMeaning& row : exit_meanings())
        text += fmt::format(".TP\n.B {}\n", static_cast<int>(row.code)) + prose(row.meaning);
    text += ".SH ENVIRONMENT\n.TP\n.B TWINCHUTE_DATA\n" +
            prose(
                "where data files are looked for after the directory of the scene and before those that "
                "came with the program") +
            ".TP\n.B TWINCHUTE_INSTRUCTION_SET\n" +
            prose(
                "instruction set of the full model's kernels, for the same bits on processors of several "
                "kinds: `AVX-512`, `AVX2`, `SSE4`, `NEON` or `generic`; by default the widest that the "
                "processor has") +
            ".TP\n.B NO_COLOR\n" + prose("no colour on a terminal");
    if (!commands.empty()) text += example_section(commands.front().example);
    text += ".SH SEE ALSO\n";
    for (const Command& command : commands)
        text += fmt::format(".BR twinchute\\-{} (1){}\n", escaped(command.name),
                            &command == &commands.back() ? "" : ",");
    return text;
}

}  // namespace twinchute
