// Error against run time, both logarithmic, as SVG: small, self-contained, fit for print.
#pragma once

#include <string>
#include <vector>

namespace twinchute::compare {

enum class Shape { circle, square, triangle, diamond, cross };

struct CostPoint {
    std::string label;  ///< drawn where there is room
    std::string title;  ///< always there, for whoever points at it
    double x = 0.0;     ///< positive
    double y = 0.0;     ///< zero, which no logarithm shows, is drawn on the lower edge
    int rank = 2;       ///< labels of rank 0 find their place first, those of rank 2 last
    Shape shape = Shape::circle;
    bool filled = true;
    bool joined = true;  ///< to the point before it, where its family is joined
};

struct CostFamily {
    std::string name;
    std::string colour;
    Shape shape = Shape::circle;  ///< in the legend
    bool filled = true;
    bool joined = false;  ///< by a line, in the order of its points
    std::vector<CostPoint> points;
};

/// A level across the whole plot, e.g. the gap between two models.
struct CostLevel {
    std::string label;
    double y = 0.0;
};

struct CostPlot {
    std::string title, subtitle;
    std::string x_label, y_label;  ///< with units
    std::vector<CostFamily> families;
    std::vector<CostLevel> levels;
    std::vector<std::string> notes;  ///< below the legend, a line each
};

/// The whole file. Points that are not finite, or whose time is not positive, are not drawn; where none is
/// left it says so.
std::string cost_svg(const CostPlot& plot);

}  // namespace twinchute::compare
