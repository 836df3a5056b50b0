// Parts of a report page without scripts.
#pragma once

#include <string>

#include "compare/render/plot.hpp"

namespace twinchute::compare {

/// `title` is escaped already.
std::string page_section(const std::string& id, const std::string& title, const std::string& body);
std::string page_figure(const Plot& plot);
/// A self-contained page: title, what it is about ("a campaign"), sections, who made it. Words as they are.
std::string still_page(const std::string& title, const std::string& what, const std::string& sections);

}  // namespace twinchute::compare
