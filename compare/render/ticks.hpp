// Round numbers along an axis, and curves with no more points than can be seen.
#pragma once

#include <cstddef>
#include <vector>

namespace twinchute::compare {

struct Ticks {
    std::vector<double> values;
    int decimals = 0;  ///< that tell neighbours apart
};

/// Multiples of 1, 2 or 5 times a power of ten that enclose [low, high], about `wanted` of them.
Ticks nice_ticks(double low, double high, int wanted);

struct Point {
    double x = 0.0, y = 0.0;
};

/// At most four points for each of `buckets` equal parts of the range of x: first, lowest, highest
/// and last, so that no extreme is lost. `points` are finite and ordered by x.
std::vector<Point> thinned(const std::vector<Point>& points, std::size_t buckets);

}  // namespace twinchute::compare
