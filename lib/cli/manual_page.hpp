// Manual pages in roff, man(7), from the tables that run.
#pragma once

#include <span>
#include <string>

#include "lib/cli/command.hpp"

namespace twinchute {

/// twinchute(1). The date is that of SOURCE_DATE_EPOCH, or today's.
std::string manual_page(std::span<const Command> commands);

/// twinchute-COMMAND(1).
std::string manual_page(const Command& command);

}  // namespace twinchute
