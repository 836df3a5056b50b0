#include "lib/models/drag_area.hpp"

#include <gsl/gsl_interp.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

namespace twinchute {
namespace {

/// [(1 - eta) x^3 + eta]^2 (paper, Eq. 14).
ValueAndRate ludtke(double x, double eta) {
    const double root = (1.0 - eta) * x * x * x + eta;
    const double root_rate = 3.0 * (1.0 - eta) * x * x;
    return {root * root, 2.0 * root * root_rate};
}

/// eta^2 + (1 - eta^2) x^j with j = half_powers/2. With eta = 0 it is (t/t_f)^j, the drag-area family of
/// Knacke (NWC TP 6575, Fig. 5-51: j = 1/2, 1, 2, 6); eta lifts its start without moving its end.
/// For j = 1/2 the drag area rises with infinite rate at x = 0; there, and there alone, the rate
/// is given as 0, so that it is finite everywhere. It can be integrated from either side.
template <int half_powers>
ValueAndRate power(double x, double eta) {
    constexpr double j = 0.5 * half_powers;
    const double start = eta * eta;
    if (x <= 0.0) return {start, half_powers == 2 ? 1.0 - start : 0.0};  // below 0 by round-off only
    return {start + (1.0 - start) * std::pow(x, j), (1.0 - start) * j * std::pow(x, j - 1.0)};
}

double ludtke_integral(double x, double eta) {
    const double rise = 1.0 - eta, x3 = x * x * x;
    return x * (rise * rise * x3 * x3 / 7.0 + rise * eta * x3 / 2.0 + eta * eta);
}

template <int half_powers>
double power_integral(double x, double eta) {
    constexpr double j = 0.5 * half_powers;
    const double start = eta * eta;
    return start * x + (x > 0.0 ? (1.0 - start) * std::pow(x, j + 1.0) / (j + 1.0) : 0.0);
}

constexpr std::string_view knacke =
    "Knacke NWC TP 6575, Fig. 5-51: (t/t_f)^j; here above the initial drag area";

constexpr std::array<DragAreaLaw, 6> laws{{
    {"ludtke", "Ludtke's law for solid flat circular canopies, paper Eqs 14-15", ludtke, ludtke_integral},
    {"power-0.5", knacke, power<1>, power_integral<1>},
    {"power-1", knacke, power<2>, power_integral<2>},
    {"power-2", knacke, power<4>, power_integral<4>},
    {"power-3", "here: between Knacke's powers of 2 and 6", power<6>, power_integral<6>},
    {"power-6", knacke, power<12>, power_integral<12>},
}};

}  // namespace

std::span<const DragAreaLaw> drag_area_laws() {
    return laws;
}

const DragAreaLaw* find_drag_area_law(std::string_view name) {
    const auto row = std::ranges::find(laws, name, &DragAreaLaw::name);
    return row == laws.end() ? nullptr : &*row;
}

namespace {

const gsl_interp* cubics_of(const std::shared_ptr<const void>& cubics) {
    return static_cast<const gsl_interp*>(cubics.get());
}

}  // namespace

DragAreaTable::DragAreaTable(std::string file, std::vector<double> fraction, std::vector<double> ratio)
    : file_(std::move(file)), fraction_(std::move(fraction)), ratio_(std::move(ratio)) {
    assert(fraction_.size() == ratio_.size() &&
           fraction_.size() >= gsl_interp_type_min_size(gsl_interp_steffen));
    const std::shared_ptr<gsl_interp> cubics(gsl_interp_alloc(gsl_interp_steffen, fraction_.size()),
                                             gsl_interp_free);
    gsl_interp_init(cubics.get(), fraction_.data(), ratio_.data(), fraction_.size());
    cubics_ = cubics;
}

ValueAndRate DragAreaTable::at(double x) const {
    const double inside = std::clamp(x, fraction_.front(), fraction_.back());  // beyond by round-off only
    ValueAndRate at;
    gsl_interp_eval_e(cubics_of(cubics_), fraction_.data(), ratio_.data(), inside, nullptr, &at.value);
    gsl_interp_eval_deriv_e(cubics_of(cubics_), fraction_.data(), ratio_.data(), inside, nullptr, &at.rate);
    return at;
}

double DragAreaTable::integral(double x) const {
    const double inside = std::clamp(x, fraction_.front(), fraction_.back());
    double integral = 0.0;
    gsl_interp_eval_integ_e(cubics_of(cubics_), fraction_.data(), ratio_.data(), fraction_.front(), inside,
                            nullptr, &integral);
    return integral;
}

}  // namespace twinchute
