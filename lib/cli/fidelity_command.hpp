// The command of one fidelity: run the scene with it and say what came out.
#pragma once

#include <vector>

#include "lib/cli/command.hpp"
#include "lib/solve/fidelity.hpp"

namespace twinchute {

/// Where a single run leaves its record when --out does not say.
enum class DefaultOutput {
    none,      ///< standard output only
    directory  ///< "./<scene file>.out"
};

/// `others`: fidelities to point to when this one lacks physics that the scene asks for. The rows must
/// outlive the command.
Command fidelity_command(const Fidelity& fidelity, std::string summary, DefaultOutput output,
                         std::vector<const Fidelity*> others);

}  // namespace twinchute
