#include "compare/validate/scatter_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "compare/report/svg_canvas.hpp"
#include "lib/cli/text.hpp"

namespace twinchute::compare {
namespace {

// [px] of a page; the frame is square, to its right stands the legend.
constexpr double width = 900, height = 600, left = 84, top = 66, side = 460;
constexpr std::string_view ink = "#222222", faint = "#e4e4e4", dim = "#555555", model = "#b3402a",
                           test = "#1f5f99";

/// One logarithmic axis for both sides.
struct LogSpan {
    double low = 1.0, high = 10.0;
    double share(double value) const { return std::log(value / low) / std::log(high / low); }
    double x(double value) const { return left + side * share(value); }
    double y(double value) const { return top + side * (1.0 - share(value)); }
};

bool is_drawable(const RowResult& row) {
    const auto good = [](const std::optional<double>& v) { return v && std::isfinite(*v) && *v > 0.0; };
    return good(row.expected) && good(row.predicted);
}

LogSpan span_of(const std::vector<const RowResult*>& rows) {
    LogSpan span{INFINITY, 0.0};
    for (const RowResult* row : rows)
        for (const double value : {*row->expected, *row->predicted})
            span.low = std::min(span.low, value), span.high = std::max(span.high, value);
    const double room = std::max(1.5, std::pow(span.high / span.low, 0.12));
    return {span.low / room, span.high * room};
}

void draw_axes(SvgCanvas& canvas, const LogSpan& span, const RowResult& row) {
    const double bottom = top + side, right = left + side;
    const bool dense = span.high / span.low < 100.0;
    for (int power = static_cast<int>(std::floor(std::log10(span.low))); std::pow(10.0, power) < span.high;
         ++power)
        for (const double digit : {1.0, 2.0, 5.0}) {
            const double value = digit * std::pow(10.0, power);
            if (value < span.low || value > span.high || (!dense && digit > 1.0)) continue;
            canvas.line(span.x(value), top, span.x(value), bottom, faint);
            canvas.line(left, span.y(value), right, span.y(value), faint);
            canvas.words(span.x(value), bottom + 20, "middle", ink, readable(value, 1));
            canvas.words(left - 8, span.y(value) + 4.5, "end", ink, readable(value, 1));
        }
    canvas.line(left, bottom, right, bottom, ink);
    canvas.line(left, top, left, bottom, ink);
    const std::string of = " " + row.quantity.substr(0, row.quantity.find(',')) +
                           (row.unit.empty() ? "" : " [" + row.unit + "]");
    canvas.words(0.5 * (left + right), height - 24, "middle", ink, "measured" + of);
    const double middle = top + 0.5 * side;
    canvas.words(24, middle, "middle", ink, "predicted" + of,
                 fmt::format(R"x( transform="rotate(-90 24 {:.1f})")x", middle));
}

/// predicted = ratio times measured, within the frame.
void draw_ratio(SvgCanvas& canvas, const LogSpan& span, double ratio, std::string_view colour,
                std::string_view more) {
    const double from = std::max(span.low, span.low / ratio), to = std::min(span.high, span.high / ratio);
    if (!(to > from) || !std::isfinite(ratio)) return;
    canvas.line(span.x(from), span.y(from * ratio), span.x(to), span.y(to * ratio), colour, more);
}

/// FDS's lines: about equality two standard uncertainties of the experiment, about the bias two of the model.
void draw_agreement(SvgCanvas& canvas, const LogSpan& span, const Agreement& a) {
    constexpr std::string_view dashed = R"( stroke-width="1.2" stroke-dasharray="6 4")";
    for (const double sign : {-2.0, 2.0}) {
        draw_ratio(canvas, span, std::exp(sign * a.sigma_experiment), test, dashed);
        draw_ratio(canvas, span, a.bias * std::exp(sign * a.sigma_model), model, dashed);
    }
    draw_ratio(canvas, span, a.bias, model, R"( stroke-width="1.6")");
}

void draw_points(SvgCanvas& canvas, const LogSpan& span, const std::vector<const RowResult*>& rows) {
    double legend = top + 150;
    int number = 0;
    for (const RowResult* row : rows) {
        const double x = span.x(*row->expected), y = span.y(*row->predicted);
        const auto inside = [&](double value) { return std::clamp(value, span.low, span.high); };
        if (const double sigma = row->sigma_measured.value_or(0.0); sigma > 0.0 && std::isfinite(sigma))
            canvas.line(span.x(inside(*row->expected - sigma)), y, span.x(inside(*row->expected + sigma)), y,
                        dim);
        // Uncertain inputs, or both ends of a bracket.
        const double sigma = row->sigma_inputs.value_or(0.0);
        const double low = row->low.value_or(*row->predicted - sigma),
                     high = row->high.value_or(*row->predicted + sigma);
        if (low < high && std::isfinite(high - low))
            canvas.line(x, span.y(inside(low)), x, span.y(inside(high)), dim);
        canvas.add(
            R"(<circle cx="{:.1f}" cy="{:.1f}" r="5" fill="{}" stroke="{}" stroke-width="1.6"><title>{}</title></circle>)",
            x, y, row->verdict == RowVerdict::not_judged ? "#ffffff" : ink, ink,
            xml_text(fmt::format("{}: measured {}, predicted {}", row->name, readable(*row->expected),
                                 readable(*row->predicted))));
        ++number;
        canvas.words(x + 8, y - 6, "start", ink, fmt::format("{}", number), R"( font-size="11")");
        canvas.words(left + side + 28, legend, "start", ink, fmt::format("{}  {}", number, row->name),
                     R"( font-size="11.5")");
        legend += 17;
    }
}

void draw_legend(SvgCanvas& canvas, const GroupResult& group) {
    const double x = left + side + 28;
    double y = top + 12;
    const auto line = [&](std::string_view colour, std::string_view more, const std::string& words) {
        canvas.line(x, y - 4, x + 26, y - 4, colour, more);
        canvas.words(x + 34, y, "start", ink, words, R"( font-size="12")");
        y += 21;
    };
    line(dim, "", "predicted = measured");
    if (group.agreement) {
        const Agreement& a = *group.agreement;
        line(test, R"( stroke-dasharray="6 4")",
             fmt::format("two sigma of the experiment ({:.2f})", a.sigma_experiment));
        line(model, "", fmt::format("bias {:.2f}", a.bias));
        line(model, R"( stroke-dasharray="6 4")",
             fmt::format("two sigma of the model ({:.2f})", a.sigma_model));
    }
    canvas.words(x, y, "start", dim, "open circles: not judged; bars: one sigma, or a bracket",
                 R"( font-size="11.5")");
}

}  // namespace

std::string scatter_svg(const SuiteResult& suite, const GroupResult& group) {
    std::vector<const RowResult*> rows;
    std::ranges::copy_if(group.rows, std::back_inserter(rows),
                         [](const RowResult* row) { return is_drawable(*row); });
    SvgCanvas canvas;
    canvas.words(left, 26, "start", ink, group.name, R"( font-size="16" font-weight="bold")");
    canvas.words(left, 46, "start", dim, suite.title, R"( font-size="12")");
    if (rows.empty()) {
        canvas.words(left + 0.5 * side, top + 0.5 * side, "middle", dim, "no data");
    } else {
        const LogSpan span = span_of(rows);
        draw_axes(canvas, span, *rows.front());
        draw_ratio(canvas, span, 1.0, dim, R"( stroke-width="1.4")");
        if (group.agreement) draw_agreement(canvas, span, *group.agreement);
        draw_points(canvas, span, rows);
        draw_legend(canvas, group);
    }
    const double page = std::max(height, top + 150 + 17.0 * static_cast<double>(rows.size() + 1));
    return canvas.sheet(width, page, suite.title + ": " + group.name);
}

}  // namespace twinchute::compare
