#include "lib/scene/drag_area.hpp"

#include <fmt/format.h>

#include <cmath>

#include "lib/math/vec.hpp"

namespace twinchute {
namespace {

/// [-] change of C_D0 that is worth a word: more than ranges of types leave open anyway, 3 to 10 % about
/// their middle.
constexpr double notable = 0.05;

DragFactor of_lines(const Scene& scene, const Parachute& p) {
    const auto& model = scene.aerodynamics.line_ratio;
    return model ? (*model)->factor(line_ratio(p)) : DragFactor{};
}

double trailing_ratio(const Scene& scene, const Parachute& p) {
    return (p.line_length + p.riser_length) / *scene.payload.diameter;
}

double diameter_ratio(const Scene& scene, const Parachute& p) {
    return p.projected_diameter_ratio * p.nominal_diameter / *scene.payload.diameter;
}

DragFactor of_wake(const Scene& scene, const Parachute& p) {
    const auto& model = scene.aerodynamics.forebody_wake;
    return model ? (*model)->factor(trailing_ratio(scene, p), diameter_ratio(scene, p)) : DragFactor{};
}

void warn_of_factor(Scene& scene, std::string what, std::string why, std::string_view range) {
    scene.warnings.push_back({std::move(what), std::move(why) + fmt::format(": the figure reaches {}", range),
                              "the nearer end is held; give a drag area of your own"});
}

}  // namespace

double line_ratio(const Parachute& chute) {
    if (!(chute.line_length > 0.0) || !(chute.riser_length > 0.0)) return 0.0;
    return (chute.line_length + chute.riser_length) / chute.nominal_diameter;
}

double stated_drag_area(const Parachute& chute) {
    return chute.uncorrected_drag_area.value_or(chute.drag_area);
}

std::vector<std::string> missing_for_corrections(const Scene& scene) {
    const Aerodynamics& a = scene.aerodynamics;
    std::vector<std::string> keys;
    if (!a.line_ratio && !a.forebody_wake) return keys;
    for (const Parachute& p : scene.parachutes) {
        if (!(p.line_length > 0.0)) keys.emplace_back("parachute.line_length");
        if (!(p.riser_length > 0.0)) keys.emplace_back("parachute.riser_length");
        if (a.forebody_wake && !(p.projected_diameter_ratio > 0.0))
            keys.emplace_back("parachute.projected_diameter_ratio");
    }
    if (a.forebody_wake && !scene.payload.diameter) keys.emplace_back("payload.diameter");
    return keys;
}

void set_drag_area(const Scene& scene, Parachute& p, double stated) {
    const Aerodynamics& a = scene.aerodynamics;
    p.drag_area = stated;
    p.uncorrected_drag_area.reset();
    if (!a.line_ratio && !a.forebody_wake) return;
    p.uncorrected_drag_area = stated;
    p.drag_area = stated * of_lines(scene, p).value * of_wake(scene, p).value;
}

namespace {

/// Handbooks print two digits of C_D0.
constexpr double last_digit = 0.01;

/// A drag area that does not belong to the diameter is the likeliest mistake of all.
void warn_of_coefficient(Scene& scene, const Parachute& p) {
    if (!p.type || !p.type->drag_coefficient) return;
    const TypeRange& range = *p.type->drag_coefficient;
    const double coefficient = stated_drag_area(p) / (0.25 * pi * p.nominal_diameter * p.nominal_diameter);
    if (coefficient >= range.low - last_digit && coefficient <= range.high + last_digit) return;
    scene.warnings.push_back(
        {fmt::format("{}: C_D0 = {:.3g} of a {} canopy", p.name, coefficient, p.type->title),
         fmt::format("drag area {:.4g} m^2 on D0 = {:.4g} m; its type has {:g} to {:g} ({})",
                     stated_drag_area(p), p.nominal_diameter, range.low, range.high, range.source),
         "check drag_area and nominal_diameter against each other"});
}

void warn_of_drag_area(Scene& scene, const Parachute& p) {
    warn_of_coefficient(scene, p);
    const double ratio = line_ratio(p);
    if (const auto& model = scene.aerodynamics.line_ratio; model && !of_lines(scene, p).inside)
        warn_of_factor(scene, "lines beyond the figure of line ratios", fmt::format("L_e/D0 = {:.3g}", ratio),
                       (*model)->range);
    if (const auto& model = scene.aerodynamics.forebody_wake; model && !of_wake(scene, p).inside)
        warn_of_factor(scene, "a wake beyond the figure of forebodies",
                       fmt::format("L_T/D_B = {:.3g}, D_p/D_B = {:.3g}", trailing_ratio(scene, p),
                                   diameter_ratio(scene, p)),
                       (*model)->range);
    // Only a coefficient from a table belongs to lines of D0; who states a drag area knows the lines.
    if (ratio == 0.0 || !p.type || scene.aerodynamics.line_ratio) return;
    const double factor = find_line_ratio("flat-circular")->factor(ratio).value;
    if (std::abs(factor - 1.0) > notable)
        scene.warnings.push_back(
            {fmt::format("{}line ratio {:.2f}", scene.parachutes.size() > 1 ? p.name + ": " : "", ratio),
             fmt::format(
                 "C_D0 of a type belongs to lines of D0; a flat circular canopy would have {:.0f} % of it",
                 100.0 * factor),
             "set aerodynamics.line_ratio, or give the drag area of these lines"});
}

}  // namespace

const Parachute& landing_parachute(const Scene& scene) {
    const auto drag_area = [](const Parachute& p) { return p.count * p.cluster_drag_ratio * p.drag_area; };
    return *std::ranges::max_element(scene.parachutes, [&](const Parachute& a, const Parachute& b) {
        return std::pair(!a.cut, drag_area(a)) < std::pair(!b.cut, drag_area(b));
    });
}

void warn_of_drag_area(Scene& scene) {
    for (const Parachute& p : scene.parachutes)
        warn_of_drag_area(scene, p);
}

}  // namespace twinchute
