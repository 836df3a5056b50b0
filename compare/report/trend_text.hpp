// A comparison beside an earlier one: for a terminal, as Markdown and as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "compare/trend.hpp"
#include "lib/cli/text.hpp"

namespace twinchute::compare {

/// Names what is wrong with a metric that moved too far or is gone, in one line.
std::string failure_text(const MetricChange& change);

/// `baseline`: the directory of the earlier one, as the reader named it.
std::string trend_terminal(const Trend& trend, const std::string& baseline, const Style& style);

/// The text of trend.md.
std::string trend_markdown(const Trend& trend, const std::string& baseline, const std::string& scene);

/// The content of trend.json.
nlohmann::ordered_json trend_json(const Trend& trend, const std::string& baseline);

}  // namespace twinchute::compare
