#include "compare/validate/scatter_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "compare/render/plot.hpp"
#include "lib/cli/text.hpp"

namespace twinchute::compare {
namespace {

constexpr const char *model = "#b3402a", *test = "#1f5f99", *dashed = "6 4";

struct Span {
    double low, high;
    double inside(double value) const { return std::clamp(value, low, high); }
};

bool is_drawable(const RowResult& row) {
    const auto good = [](const std::optional<double>& v) { return v && std::isfinite(*v) && *v > 0.0; };
    return good(row.expected) && good(row.predicted);
}

/// Range of both axes, with room beyond the outermost points.
Span span_of(const std::vector<const RowResult*>& rows) {
    Span span{INFINITY, 0.0};
    for (const RowResult* row : rows)
        for (const double value : {*row->expected, *row->predicted})
            span = {std::min(span.low, value), std::max(span.high, value)};
    const double room = std::max(1.5, std::pow(span.high / span.low, 0.12));
    return {span.low / room, span.high * room};
}

/// A segment behind those that are there, with a gap between them.
void add_segment(PlotSeries& series, double x1, double y1, double x2, double y2) {
    series.x.insert(series.x.end(), {x1, x2, NAN});
    series.y.insert(series.y.end(), {y1, y2, NAN});
}

/// predicted = ratio times measured, within the frame.
void add_ratio(PlotSeries& series, const Span& span, double ratio) {
    const double from = std::max(span.low, span.low / ratio), to = std::min(span.high, span.high / ratio);
    if (to > from && std::isfinite(ratio)) add_segment(series, from, from * ratio, to, to * ratio);
}

/// Lines of the FDS Validation Guide: about equality two standard uncertainties of the experiment, about the
/// bias two of the model.
void add_agreement(Plot& plot, const Span& span, const Agreement& a) {
    PlotSeries experiment{.label = fmt::format("two sigma of the experiment ({:.2f})", a.sigma_experiment),
                          .colour = test,
                          .line = 1.2,
                          .dash = dashed};
    PlotSeries bias{.label = fmt::format("bias {:.2f}", a.bias), .colour = model, .line = 1.6};
    PlotSeries scatter{.label = fmt::format("two sigma of the model ({:.2f})", a.sigma_model),
                       .colour = model,
                       .line = 1.2,
                       .dash = dashed};
    add_ratio(bias, span, a.bias);
    for (const double sign : {-2.0, 2.0}) {
        add_ratio(experiment, span, std::exp(sign * a.sigma_experiment));
        add_ratio(scatter, span, a.bias * std::exp(sign * a.sigma_model));
    }
    plot.series.insert(plot.series.end(), {std::move(experiment), std::move(bias), std::move(scatter)});
}

/// One sigma of each side; for a bracketed input both its ends.
void add_bars(PlotSeries& bars, const Span& span, const RowResult& row) {
    const double x = *row.expected, y = *row.predicted;
    if (const double sigma = row.sigma_measured.value_or(0.0); sigma > 0.0 && std::isfinite(sigma))
        add_segment(bars, span.inside(x - sigma), y, span.inside(x + sigma), y);
    const double sigma = row.sigma_inputs.value_or(0.0);
    const double low = row.low.value_or(y - sigma), high = row.high.value_or(y + sigma);
    if (low < high && std::isfinite(high - low)) add_segment(bars, x, span.inside(low), x, span.inside(high));
}

void add_points(Plot& plot, const Span& span, const std::vector<const RowResult*>& rows) {
    PlotSeries bars{.colour = dim, .line = 1.0};
    PlotSeries judged{.line = 0.0, .marker = MarkerShape::circle}, not_judged = judged;
    not_judged.filled = false;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const RowResult& row = *rows[i];
        add_bars(bars, span, row);
        PlotSeries& points = row.verdict == RowVerdict::not_judged ? not_judged : judged;
        points.x.push_back(*row.expected);
        points.y.push_back(*row.predicted);
        points.notes.push_back({fmt::format("{}: measured {}, predicted {}", row.name,
                                            readable(*row.expected), readable(*row.predicted)),
                                fmt::format("{}", i + 1)});
        plot.notes.push_back(fmt::format("{}  {}", i + 1, row.name));
    }
    plot.series.insert(plot.series.end(), {std::move(bars), std::move(judged), std::move(not_judged)});
}

}  // namespace

std::string scatter_svg(const SuiteResult& suite, const GroupResult& group) {
    std::vector<const RowResult*> rows;
    std::ranges::copy_if(group.rows, std::back_inserter(rows),
                         [](const RowResult* row) { return is_drawable(*row); });
    Plot plot{.title = group.name,
              .subtitle = suite.title,
              .x = {.label = "", .logarithmic = true},
              .y = {.label = "", .logarithmic = true},
              .series = {},
              .width = 900,
              .height = 584,
              .beside = 362};
    if (!rows.empty()) {
        const RowResult& first = *rows.front();
        const std::string of = " " + first.quantity.substr(0, first.quantity.find(',')) +
                               (first.unit.empty() ? "" : " [" + first.unit + "]");
        plot.x.label = "measured" + of;
        plot.y.label = "predicted" + of;
        plot.notes = {"open circles: not judged; bars: one sigma, or a bracket", ""};
        const Span span = span_of(rows);
        PlotSeries equal{.label = "predicted = measured", .colour = dim, .line = 1.4};
        add_ratio(equal, span, 1.0);
        plot.series.push_back(std::move(equal));
        if (group.agreement) add_agreement(plot, span, *group.agreement);
        add_points(plot, span, rows);
    }
    return svg_plot(plot);
}

}  // namespace twinchute::compare
