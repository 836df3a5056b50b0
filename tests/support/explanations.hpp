// Pages explain words of the glossary; tests of what stands there read past that.
#pragma once

#include <string>

namespace twinchute::test {

inline std::string without_explanations(std::string page) {
    for (std::size_t at = 0; (at = page.find("<abbr ", at)) != page.npos;) {
        page.erase(at, page.find('>', at) - at + 1);
        page.erase(page.find("</abbr>", at), 7);
    }
    return page;
}

}  // namespace twinchute::test
