// A line chart as SVG: small, self-contained, fit for print.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace twinchute::compare {

/// Colour and dash of a side. Told apart by dash as well, for grey print and colour-blind eyes. What a test
/// measured is dots.
enum class Role { reference, candidate, test };

struct Series {
    std::string label;
    Role role = Role::reference;
    std::vector<double> x, y;  ///< of one length; a point that is not finite breaks the line
};

/// A vertical line with a word at its top.
struct PlotMarker {
    std::string label;
    Role role = Role::reference;
    double x = 0.0;
};

struct Plot {
    std::string title, subtitle;
    std::string x_label, y_label;  ///< with units, e.g. "time since release [s]"
    std::vector<Series> series;
    std::vector<PlotMarker> markers;
    std::optional<double> x_end;  ///< where the axis ends before the data do
};

/// The whole file. Without a single finite point it says so in place of the curves.
std::string svg_plot(const Plot& plot);

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
