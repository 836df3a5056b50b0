// Words of the field on a page: explained where a reader points at them, and in a list.
#pragma once

#include <string>

namespace twinchute::compare {

/// The body of a page with the glossary's words in it marked up: in headings of rows, of cards and of plots
/// the longest term of docs/glossary.md becomes an element `abbr` with its meaning, and a section at the end
/// lists those that were found.
std::string with_glossary(const std::string& body);

}  // namespace twinchute::compare
