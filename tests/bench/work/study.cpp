#include "tests/bench/work/study.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <stdexcept>

#include "compare/report/cost_plot.hpp"
#include "lib/record/record_csv.hpp"
#include "lib/record/run_record.hpp"

namespace twinchute::bench {
namespace {

using compare::Shape;

struct Look {
    std::string_view family, colour;
    Shape shape;
};
constexpr std::array looks{Look{"explicit Runge-Kutta (ARKODE)", "#0072b2", Shape::circle},
                           Look{"implicit Runge-Kutta (ARKODE)", "#d55e00", Shape::square},
                           Look{"multistep (CVODE)", "#009e73", Shape::triangle},
                           Look{"GSL and Boost.odeint", "#cc79a7", Shape::diamond},
                           Look{"explicit midpoint, this toolkit", "#222222", Shape::square},
                           Look{"ARKODE, adaptive", "#0072b2", Shape::circle},
                           Look{"ARKODE, even steps", "#e69f00", Shape::triangle},
                           Look{"all gores", "#d55e00", Shape::diamond},
                           Look{"one sector", "#009e73", Shape::triangle},
                           Look{"springs, then elements", "#0072b2", Shape::circle},
                           Look{"elements from the pack on", "#d55e00", Shape::square}};

/// A line a method, all of a family in its colour; each ends with the method's name.
compare::CostFamily drawn(const Study& study, const View& view, const Look& look) {
    compare::CostFamily family;
    family.name = look.family;
    family.colour = look.colour;
    family.shape = look.shape;
    family.joined = true;
    for (const Curve& curve : study.curves) {
        if (curve.family != look.family) continue;
        for (const Sample& sample : curve.samples) {
            const bool first = &sample == &curve.samples.front(), last = &sample == &curve.samples.back();
            compare::CostPoint point;
            if (last) point.label = curve.method;
            point.x = view.x(sample);
            point.y = view.y(sample);
            point.title = fmt::format("{} at {}: error {:.2g} after {} evaluations", curve.method,
                                      sample.setting, point.y, sample.evaluations);
            point.rank = last ? 0 : 2;
            point.shape = look.shape;
            point.joined = !first;
            family.points.push_back(std::move(point));
        }
    }
    return family;
}

std::string picture(const Study& study, const View& view) {
    compare::CostPlot plot;
    plot.title = study.title;
    plot.subtitle = study.subtitle;
    plot.x_label = view.x_label;
    plot.y_label = view.y_label;
    for (const Look& look : looks)
        if (std::ranges::any_of(study.curves, [&](const Curve& c) { return c.family == look.family; }))
            plot.families.push_back(drawn(study, view, look));
    for (const Level& level : view.levels)
        plot.levels.push_back({level.label, level.error});
    return compare::cost_svg(plot);
}

View error_against_evaluations(const Study& study) {
    return {"", "evaluations of the right-hand side [-]",
            fmt::format("relative error of {} [-]", study.error),
            [](const Sample& s) { return static_cast<double>(s.evaluations); },
            [](const Sample& s) { return s.error; }};
}

std::string table(const Study& study) {
    const Provenance made = current_provenance();
    std::string text = fmt::format(
        "# {}; commit {}, {}\nmethod,family,setting,evaluations,seconds,error,other_error{}{}\n", study.title,
        made.commit, made.compiler, study.more.empty() ? "" : ",", fmt::join(study.more, ","));
    for (const Curve& curve : study.curves)
        for (const Sample& s : curve.samples) {
            text +=
                fmt::format("{},{},{},{},{:.3g},{:.3g},{}", csv_field(curve.method), csv_field(curve.family),
                            csv_field(s.setting), s.evaluations, s.seconds, s.error,
                            std::isnan(s.other_error) ? "" : fmt::format("{:.3g}", s.other_error));
            for (const double value : s.more)
                text += fmt::format(",{:.6g}", value);
            text += '\n';
        }
    return text;
}

void save(const std::filesystem::path& path, const std::string& text) {
    std::ofstream file(path);
    file << text;
    if (!file.flush()) throw std::runtime_error(fmt::format("cannot write {}", path.string()));
}

}  // namespace

void write(const Study& study, const std::filesystem::path& directory) {
    for (const Curve& curve : study.curves)
        if (std::ranges::find(looks, curve.family, &Look::family) == looks.end())
            throw std::invalid_argument(fmt::format("{}: no colour for '{}'", study.name, curve.family));
    std::filesystem::create_directories(directory);
    save(directory / fmt::format("work-{}.csv", study.name), table(study));
    for (const View& view : study.views.empty() ? std::vector{error_against_evaluations(study)} : study.views)
        save(directory / fmt::format("work-{}{}.svg", study.name, view.suffix), picture(study, view));
}

}  // namespace twinchute::bench
