// One row per command: its name, what it takes and what it does.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "lib/cli/exit_code.hpp"

namespace twinchute {

/// Something wrong with the command line; what() reads "problem (why), suggestion". Exit code 2.
class UsageError : public std::runtime_error {
    using std::runtime_error::runtime_error;
};

struct Option {
    std::string name;   ///< without the dashes, e.g. "out"
    std::string value;  ///< placeholder of its argument, e.g. "DIR"; empty: a switch
    std::string meaning;
    bool repeatable = false;
    std::vector<std::string> words = {};  ///< its argument is one of these; empty: whatever `value` says
};

/// The command line after the command; every name is an option of that command.
struct Arguments {
    std::string operand;  ///< the first positional argument; empty when it is optional and absent
    std::vector<std::string> operands;  ///< all of them; more than one only where the command takes several
    std::map<std::string, std::vector<std::string>, std::less<>> options;

    bool has(std::string_view name) const { return options.contains(name); }
    std::optional<std::string> value(std::string_view name) const;
    std::vector<std::string> values(std::string_view name) const;
};

struct Command {
    std::string name;
    std::string summary;  ///< one line
    std::string operand;  ///< "SCENE"; "[TOPIC]" when it may be left out, "DIR..." when there may be several,
                          ///< "[SUITE...]" both; empty when there is none
    std::string example;  ///< a command line that runs as it stands
    std::vector<Option> options;
    /// Throws UsageError, SceneError or WriteError.
    std::function<ExitCode(const Arguments&)> run;
    std::vector<std::string> operand_words = {};  ///< the first operand is one of these; empty: see `operand`
};

}  // namespace twinchute
