// The files that every HTML report carries with it, as they were when the program was built.
#pragma once

#include <span>
#include <string_view>

namespace twinchute::compare {

struct PageFile {
    std::string_view name, content;
};

/// Style and scripts of compare/report/page/, the libraries, NOTICE.
std::span<const PageFile> page_files();

/// The content of one of them; there is one of that name.
std::string_view page_file(std::string_view name);

}  // namespace twinchute::compare
