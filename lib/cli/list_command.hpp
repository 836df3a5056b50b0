// `twinchute list`: what there is, from the same tables that run.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "lib/cli/command.hpp"
#include "lib/cli/text.hpp"

namespace twinchute {

struct ListTopic {
    std::string name;     ///< e.g. "laws"
    std::string summary;  ///< one line
    std::function<Table()> table;
    std::function<std::string()> text = {};  ///< for reading; empty: the table, aligned
};

/// Topics of the shared library: keys, laws, materials, scenes.
std::vector<ListTopic> library_topics();

Command list_command(std::vector<ListTopic> topics);

}  // namespace twinchute
