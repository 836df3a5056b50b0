// Parses the command line, runs its command and turns what happened into an exit code.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "lib/cli/command.hpp"

namespace twinchute {

/// Runs the command that the command line names; the value is the process's exit code. Every exception
/// ends here, as one line on standard error.
int run_program(std::span<const Command> commands, int argc, const char* const* argv);

/// The options of one command, taken apart. Throws UsageError with the nearest known option.
Arguments parse_arguments(const Command& command, const std::vector<std::string>& words);

/// The command of that name. Throws UsageError with the nearest known one.
const Command& find_command(std::span<const Command> commands, const std::string& name);

/// Its options, --help the last of them.
std::vector<Option> options_of(const Command& command);

std::string program_help(std::span<const Command> commands);
std::string command_help(const Command& command);

/// How to give a scene, a sentence for help and manual.
extern const char* const scene_operand_text;

/// "twinchute 0.1.0", then commit, compiler and instruction set.
std::string version_text();

}  // namespace twinchute
