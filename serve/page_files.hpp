// The page that is served, as it was when the program was built.
#pragma once

#include <span>
#include <string>

#include "compare/report/page_files.hpp"

namespace twinchute::serve {

/// The files of serve/page/.
std::span<const compare::PageFile> page_files();

/// page.html in one piece: what it names by `<link rel="stylesheet" href="NAME">` and `<script
/// src="NAME"></script>`, a file of serve/page/ or of report pages, stands in it instead.
std::string page_html();

}  // namespace twinchute::serve
