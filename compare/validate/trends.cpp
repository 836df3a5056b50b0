#include "compare/validate/trends.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace twinchute::compare {
namespace {

constexpr double same = 1e-6;  // relative difference of values that count as equal: inputs that were typed

std::optional<double> value_of(const SeriesPoint& point, const std::string& metric) {
    const auto found = point.metrics.find(metric);
    return found == point.metrics.end() || !std::isfinite(found->second) ? std::nullopt
                                                                         : std::optional(found->second);
}

using Bundle = std::vector<const SeriesPoint*>;

bool belong_together(const std::string& within, const SeriesPoint& a, const SeriesPoint& b) {
    if (within.empty()) return true;
    if (within == "group") return a.group == b.group;
    const double x = *value_of(a, within), y = *value_of(b, within);
    return std::abs(x - y) <= same * std::max(std::abs(x), std::abs(y));
}

std::vector<Bundle> bundles_of(const std::string& within, const Bundle& points) {
    std::vector<Bundle> bundles;
    for (const SeriesPoint* point : points) {
        const auto home = std::ranges::find_if(
            bundles, [&](const Bundle& b) { return belong_together(within, *b.front(), *point); });
        if (home == bundles.end())
            bundles.push_back({point});
        else
            home->push_back(point);
    }
    std::erase_if(bundles, [](const Bundle& b) { return b.size() < 2; });
    return bundles;
}

double spread_of(const TrendAsked& asked, const std::vector<Bundle>& bundles) {
    double largest = 0.0;
    for (const Bundle& bundle : bundles) {
        std::vector<double> values;
        double sum = 0.0;
        for (const SeriesPoint* point : bundle)
            sum += values.emplace_back(*value_of(*point, asked.y));
        const auto [low, high] = std::ranges::minmax_element(values);
        const double spread = (*high - *low) / std::abs(sum / static_cast<double>(values.size()));
        if (std::isnan(spread)) return spread;
        largest = std::max(largest, spread);
    }
    return largest;
}

double exponent_of(const TrendAsked& asked, const std::vector<Bundle>& bundles) {
    double both = 0.0, square = 0.0;
    for (const Bundle& bundle : bundles) {
        const double count = static_cast<double>(bundle.size());
        double x_mean = 0.0, y_mean = 0.0;
        for (const SeriesPoint* point : bundle) {
            x_mean += std::log(*value_of(*point, asked.x)) / count;
            y_mean += std::log(*value_of(*point, asked.y)) / count;
        }
        for (const SeriesPoint* point : bundle) {
            const double x = std::log(*value_of(*point, asked.x)) - x_mean;
            both += x * (std::log(*value_of(*point, asked.y)) - y_mean);
            square += x * x;
        }
    }
    return both / square;
}

double share_of_steps(const TrendAsked& asked, std::vector<Bundle>& bundles) {
    int steps = 0, with = 0;
    for (Bundle& bundle : bundles) {
        std::ranges::stable_sort(bundle, {}, [&](const SeriesPoint* p) { return *value_of(*p, asked.x); });
        for (std::size_t i = 1; i < bundle.size(); ++i) {
            const double change = *value_of(*bundle[i], asked.y) - *value_of(*bundle[i - 1], asked.y);
            ++steps;
            with += asked.kind == TrendAsked::Kind::rises ? change > 0.0 : change < 0.0;
        }
    }
    return static_cast<double>(with) / steps;
}

}  // namespace

std::string_view trend_name(TrendAsked::Kind kind) {
    switch (kind) {
        case TrendAsked::Kind::rises:
            return "rises";
        case TrendAsked::Kind::falls:
            return "falls";
        case TrendAsked::Kind::exponent:
            return "exponent";
        case TrendAsked::Kind::spread:
            break;
    }
    return "spread";
}

std::string trend_words(const TrendAsked& asked) {
    std::string words =
        asked.kind == TrendAsked::Kind::spread ? fmt::format("spread of {}", asked.y)
        : asked.kind == TrendAsked::Kind::exponent
            ? fmt::format("exponent of {} in {}", asked.y, asked.x)
            : fmt::format("share of steps in which {} {} with {}", asked.y, trend_name(asked.kind), asked.x);
    if (!asked.within.empty()) words += fmt::format(", at equal {}", asked.within);
    if (asked.cases.size() > 2)
        words += fmt::format(", of {} cases", asked.cases.size());
    else if (!asked.cases.empty())
        words += fmt::format(", of {}", fmt::join(asked.cases, " and "));
    return words;
}

std::optional<double> trend_of(const TrendAsked& asked, std::span<const SeriesPoint> points) {
    const bool has_x = asked.kind != TrendAsked::Kind::spread;
    const bool by_metric = !asked.within.empty() && asked.within != "group";
    Bundle wanted;
    for (const SeriesPoint& point : points) {
        const bool named =
            asked.cases.empty() || std::ranges::find(asked.cases, point.name) != asked.cases.end();
        if (!named) continue;
        if (!value_of(point, asked.y) || (has_x && !value_of(point, asked.x)) ||
            (by_metric && !value_of(point, asked.within)))
            return {};
        wanted.push_back(&point);
    }
    if (!asked.cases.empty() && wanted.size() != asked.cases.size()) return {};
    std::vector<Bundle> bundles = bundles_of(asked.within, wanted);
    if (bundles.empty()) return {};
    if (asked.kind == TrendAsked::Kind::spread) return spread_of(asked, bundles);
    if (asked.kind != TrendAsked::Kind::exponent) return share_of_steps(asked, bundles);
    const double slope = exponent_of(asked, bundles);  // no number where one of them has no logarithm
    return std::isfinite(slope) ? std::optional(slope) : std::nullopt;
}

}  // namespace twinchute::compare
