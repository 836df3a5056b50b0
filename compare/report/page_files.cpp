#include "compare/report/page_files.hpp"

#include <algorithm>
#include <cassert>

namespace twinchute::compare {

std::string_view page_file(std::string_view name) {
    const auto found = std::ranges::find(page_files(), name, &PageFile::name);
    assert(found != page_files().end());
    return found->content;
}

}  // namespace twinchute::compare
