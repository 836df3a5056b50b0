// Which of the instruction sets that a machine has its kernels are taken from.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace twinchute::fullsim {

/// Instruction set that the environment asks for, by its name in a record; empty: the widest there is. Fixed
/// when first asked for.
const std::string& wanted_instruction_set();

/// Throws SceneError: `wanted` is none of those.
[[noreturn]] void refuse_instruction_set(std::string_view wanted,
                                         const std::vector<std::string_view>& there_are);

/// Kernels of this machine, the widest first, without those that are wider than `wanted`.
/// Throws SceneError where none is of that set.
template <class Kernels>
std::vector<Kernels> up_to(std::string_view wanted, std::vector<Kernels> found) {
    if (wanted.empty()) return found;
    const auto first = std::ranges::find(found, wanted, &Kernels::instruction_set);
    if (first == found.end()) {
        std::vector<std::string_view> names;
        for (const Kernels& kernels : found)
            names.push_back(kernels.instruction_set);
        refuse_instruction_set(wanted, names);
    }
    found.erase(found.begin(), first);
    return found;
}

}  // namespace twinchute::fullsim
