// A plot as a model, and its writer to SVG: small, self-contained, fit for print.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace twinchute::compare {

// Okabe and Ito: apart for every kind of colour vision and in grey.
inline constexpr const char *blue = "#0072b2", *vermillion = "#d55e00", *green = "#009e73",
                            *purple = "#cc79a7", *orange = "#e69f00", *sky = "#56b4e9", *ink = "#222222",
                            *dim = "#555555";

enum class MarkerShape { none, dot, circle, square, triangle, diamond, cross };

/// Words of one point.
struct PointNote {
    std::string title;       ///< for whoever points at it
    std::string label = {};  ///< drawn where there is room
    int rank = 2;            ///< labels of rank 0 find their place first, those of rank 2 last
};

struct PlotSeries {
    std::string label = {};  ///< in the legend, also without points; empty: not there
    std::string colour = ink;
    std::vector<double> x = {}, y = {};  ///< of one length; a point that is not finite breaks the line
    double line = 2.2;                   ///< width [px]; 0: no line
    std::string dash = {};               ///< e.g. "8 4"; empty: solid
    MarkerShape marker = MarkerShape::none;
    bool filled = true;
    std::vector<PointNote> notes = {};  ///< one a point, or none
};

/// A line across the whole plot with a word at its end.
struct GuideLine {
    std::string label, colour;
    double at = 0.0;
};

struct Axis {
    std::string label;         ///< with unit, e.g. "time since release [s]"
    bool logarithmic = false;  ///< zero is drawn at the lower end
    bool from_zero = false;    ///< where size is the message
    double margin = 0.0;       ///< beyond the outermost points: share of their range, or decades
    /// The axis ends before the data do. Along x what lies beyond is left out, along y its lines run on the
    /// edge.
    std::optional<double> end{};
};

struct Plot {
    std::string title, subtitle;
    Axis x, y;
    std::vector<PlotSeries> series;
    std::vector<GuideLine> markers = {};   ///< at places along x
    std::vector<GuideLine> levels = {};    ///< at places along y
    std::vector<std::string> notes = {};   ///< below the legend, a line each
    double width = 720.0, height = 440.0;  ///< [px]; more height where legend and notes are longer
    double beside = 0.0;                   ///< [px] for the legend to the right; 0: it stands above
    std::string nothing = "no data";       ///< in place of the curves
};

/// The whole file.
std::string svg_plot(const Plot& plot);

}  // namespace twinchute::compare
