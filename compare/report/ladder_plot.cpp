// The ladder as a picture: filled markers are numerical errors, hollow ones gaps to other physics.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "compare/report/cost_plot.hpp"
#include "compare/report/escape.hpp"
#include "compare/report/ladder_files.hpp"
#include "lib/cli/record_text.hpp"

namespace twinchute::compare {
namespace {

struct Look {
    std::string_view family, colour;
    Shape shape;
    bool joined;
};
// Okabe and Ito: apart for every kind of colour vision; fidelities as in the other plots.
constexpr std::array looks{Look{"closed form", "#222222", Shape::square, false},
                           Look{"rom", "#d55e00", Shape::circle, true},
                           Look{"rom, other methods", "#e69f00", Shape::triangle, false},
                           Look{"rom, without a piece", "#cc79a7", Shape::square, false},
                           Look{"full", "#0072b2", Shape::circle, true},
                           Look{"full, time step", "#009e73", Shape::triangle, false},
                           Look{"full, without a piece", "#56b4e9", Shape::square, false}};

const Look& look_of(std::string_view family) {
    const auto found = std::ranges::find(looks, family, &Look::family);
    assert(found != looks.end());
    return *found;
}

/// The first fidelity that a closed form can be held against; an input that is handed through has no gap and
/// says nothing.
const std::pair<std::string_view, Worst>* drawn_gap(const RungResult& result) {
    const auto found =
        std::ranges::find_if(result.gaps, [](const auto& gap) { return gap.second.value > 0.0; });
    return found == result.gaps.end() ? nullptr : &*found;
}

/// Nothing where there is nothing to draw; `why_not` says so.
std::optional<CostPoint> point_of(const RungResult& result, std::string& why_not) {
    CostPoint point;
    point.label = result.rung.label;
    point.x = result.wall_s;
    point.shape = look_of(result.rung.family).shape;
    point.rank = result.rung.given ? 0 : result.on_front ? 1 : 2;
    // A cloud of two dozen: only those that matter have words, all have a title.
    if (result.rung.family == "rom, other methods" && !result.on_front) point.label.clear();
    const auto at = [&](const Worst& worst, std::string_view what) {
        point.y = worst.value;
        point.title = fmt::format("{}: {} {:.2g} ({}), {}", result.rung.name, what, worst.value, worst.metric,
                                  time_text(result.wall_s));
    };
    if (!result.was_run) {
        why_not = "not run";
    } else if (!result.ended()) {
        why_not = status_name(result.status.code);
    } else if (result.rung.physics == Physics::other) {
        point.filled = false;
        if (result.effect) {
            at(*result.effect, "differs from the scene as it is by");
            return point;
        }
        if (const auto* gap = drawn_gap(result)) {
            at(gap->second, fmt::format("gap to {}", gap->first));
            return point;
        }
        why_not = "no gap to show";
    } else if (result.error) {
        at(*result.error, "error");
        return point;
    } else if (result.estimate) {
        point.shape = Shape::cross;
        at(*result.estimate, "reference, at its own estimate,");
        return point;
    } else {
        why_not = "no error to show";
    }
    return {};
}

}  // namespace

std::vector<std::string_view> drawn_families() {
    std::vector<std::string_view> families;
    for (const Look& look : looks)
        families.push_back(look.family);
    return families;
}

std::string ladder_svg(const Ladder& ladder) {
    CostPlot plot;
    plot.title = "Error against run time";
    plot.subtitle = clean_text(ladder.scene.name).substr(0, 90);
    plot.x_label = "run time [s]";
    plot.y_label = "largest relative error or gap [-]";
    plot.notes = {"filled: numerical error, against",  "the reference of the same physics",
                  "cross: that reference, at its own", "error estimate",
                  "hollow: gap to other physics,",     "not an error of numbers"};
    plot.notes.push_back("");
    plot.notes.push_back("judged by");
    for (const std::string_view metric : ladder.judged)
        if (plot.notes.size() < 14) plot.notes.push_back("  " + std::string(find_metric_row(metric)->title));
    int missing = 0;
    for (const Look& look : looks) {
        CostFamily drawn{
            std::string(look.family), std::string(look.colour), look.shape, true, look.joined, {}};
        for (const RungResult& result : ladder.rungs) {
            if (result.rung.family != look.family) continue;
            std::string why;
            if (auto point = point_of(result, why)) {
                drawn.filled = point->filled || point->shape == Shape::cross;
                point->joined = point->shape != Shape::cross;
                drawn.points.push_back(std::move(*point));
            } else {
                if (missing++ == 0) plot.notes.insert(plot.notes.end(), {"", "not drawn"});
                plot.notes.push_back("- " + result.rung.name);
                plot.notes.push_back(fmt::format("  ({})", why));
            }
        }
        if (!drawn.points.empty()) plot.families.push_back(std::move(drawn));
    }
    if (ladder.gap)
        plot.levels.push_back({fmt::format("gap between {} and {}: {:.2g} % ({})", ladder.fidelities[0],
                                           ladder.fidelities[1], 100 * ladder.gap->value, ladder.gap->metric),
                               ladder.gap->value});
    return cost_svg(plot);
}

}  // namespace twinchute::compare
