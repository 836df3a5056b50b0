#include "fullsim/storage/simd/instruction_sets.hpp"

#include <fmt/ranges.h>

#include <cstdlib>

#include "lib/scene/scene_error.hpp"

namespace twinchute::fullsim {

const std::string& wanted_instruction_set() {
    static const std::string wanted = [] {
        const char* text = std::getenv("TWINCHUTE_INSTRUCTION_SET");
        return std::string(text ? text : "");
    }();
    return wanted;
}

void refuse_instruction_set(std::string_view wanted, const std::vector<std::string_view>& there_are) {
    throw SceneError(
        {std::string(wanted)}, "", "TWINCHUTE_INSTRUCTION_SET names no instruction set of this machine",
        fmt::format("it has {}", fmt::join(there_are, ", ")), "set it to one of these, or unset it");
}

}  // namespace twinchute::fullsim
