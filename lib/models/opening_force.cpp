#include "lib/models/opening_force.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "lib/math/interpolation.hpp"
#include "lib/math/maximum.hpp"

namespace twinchute {
namespace {

constexpr double psf = 47.880258980;          // [Pa]
constexpr double highest = 15000.0 * 0.3048;  // [m] Knacke on Fig. 5-48: for use below that

// A force goes with the square of the speed: 5 % of the speed are 10 % of the force, which is what sizing by
// formula accepts.
constexpr double speed_share = 0.05, force_share = 0.10;

double dynamic_pressure(const OpeningForceInputs& in) {
    return 0.5 * in.density * in.speed * in.speed;
}

double steady_drag(const OpeningForceInputs& in) {
    return in.drag_area * dynamic_pressure(in);
}

double coefficient(const OpeningForceInputs& in) {
    return in.coefficient.value_or(std::numeric_limits<double>::quiet_NaN());
}

double loading(const OpeningForceInputs& in) {
    return in.mass * in.gravity / in.drag_area;
}

/// Solid fabric by Fig. 5-51, unless the scene chose a power of its own.
DragAreaGrowth power_growth(const OpeningForceInputs& in) {
    const bool is_power = in.law != nullptr && in.law->name.starts_with("power");
    return {is_power ? in.law : find_drag_area_law("power-2"), 0.0, nullptr, in.exponent};
}

double reduction_by_pflanz(const OpeningForceInputs& in) {
    return drag_only_peak(power_growth(in), ballistic_parameter(in, in.filling_time), 1.0);
}

/// R_m and n of the momentum-impulse theorem.
double impulse_mass_ratio(const OpeningForceInputs& in) {
    return in.density * std::pow(in.drag_area, 1.5) / in.mass;
}

/// With the shape of the opening that goes with the mass ratio (OSCalc).
double impulse_diameters(const OpeningForceInputs& in) {
    const double ratio = impulse_mass_ratio(in);
    const double shape = ratio > 0.1 ? 0.5 : ratio > 0.01 ? 0.35 : 0.2;
    return in.speed * in.filling_time * shape / std::sqrt(in.drag_area);
}

double momentum_impulse(const OpeningForceInputs& in) {
    return steady_drag(in) * momentum_impulse_coefficient(impulse_mass_ratio(in), impulse_diameters(in));
}

/// (t/t_f)^j goes on until it reaches C_x.
double overshooting(const OpeningForceInputs& in) {
    const DragAreaGrowth growth = power_growth(in);
    const double exponent = growth.at(1.0).rate;  // of x^j
    return steady_drag(in) * drag_only_peak(growth, ballistic_parameter(in, in.filling_time),
                                            std::pow(coefficient(in), 1.0 / exponent));
}

double infinite_mass(const OpeningForceInputs& in) {
    return coefficient(in) * steady_drag(in);
}

double by_loading(const OpeningForceInputs& in) {
    return coefficient(in) * steady_drag(in) * force_reduction_by_loading(loading(in));
}

double pflanz(const OpeningForceInputs& in) {
    return coefficient(in) * steady_drag(in) * reduction_by_pflanz(in);
}

/// The initial phase brakes with a constant drag area, then comes the law.
double ludtke(const OpeningForceInputs& in) {
    const double start = in.eta * in.eta;
    const double left =
        1.0 / (1.0 + (in.initial_time > 0.0 ? start / ballistic_parameter(in, in.initial_time) : 0.0));
    const double ballistic = ballistic_parameter(in, in.filling_time - in.initial_time) / left;
    const DragAreaGrowth growth{in.law, in.eta, in.table, in.exponent};
    const double later = left * left * drag_only_peak(growth, ballistic, growth.end());  // with an overshoot
    return steady_drag(in) * std::max(start, later);
}

std::string without_coefficient(const OpeningForceInputs& in) {
    return in.coefficient ? "" : "needs C_x of the canopy's type (parachute.opening_force_coefficient)";
}

/// Effect that a balance of drag and inertia alone leaves out.
std::string beyond_drag_only(const OpeningForceInputs& in) {
    const double gained = in.gravity * in.filling_time / in.speed;
    if (gained > speed_share)
        return fmt::format("drag only: gravity is worth {:.3g} % of the speed while it fills",
                           100.0 * gained);
    const double air = in.added_mass / in.mass;
    if (air > force_share)
        return fmt::format("drag only: the open canopy moves {:.3g} % of the mass in air", 100.0 * air);
    return {};
}

std::string beyond_infinite_mass(const OpeningForceInputs& in) {
    if (std::string missing = without_coefficient(in); !missing.empty()) return missing;
    const double kept = reduction_by_pflanz(in);
    if (kept < 1.0 - force_share)
        return fmt::format("the payload slows down while it fills: X_1 = {:.2f} (Pflanz)", kept);
    return {};
}

std::string beyond_loading(const OpeningForceInputs& in) {
    if (std::string missing = without_coefficient(in); !missing.empty()) return missing;
    const double psf_loading = loading(in) / psf;
    if (psf_loading < 1.0) return fmt::format("{:.2f} psf, the figure is for 1 psf and more", psf_loading);
    if (psf_loading > 100.0) return fmt::format("{:.0f} psf, the figure ends at 100 psf", psf_loading);
    if (in.altitude > highest)
        return fmt::format("{:.0f} m, the figure is for less than 4572 m (15 000 ft)", in.altitude);
    return {};
}

std::string beyond_pflanz(const OpeningForceInputs& in) {
    std::string missing = without_coefficient(in);
    return missing.empty() ? beyond_drag_only(in) : missing;
}

std::string beyond_impulse(const OpeningForceInputs& in) {
    const double ratio = impulse_mass_ratio(in), diameters = impulse_diameters(in);
    if (ratio < 1e-4 || ratio > 10.0)
        return fmt::format("R_m = {:.3g}, the curves reach from 1e-4 to 10", ratio);
    if (diameters < 1.0)
        return fmt::format("n = {:.2g} generalised diameters, the curves begin at 1", diameters);
    return "for orientation: a third hand's fit to a digitised figure, two curves for all n";
}

constexpr std::array<OpeningForceForm, 6> forms{{
    {"infinite-mass", "infinite mass: C_x q (C_D S)_0", "Knacke NWC TP 6575, C_x of Table 5-1", infinite_mass,
     beyond_infinite_mass},
    {"canopy-loading", "canopy loading: C_x q (C_D S)_0 X_1(W/(C_D S)_0)", "Knacke NWC TP 6575, Fig. 5-48",
     by_loading, beyond_loading},
    {"pflanz", "Pflanz: C_x q (C_D S)_0 X_1(A)", "Pflanz; Knacke NWC TP 6575, Fig. 5-51, in closed form",
     pflanz, beyond_pflanz},
    {"pflanz-overshoot", "Pflanz with overshoot: (C_D S)_0 (t/t_f)^j up to C_x",
     "Pflanz and Ludtke, generalised; in closed form", overshooting, beyond_pflanz},
    {"momentum-impulse", "momentum and impulse: C_k(R_m) q (C_D S)_0", "Potvin's theorem, OSCalc's curves",
     momentum_impulse, beyond_impulse},
    {"ludtke", "Ludtke: the scene's drag-area law without gravity",
     "the paper, Eqs 14-15, with drag and inertia alone: in closed form", ludtke, beyond_drag_only},
}};

}  // namespace

std::span<const OpeningForceForm> opening_force_forms() {
    return forms;
}

double ballistic_parameter(const OpeningForceInputs& in, double t) {
    return 2.0 * in.mass / (in.drag_area * in.density * in.speed * t);
}

double drag_only_peak(const DragAreaGrowth& growth, double ballistic, double last) {
    // Over the square root of tau, so that the early peak of a light payload is wide: with a power of 1/2
    // and A = 1e-4 it stands at tau = 5e-4.
    const auto ratio = [&](double root) {
        const double tau = root * root;
        const double slowed = 1.0 + growth.integral(tau) / ballistic;
        return growth.at(tau).value / (slowed * slowed);
    };
    return maximum_on(ratio, 0.0, std::sqrt(last), 64).value;
}

double drag_only_peak(const DragAreaLaw& law, double eta, double ballistic) {
    return drag_only_peak({&law, eta}, ballistic, 1.0);
}

double momentum_impulse_coefficient(double mass_ratio, double diameters) {
    const double x = std::log10(mass_ratio);
    if (diameters < 4.0) return 0.647104 + x * (-0.361679 + x * (-0.0263548 + x * 0.00513730));
    return 0.125520 + x * (-0.213092 + x * (0.179838 + x * (-0.0181437 + x * (-0.0335675 - x * 0.00483469))));
}

double force_reduction_by_loading(double loading) {
    static const std::vector<double> at = [] {
        std::vector<double> logarithms;
        for (const double x : {0.4, 0.6, 1.0, 2.0, 4.0, 6.0, 8.0, 10.0, 20.0, 40.0, 60.0, 100.0})
            logarithms.push_back(std::log(x * psf));
        return logarithms;
    }();
    static const std::vector<double> read{0.021, 0.048, 0.100, 0.200, 0.324, 0.402,
                                          0.462, 0.505, 0.667, 0.810, 0.893, 0.977};
    return std::clamp(Between(at, std::log(loading)).linear(read), 0.0, 1.0);
}

}  // namespace twinchute
