// The options --test and --test-clock of commands that compare.
#pragma once

#include <optional>
#include <vector>

#include "compare/drop_test_histories.hpp"
#include "lib/cli/command.hpp"

namespace twinchute::compare {

std::vector<Option> drop_test_options();

/// The file that they name, read. Throws SceneError and UsageError.
std::optional<DropTestHistories> test_of(const Arguments& arguments);

}  // namespace twinchute::compare
