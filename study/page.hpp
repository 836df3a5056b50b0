// Parts of a report page without scripts.
#pragma once

#include <string>

#include "compare/render/plot.hpp"

namespace twinchute::study {

/// `title` is escaped already.
std::string page_section(const std::string& id, const std::string& title, const std::string& body);
std::string page_figure(const compare::Plot& plot);
/// A self-contained page: style, sections, who made it. `title` as it is.
std::string whole_page(const std::string& title, const std::string& sections);

}  // namespace twinchute::study
