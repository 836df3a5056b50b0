// From the command line to a verb, and from whatever happened there to an exit code.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "lib/cli/verb.hpp"

namespace twinchute {

/// Runs the verb that the command line names; the value is the process's exit code. Every exception
/// ends here, as one line on standard error.
int run_program(std::span<const Verb> verbs, int argc, const char* const* argv);

/// The options of one verb, taken apart. Throws UsageError with the nearest known option.
Arguments parse_arguments(const Verb& verb, const std::vector<std::string>& words);

std::string program_help(std::span<const Verb> verbs);
std::string verb_help(const Verb& verb);

/// "twinchute 0.1.0", then commit, compiler and instruction set.
std::string version_text();

}  // namespace twinchute
