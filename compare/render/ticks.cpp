#include "compare/render/ticks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

namespace twinchute::compare {

Ticks nice_ticks(double low, double high, int wanted) {
    // A constant still gets an axis; so does what differs by round-off only, whose ticks would be the same
    // number over and over.
    const double size = std::max(std::abs(low), std::abs(high));
    if (!(high - low > std::max(1e-9 * size, 1e-100))) {
        const double margin = size < 1e-100 ? 1 : 0.1 * size;
        low -= margin;
        high += margin;
    }
    const double rough = (high - low) / std::max(1, wanted);
    const int power = static_cast<int>(std::floor(std::log10(rough)));
    const double unit = std::pow(10.0, power);
    const double ratio = rough / unit;
    const double factor = ratio <= 1.0 ? 1 : ratio <= 2.0 ? 2 : ratio <= 5.0 ? 5 : 10;
    const double step = factor * unit;
    Ticks ticks;
    ticks.decimals = std::clamp(factor == 10 ? -power - 1 : -power, 0, 12);
    const double first = std::floor(low / step + 1e-9), last = std::ceil(high / step - 1e-9);
    for (double i = first; i <= last; ++i)
        ticks.values.push_back(i * step);
    return ticks;
}

std::vector<Point> thinned(const std::vector<Point>& points, std::size_t buckets) {
    if (buckets == 0 || points.size() <= 4 * buckets) return points;
    const double low = points.front().x, span = points.back().x - low;
    const auto bucket_of = [&](const Point& point) {
        const double share = span > 0 ? std::clamp((point.x - low) / span, 0.0, 1.0) : 0;
        return std::min(buckets - 1, static_cast<std::size_t>(share * static_cast<double>(buckets)));
    };
    std::vector<Point> kept;
    for (auto begin = points.begin(); begin != points.end();) {
        const std::size_t bucket = bucket_of(*begin);
        const auto end =
            std::find_if(begin, points.end(), [&](const Point& p) { return bucket_of(p) != bucket; });
        const auto [lowest, highest] =
            std::minmax_element(begin, end, [](const Point& a, const Point& b) { return a.y < b.y; });
        std::array chosen{begin, lowest, highest, std::prev(end)};
        std::ranges::sort(chosen);
        for (std::size_t i = 0; i < chosen.size(); ++i) {
            if (i == 0 || chosen[i] != chosen[i - 1]) kept.push_back(*chosen[i]);
        }
        begin = end;
    }
    return kept;
}

}  // namespace twinchute::compare
