// How a metric goes with another over the cases of a series: what a paper states in words, as a number.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace twinchute::compare {

/// One case of a series as it came out.
struct SeriesPoint {
    std::string name, group;
    std::map<std::string, double> metrics;  ///< by name without unit
};

/// Question about the cases.
struct TrendAsked {
    enum class Kind {
        rises,     ///< share of steps from one case to the next by x in which y rises [-]
        falls,     ///< ... in which it falls
        exponent,  ///< slope of ln y over ln x by least squares [-]; in several bundles about the mean of
                   ///< each
        spread     ///< largest y less smallest, over their mean [-]; the largest among the bundles
    };
    Kind kind = Kind::rises;
    std::string y, x;  ///< metrics; x: of what it is a trend, none for a spread
    std::string
        within;  ///< cases are bundled by equal values of this metric, or by "group"; empty: one bundle
    std::vector<std::string> cases;  ///< names; empty: all of the series
};

/// "rises", "falls", "exponent", "spread".
std::string_view trend_name(TrendAsked::Kind kind);
/// E.g. "share of steps in which peak_force_ratio rises with froude_number, at equal group".
std::string trend_words(const TrendAsked& asked);

/// Nothing where a case lacks a metric, or no bundle has two cases.
std::optional<double> trend_of(const TrendAsked& asked, std::span<const SeriesPoint> points);

}  // namespace twinchute::compare
