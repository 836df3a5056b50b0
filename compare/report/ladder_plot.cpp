// A refinement study as a picture: filled markers are numerical errors, hollow ones gaps to other physics.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include "compare/render/plot.hpp"
#include "compare/report/ladder_files.hpp"
#include "lib/cli/record_text.hpp"

namespace twinchute::compare {
namespace {

struct Look {
    std::string_view family;
    const char* colour;
    MarkerShape shape;
    bool joined;
};
constexpr std::array looks{Look{"closed form", ink, MarkerShape::square, false},
                           Look{"rom", vermillion, MarkerShape::circle, true},
                           Look{"rom, other methods", orange, MarkerShape::triangle, false},
                           Look{"rom, without an effect", purple, MarkerShape::square, false},
                           Look{"full", blue, MarkerShape::circle, true},
                           Look{"full, time step", green, MarkerShape::triangle, false},
                           Look{"full, without an effect", sky, MarkerShape::square, false}};

/// The first fidelity that a closed form can be held against; an input that is handed through has no gap and
/// says nothing.
const std::pair<std::string_view, Worst>* drawn_gap(const LevelResult& result) {
    const auto found =
        std::ranges::find_if(result.gaps, [](const auto& gap) { return gap.second.value > 0.0; });
    return found == result.gaps.end() ? nullptr : &*found;
}

/// A level as it is drawn, or why it is not.
struct LevelPoint {
    double y = 0.0;
    std::string what = {};
    bool filled = true, is_reference = false;
    std::string_view why_not = {};
};

LevelPoint point_of(const LevelResult& result) {
    if (!result.was_run) return {.why_not = "not run"};
    if (!result.ended()) return {.why_not = status_name(result.status.code)};
    const auto at = [&](const Worst& worst, std::string_view what) {
        return LevelPoint{worst.value, fmt::format("{}: {} {:.2g} ({}), {}", result.level.name, what,
                                                   worst.value, worst.metric, time_text(result.wall_s))};
    };
    LevelPoint point;
    if (result.level.physics == Physics::other) {
        if (result.effect)
            point = at(*result.effect, "differs from the scene as it is by");
        else if (const auto* gap = drawn_gap(result))
            point = at(gap->second, fmt::format("gap to {}", gap->first));
        else
            point.why_not = "no gap to show";
        point.filled = false;
    } else if (result.error) {
        point = at(*result.error, "error");
    } else if (result.estimate) {
        point = at(*result.estimate, "reference, at its own estimate,");
        point.is_reference = true;
    } else {
        point.why_not = "no error to show";
    }
    return point;
}

void add_point(PlotSeries& series, const LevelResult& result, const LevelPoint& point) {
    series.x.push_back(result.wall_s);
    series.y.push_back(point.y);
    // A cloud of two dozen: only those that matter have words, all have a title.
    const bool named = result.level.family != "rom, other methods" || result.on_front;
    series.notes.push_back({point.what, named ? result.level.label : "",
                            result.level.given ? 0
                            : result.on_front  ? 1
                                               : 2});
}

}  // namespace

std::vector<std::string_view> drawn_families() {
    std::vector<std::string_view> families;
    for (const Look& look : looks)
        families.push_back(look.family);
    return families;
}

std::string ladder_svg(const Ladder& ladder) {
    Plot plot{.title = "Error against run time",
              .subtitle = ladder.scene.name,
              .x = {.label = "run time [s]", .logarithmic = true, .margin = 0.1},
              .y = {.label = "largest relative error or gap [-]", .logarithmic = true, .margin = 0.1},
              .series = {},
              .notes = {"filled: numerical error, against", "the reference of the same physics",
                        "cross: that reference, at its own", "error estimate",
                        "hollow: gap to other physics,", "not an error of numbers", "", "judged by"},
              .width = 960,
              .height = 600,
              .beside = 260};
    for (const std::string_view metric : ladder.judged)
        if (plot.notes.size() < 14) plot.notes.push_back("  " + std::string(find_metric_row(metric)->title));
    int missing = 0;
    for (const Look& look : looks) {
        PlotSeries series{.label = std::string(look.family),
                          .colour = look.colour,
                          .line = look.joined ? 1.2 : 0.0,
                          .marker = look.shape};
        PlotSeries references{.colour = look.colour, .line = 0.0, .marker = MarkerShape::cross};
        for (const LevelResult& result : ladder.levels) {
            if (result.level.family != look.family) continue;
            const LevelPoint point = point_of(result);
            if (point.why_not.empty()) {
                if (!point.is_reference) series.filled = point.filled;
                add_point(point.is_reference ? references : series, result, point);
                continue;
            }
            if (missing++ == 0) plot.notes.insert(plot.notes.end(), {"", "not drawn"});
            plot.notes.push_back("- " + result.level.name);
            plot.notes.push_back(fmt::format("  ({})", point.why_not));
        }
        if (series.x.empty() && references.x.empty()) continue;
        plot.series.push_back(std::move(series));
        plot.series.push_back(std::move(references));
    }
    if (ladder.gap)
        plot.levels.push_back({fmt::format("gap between {} and {}: {:.2g} % ({})", ladder.fidelities[0],
                                           ladder.fidelities[1], 100 * ladder.gap->value, ladder.gap->metric),
                               dim, ladder.gap->value});
    return svg_plot(plot);
}

}  // namespace twinchute::compare
