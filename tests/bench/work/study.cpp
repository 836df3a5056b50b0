#include "tests/bench/work/study.hpp"

#include <fmt/format.h>

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
                           Look{"ARKODE, even steps", "#e69f00", Shape::triangle}};

/// A line a method, all of a family in its colour; each begins with the method's name.
compare::CostFamily drawn(const Study& study, const Look& look) {
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
            point.title = fmt::format("{} at {}: error {:.2g} after {} evaluations", curve.method,
                                      sample.setting, sample.error, sample.evaluations);
            point.x = static_cast<double>(sample.evaluations);
            point.y = sample.error;
            point.rank = last ? 0 : 2;
            point.shape = look.shape;
            point.joined = !first;
            family.points.push_back(std::move(point));
        }
    }
    return family;
}

std::string picture(const Study& study) {
    compare::CostPlot plot;
    plot.title = study.title;
    plot.subtitle = study.subtitle;
    plot.x_label = "evaluations of the right-hand side [-]";
    plot.y_label = fmt::format("relative error of {} [-]", study.error);
    for (const Look& look : looks)
        if (std::ranges::any_of(study.curves, [&](const Curve& c) { return c.family == look.family; }))
            plot.families.push_back(drawn(study, look));
    return compare::cost_svg(plot);
}

std::string table(const Study& study) {
    const Provenance made = current_provenance();
    std::string text =
        fmt::format("# {}; commit {}, {}\nmethod,family,setting,evaluations,seconds,error,other_error\n",
                    study.title, made.commit, made.compiler);
    for (const Curve& curve : study.curves)
        for (const Sample& s : curve.samples)
            text += fmt::format("{},{},{},{},{:.3g},{:.3g},{}\n", csv_field(curve.method),
                                csv_field(curve.family), s.setting, s.evaluations, s.seconds, s.error,
                                std::isnan(s.other_error) ? "" : fmt::format("{:.3g}", s.other_error));
    return text;
}

void save(const std::filesystem::path& path, const std::string& text) {
    std::ofstream file(path);
    file << text;
    if (!file.flush()) throw std::runtime_error(fmt::format("cannot write {}", path.string()));
}

}  // namespace

void write(const Study& study, const std::filesystem::path& directory) {
    std::filesystem::create_directories(directory);
    save(directory / fmt::format("work-{}.csv", study.name), table(study));
    save(directory / fmt::format("work-{}.svg", study.name), picture(study));
}

}  // namespace twinchute::bench
