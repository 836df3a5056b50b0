// Occurrences of a part in a text.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace twinchute::test {

inline std::size_t count_of(std::string_view text, std::string_view part) {
    std::size_t found = 0;
    for (std::size_t at = 0; (at = text.find(part, at)) != std::string_view::npos; at += part.size())
        ++found;
    return found;
}

}  // namespace twinchute::test
