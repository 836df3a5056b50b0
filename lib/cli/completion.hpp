// Completion of the command line in shells: scripts from the tables that run.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "lib/cli/command.hpp"

namespace twinchute {

struct Shell {
    std::string_view name;
    std::string (*script)(std::span<const Command> commands);
};

/// Shells that there is a script for.
std::span<const Shell> shells();

}  // namespace twinchute
