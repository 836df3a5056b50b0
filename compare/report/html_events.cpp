// Events along time: a line for each side, the same event joined, and all of it as a table.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "compare/render/escape.hpp"
#include "compare/render/ticks.hpp"
#include "compare/report/gap_tables.hpp"
#include "compare/report/html_parts.hpp"
#include "lib/cli/text.hpp"

namespace twinchute::compare {
namespace {

constexpr double timeline_width = 960, left = 70, opening_right = 750, right = 830;  // [px]
constexpr double row_height = 18, letter = 6.7;                                      // [px] of a label
constexpr std::size_t longest_label = 28, most_labels = 24;

/// As much of a name as there is room for.
std::string words_of(std::string_view name, double room) {
    const auto longest = std::min(longest_label, static_cast<std::size_t>(std::max(0.0, room / letter)));
    std::string text = clean_text(name);
    std::ranges::replace(text, '-', ' ');
    if (columns_of(text) <= longest) return text;
    std::size_t end = 0;
    for (std::size_t letters = 0; end < text.size(); ++end)
        if ((static_cast<unsigned char>(text[end]) & 0xC0) != 0x80 && letters++ == longest) break;
    return text.substr(0, end) + "\u2026";
}

/// Linear over the opening; what comes after it stands to the right of a gap.
struct TimeAxis {
    double first, opening, last;

    double at(double t) const {
        if (t <= opening || !(last > opening))
            return opening > first ? left + (t - first) / (opening - first) * (opening_right - left) : left;
        return opening_right + 30 + (t - opening) / (last - opening) * (right - opening_right - 30);
    }
};

TimeAxis axis_of(const std::vector<EventPair>& all, const SharedClock& clock) {
    TimeAxis axis{0.0, 0.0, 0.0};
    for (const EventPair& pair : all) {
        for (std::size_t s = 0; s < pair.event.size(); ++s) {
            if (pair.event[s] == nullptr || !std::isfinite(pair.event[s]->time)) continue;
            const double t = pair.event[s]->time - clock.zero[s];
            axis.first = std::min(axis.first, t);
            axis.last = std::max(axis.last, t);
            if (pair.name == "full-open" || pair.name == "canopy-filled" || pair.name == "peak-force")
                axis.opening = std::max(axis.opening, 1.1 * t);
        }
    }
    if (axis.opening <= axis.first) axis.opening = axis.last;
    return axis;
}

struct Label {
    std::string text;
    double x;
    int level = 0;

    double end() const { return x + 10 + letter * static_cast<double>(columns_of(text)); }
};

/// Words to the right of their own line, and so high that no line of a later event runs through them.
int stack_labels(std::vector<Label>& labels) {
    int most = 0;
    for (std::size_t i = labels.size(); i-- > 0;) {
        for (std::size_t j = i + 1; j < labels.size(); ++j)
            if (labels[j].x < labels[i].end())
                labels[i].level = std::max(labels[i].level, labels[j].level + 1);
        most = std::max(most, labels[i].level);
    }
    return most;
}

void draw_axis(std::string& svg, const TimeAxis& axis, const SharedClock& clock, double y) {
    const Ticks ticks = nice_ticks(axis.first, axis.opening, 8);
    for (const double tick : ticks.values) {
        if (tick < axis.first - 1e-9 || tick > axis.opening + 1e-9) continue;
        svg +=
            fmt::format("<line class=\"tick\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.1f}\" y2=\"{2:.1f}\"/>",
                        axis.at(tick), y, y + 5);
        svg += fmt::format(
            "<text class=\"small\" text-anchor=\"middle\" x=\"{:.1f}\" y=\"{:.1f}\">{:.{}f}</text>\n",
            axis.at(tick), y + 18, tick, ticks.decimals);
    }
    svg += fmt::format("<text class=\"small\" text-anchor=\"middle\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n",
                       0.5 * (left + opening_right), y + 36, clock.label());
    if (axis.last > axis.opening)
        svg += fmt::format(
            "<text class=\"small\" text-anchor=\"middle\" x=\"{:.1f}\" y=\"{:.1f}\">later</text>\n",
            0.5 * (opening_right + 30 + right), y + 18);
}

std::string drawing(const std::vector<EventPair>& all, const PageSides& sides, const SharedClock& clock) {
    const TimeAxis axis = axis_of(all, clock);
    std::vector<Label> labels;
    for (const EventPair& pair : all)
        if (std::isfinite(pair.first) && labels.size() < most_labels)
            labels.push_back(
                {words_of(pair.name, timeline_width - axis.at(pair.first) - 10), axis.at(pair.first)});
    const double top = row_height * (stack_labels(labels) + 1) + 12;
    const std::array<double, 2> lane{top + 14, top + 52};
    const double axis_y = lane[sides.size() - 1] + 24, height = axis_y + 44;
    std::string svg = fmt::format(
        "<svg class=\"timeline\" viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"Events along "
        "time; the table below has the numbers\">\n",
        timeline_width, height);
    for (const Label& label : labels) {
        const double y = top - row_height * label.level - 6;
        svg += fmt::format(
            "<line class=\"leader\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.1f}\" y2=\"{2:.1f}\"/>", label.x,
            y - 9, lane[0]);
        svg +=
            fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", label.x + 5, y, xml_text(label.text));
    }
    for (std::size_t s = 0; s < sides.size(); ++s) {
        svg += fmt::format("<line class=\"lane\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>",
                           left, axis.last > axis.opening ? right : opening_right, lane[s], lane[s]);
        svg += fmt::format("<text class=\"{}\" text-anchor=\"end\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n",
                           sides[s].style, left - 14, lane[s] + 4,
                           xml_text(words_of(sides[s].record->fidelity, left - 20)));
    }
    for (const EventPair& pair : all) {
        std::array<double, 2> x{};
        for (std::size_t s = 0; s < sides.size(); ++s)
            if (pair.event[s] && std::isfinite(pair.event[s]->time))
                x[s] = axis.at(pair.event[s]->time - clock.zero[s]);
        if (x[0] > 0 && x[1] > 0)
            svg +=
                fmt::format("<line class=\"join\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>",
                            x[0], x[1], lane[0], lane[1]);
        else if (x[1] > 0)
            svg += fmt::format(
                "<line class=\"leader\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.1f}\" y2=\"{2:.1f}\"/>", x[1],
                lane[0], lane[1]);
        for (std::size_t s = 0; s < sides.size(); ++s)
            if (x[s] > 0)
                svg += fmt::format("<circle class=\"dot {}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4.5\"/>\n",
                                   sides[s].style, x[s], lane[s]);
    }
    draw_axis(svg, axis, clock, axis_y);
    return svg + "</svg>\n";
}

}  // namespace

std::string events_section_html(const PageSides& sides) {
    const SharedClock clock = shared_clock(sides);
    const std::vector<EventPair> all = event_pairs(sides);
    if (all.empty()) return {};
    return "<section id=\"events\"><h2>Events</h2>\n<div class=\"scroll\" tabindex=\"0\" role=\"region\" "
           "aria-label=\"Events along time\">\n" +
           drawing(all, sides, clock) + "</div>\n" +
           html_table(events_table(sides),
                      fmt::format("Times since release{}. Altitude and speed are the payload's.",
                                  sides.size() > 1 ? "; the difference is that of the drawing's clock" : ""),
                      "events", "events") +
           "</section>\n";
}

}  // namespace twinchute::compare
