// The option --test of commands that compare.
#pragma once

#include <optional>

#include "compare/drop_test_histories.hpp"
#include "lib/cli/command.hpp"

namespace twinchute::compare {

Option drop_test_option();

/// The file that it names, read. Throws SceneError.
std::optional<DropTestHistories> test_of(const Arguments& arguments);

}  // namespace twinchute::compare
