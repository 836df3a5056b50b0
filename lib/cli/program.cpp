#include "lib/cli/program.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/program_options.hpp>
#include <csignal>
#include <cstdio>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "lib/cli/help_commands.hpp"
#include "lib/cli/text.hpp"
#include "lib/record/record_error.hpp"
#include "lib/record/write_error.hpp"
#include "lib/scene/nearest.hpp"
#include "lib/scene/scene_error.hpp"

namespace twinchute {
namespace {

namespace po = boost::program_options;

const Option help_option{"help", "", "this page", false};

[[noreturn]] void fail_unknown_option(const Command& command, const std::string& option) {
    const std::vector<Option> options = options_of(command);
    std::vector<std::string> names;
    for (const Option& row : options)
        names.push_back("--" + row.name);
    throw UsageError(fmt::format("unknown option '{}' of `twinchute {}`, {}", option, command.name,
                                 suggest(option, {names.begin(), names.end()})));
}

void option_lines(std::string& text, const std::vector<Option>& options) {
    for (const Option& option : options) {
        const std::string left =
            option.name == "help" ? "-h, --help" : "--" + option.name + " " + option.value;
        const std::string gap = left.size() > 27 ? fmt::format("\n{:30}", "") : " ";
        text += fmt::format("  {:<27}{}{}{}\n", left, gap, option.meaning,
                            option.repeatable ? " (may be repeated)" : "");
    }
}

void say(const std::string& text) {
    std::fwrite(text.data(), 1, text.size(), stdout);
}

ExitCode run_words(std::span<const Command> commands, const std::vector<std::string>& words) {
    // Most runs are of a command that runs something: those about the program are made for the others.
    std::vector<Command> all;
    if (words.empty() || std::ranges::count(commands, words[0], &Command::name) == 0) {
        all = with_help_commands(commands);
        commands = all;
    }
    if (words.empty()) throw UsageError("no command given.\n\n" + program_help(commands));
    if (words[0] == "-h" || words[0] == "--help") {
        say(program_help(commands));
        return ExitCode::done;
    }
    if (words[0] == "-V" || words[0] == "--version") {
        say(version_text());
        return ExitCode::done;
    }
    const Command& command = find_command(commands, words[0]);
    const Arguments arguments = parse_arguments(command, {words.begin() + 1, words.end()});
    if (arguments.has("help")) {
        say(command_help(command));
        return ExitCode::done;
    }
    return command.run(arguments);
}

/// Standard output is a result too: a full disk behind a redirection must not pass for success.
void flush_output() {
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
        throw WriteError("standard output", "the device behind it did not take all of it");
    }
}

ExitCode complain(ExitCode code, const std::string& what) {
    const std::string line = printable(what, Newlines::keep) + "\n";
    std::fwrite(line.data(), 1, line.size(), stderr);
    return code;
}

/// Keeps what is freed for the next run. Calibrations and campaigns make thousands of runs with buffers of
/// the same sizes; glibc gives such buffers back after each, and to ask for them anew takes longer than the
/// run.
void keep_freed_memory() {
#ifdef __GLIBC__
    constexpr int largest = 32 << 20;  // [bytes] that glibc would ever keep by itself
    mallopt(M_MMAP_THRESHOLD, largest);
    mallopt(M_TRIM_THRESHOLD, 2 * largest);
#endif
}

}  // namespace

const char* const scene_operand_text = "SCENE is a TOML file, or - for standard input.";

const Command& find_command(std::span<const Command> commands, const std::string& name) {
    const auto command = std::ranges::find(commands, name, &Command::name);
    if (command != commands.end()) return *command;
    std::vector<std::string_view> known;
    for (const Command& row : commands)
        known.push_back(row.name);
    for (const std::string_view option : {"--help", "--version"})
        known.push_back(option);
    throw UsageError(fmt::format("unknown {} '{}', {}", name.starts_with('-') ? "option" : "command", name,
                                 suggest(name, known)));
}

std::vector<Option> options_of(const Command& command) {
    std::vector<Option> options = command.options;
    options.push_back(help_option);
    return options;
}

std::optional<std::string> Arguments::value(std::string_view name) const {
    const auto found = options.find(name);
    if (found == options.end() || found->second.empty()) return {};
    return found->second.back();
}

std::vector<std::string> Arguments::values(std::string_view name) const {
    const auto found = options.find(name);
    return found == options.end() ? std::vector<std::string>{} : found->second;
}

Arguments parse_arguments(const Command& command, const std::vector<std::string>& words) {
    po::options_description described;
    for (const Option& option : options_of(command)) {
        const std::string names = option.name == "help" ? "help,h" : option.name;
        if (option.value.empty()) {
            described.add_options()(names.c_str(), "");
        } else {
            described.add_options()(names.c_str(), po::value<std::vector<std::string>>()->composing(), "");
        }
    }
    // No guessing of shortened names: a script that works today must not become ambiguous tomorrow.
    const auto style = po::command_line_style::unix_style & ~po::command_line_style::allow_guessing;
    po::positional_options_description positional;
    positional.add("operand", -1);
    described.add_options()("operand", po::value<std::vector<std::string>>(), "");

    Arguments arguments;
    std::vector<std::string> operands;
    try {
        const auto parsed =
            po::command_line_parser(words).options(described).positional(positional).style(style).run();
        for (const auto& option : parsed.options) {
            if (option.string_key == "operand") {
                if (option.position_key < 0) fail_unknown_option(command, "--operand");
                operands.insert(operands.end(), option.value.begin(), option.value.end());
                continue;
            }
            auto& values = arguments.options[option.string_key];
            values.insert(values.end(), option.value.begin(), option.value.end());
        }
    } catch (const po::unknown_option& error) {
        fail_unknown_option(command, error.get_option_name());
    } catch (const po::error& error) {
        throw UsageError(fmt::format("{}. `twinchute {} --help` shows its use", error.what(), command.name));
    }
    if (arguments.has("help")) return arguments;

    for (const Option& option : command.options) {
        const std::vector<std::string> values = arguments.values(option.name);
        if (!option.repeatable && values.size() > 1) {
            throw UsageError(
                fmt::format("--{} is given twice (one place, one value), keep one", option.name));
        }
        // Mostly a variable of a script that is not set; as a path it would be the current directory.
        if (std::ranges::count(values, "") > 0) {
            throw UsageError(fmt::format("--{} is given nothing (its {} is empty), name one or leave it out",
                                         option.name, option.value));
        }
    }
    if (std::ranges::count(operands, "") > 0) {
        throw UsageError(fmt::format("an argument of `twinchute {}` is empty (it names nothing), e.g. {}",
                                     command.name, command.example));
    }
    const bool none = command.operand.empty(), several = command.operand.find("...") != std::string::npos;
    const bool optional = none || command.operand.starts_with('[');
    if (none && !operands.empty())
        throw UsageError(
            fmt::format("'{}' is one argument too many (`twinchute {}` takes options alone), "
                        "e.g. {}",
                        operands[0], command.name, command.example));
    if (operands.size() > 1 && !several) {
        throw UsageError(fmt::format("'{}' is one argument too many (`twinchute {}` takes one {})",
                                     operands[1], command.name, command.operand));
    }
    if (operands.empty() && !optional) {
        const std::string operand = command.operand.substr(0, command.operand.find("..."));
        throw UsageError(fmt::format("no {} given, e.g. {}", operand, command.example));
    }
    if (!operands.empty()) arguments.operand = operands[0];
    arguments.operands = std::move(operands);
    return arguments;
}

std::string program_help(std::span<const Command> commands) {
    std::string text =
        "twinchute runs one parachute scene at two fidelities and reports the gap.\n\n"
        "usage: twinchute COMMAND [options]\n\n";
    for (const Command& command : commands) {
        text += fmt::format("  {:<27} {}\n", command.name + " " + command.operand, command.summary);
    }
    text += "\n  -h, --help                  this page; after a command: its options and an example\n";
    text += "  -V, --version               version, commit and compiler\n";
    text += fmt::format("\n{}\n", scene_operand_text);
    if (!commands.empty()) text += fmt::format("\nexample: {}\n", commands.front().example);
    return text;
}

std::string command_help(const Command& command) {
    std::string text = fmt::format("{}\n\nusage: twinchute {}{}{} [options]\n\n", command.summary,
                                   command.name, command.operand.empty() ? "" : " ", command.operand);
    option_lines(text, options_of(command));
    text += fmt::format("\nexample: {}\n", command.example);
    return text;
}

std::string version_text() {
    const Provenance build = current_provenance();
    return fmt::format("twinchute {}\ncommit {}\ncompiler {} ({})\nflags {}\n", build.version, build.commit,
                       build.compiler, build.instruction_set, build.flags);
}

int run_program(std::span<const Command> commands, int argc, const char* const* argv) {
    // A file-size limit is a full disk: write() shall return the error instead of killing the process.
    std::signal(SIGXFSZ, SIG_IGN);
    keep_freed_memory();
    ExitCode code = ExitCode::done;
    try {
        code = run_words(commands, {argv + std::min(argc, 1), argv + argc});
        flush_output();
    } catch (const SceneError& error) {
        // "file:line:column: ..." as compilers write it, so that editors can jump there.
        const char* prefix = error.place().line > 0 ? "" : "twinchute: ";
        code = complain(ExitCode::usage, prefix + std::string(error.what()));
    } catch (const RecordError& error) {
        const char* prefix = error.place().line > 0 ? "" : "twinchute: ";
        code = complain(ExitCode::usage, prefix + std::string(error.what()));
    } catch (const UsageError& error) {
        code = complain(ExitCode::usage, fmt::format("twinchute: {}", error.what()));
    } catch (const WriteError& error) {
        code = complain(ExitCode::unwritable, fmt::format("twinchute: {}", error.what()));
    } catch (const std::exception& error) {
        code = complain(ExitCode::numerical, fmt::format("twinchute: unexpected failure: {}", error.what()));
    }
    return static_cast<int>(code);
}

}  // namespace twinchute
