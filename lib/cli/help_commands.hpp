// Commands about the program itself, made from the table of the others: `help`, `manual` and `completion`.
#pragma once

#include <span>
#include <vector>

#include "lib/cli/command.hpp"

namespace twinchute {

/// All commands, those about the program itself last. `commands` has to outlive the result.
std::vector<Command> with_help_commands(std::span<const Command> commands);

}  // namespace twinchute
