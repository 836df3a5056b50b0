// Names come from files that anybody may have written; here they become harmless in each format.
#pragma once

#include <string>
#include <string_view>

namespace twinchute::compare {

/// Valid UTF-8 without control characters; what is not becomes U+FFFD. Newlines and tabs become spaces.
std::string clean_text(std::string_view text);

/// Text for an XML element or a quoted attribute.
std::string xml_text(std::string_view text);

/// Text for a line or a table cell of Markdown: every character that starts markup is escaped.
std::string markdown_text(std::string_view text);

}  // namespace twinchute::compare
