#include "tests/bench/work/study.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <stdexcept>
#include <utility>

#include "compare/render/plot.hpp"
#include "lib/record/record_csv.hpp"
#include "lib/record/run_record.hpp"

namespace twinchute::bench {
namespace {

using compare::MarkerShape;

struct Look {
    std::string_view family;
    const char* colour;
    MarkerShape shape;
};
constexpr std::array looks{Look{"explicit Runge-Kutta (ARKODE)", compare::blue, MarkerShape::circle},
                           Look{"implicit Runge-Kutta (ARKODE)", compare::vermillion, MarkerShape::square},
                           Look{"multistep (CVODE)", compare::green, MarkerShape::triangle},
                           Look{"GSL and Boost.odeint", compare::purple, MarkerShape::diamond},
                           Look{own_rule, compare::ink, MarkerShape::square},
                           Look{adaptive_steps, compare::blue, MarkerShape::circle},
                           Look{even_steps, compare::orange, MarkerShape::triangle},
                           Look{"all gores", compare::vermillion, MarkerShape::diamond},
                           Look{"one sector", compare::green, MarkerShape::triangle},
                           Look{"springs, then elements", compare::blue, MarkerShape::circle},
                           Look{"elements from the pack on", compare::vermillion, MarkerShape::square}};

/// A line a method, which ends with the method's name; all of a family look the same.
compare::PlotSeries drawn(const Curve& curve, const View& view, const Look& look) {
    compare::PlotSeries series{.colour = look.colour, .line = 1.2, .marker = look.shape};
    for (const Sample& sample : curve.samples) {
        const bool last = &sample == &curve.samples.back();
        series.x.push_back(view.x(sample));
        series.y.push_back(view.y(sample));
        series.notes.push_back({fmt::format("{} at {}: error {:.2g} after {} evaluations", curve.method,
                                            sample.setting, series.y.back(), sample.evaluations),
                                last ? curve.method : "", last ? 0 : 2});
    }
    return series;
}

std::string picture(const Study& study, const View& view) {
    compare::Plot plot{.title = study.title,
                       .subtitle = study.subtitle,
                       .x = {.label = view.x_label, .logarithmic = true, .margin = 0.1},
                       .y = {.label = view.y_label, .logarithmic = true, .margin = 0.1},
                       .series = {},
                       .width = 960,
                       .height = 600,
                       .beside = 260};
    for (const Look& look : looks) {
        std::string label(look.family);
        for (const Curve& curve : study.curves) {
            if (curve.family != look.family) continue;
            plot.series.push_back(drawn(curve, view, look));
            plot.series.back().label = std::exchange(label, "");  // once a family
        }
    }
    for (const Level& level : view.levels)
        plot.levels.push_back({level.label, compare::dim, level.error});
    return compare::svg_plot(plot);
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
