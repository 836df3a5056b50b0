#include "lib/models/drag_area.hpp"

#include <gsl/gsl_interp.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

namespace twinchute {
namespace {

/// [(1 - eta) x^3 + eta]^2 (paper, Eq. 14).
ValueAndRate ludtke(double x, double eta) {
    const double root = (1.0 - eta) * x * x * x + eta;
    const double root_rate = 3.0 * (1.0 - eta) * x * x;
    return {root * root, 2.0 * root * root_rate};
}

/// eta^2 + (1 - eta^2) x^j. With eta = 0 it is (t/t_f)^j, the drag-area family of
/// Knacke (NWC TP 6575, Fig. 5-51: j = 1/2, 1, 2, 6); eta lifts its start without moving its end.
/// For j < 1 the drag area rises with infinite rate at x = 0; there, and there alone, the rate
/// is given as 0, so that it is finite everywhere. It can be integrated from either side.
ValueAndRate power(double x, double eta, double j) {
    const double start = eta * eta;
    if (x <= 0.0) return {start, j == 1.0 ? 1.0 - start : 0.0};  // below 0 by round-off only
    return {start + (1.0 - start) * std::pow(x, j), (1.0 - start) * j * std::pow(x, j - 1.0)};
}

double ludtke_integral(double x, double eta) {
    const double rise = 1.0 - eta, x3 = x * x * x;
    return x * (rise * rise * x3 * x3 / 7.0 + rise * eta * x3 / 2.0 + eta * eta);
}

double power_integral(double x, double eta, double j) {
    const double start = eta * eta;
    return start * x + (x > 0.0 ? (1.0 - start) * std::pow(x, j + 1.0) / (j + 1.0) : 0.0);
}

/// j = half_powers/2, of the rows.
template <int half_powers>
ValueAndRate power_of(double x, double eta) {
    return power(x, eta, 0.5 * half_powers);
}
template <int half_powers>
double power_of_integral(double x, double eta) {
    return power_integral(x, eta, 0.5 * half_powers);
}

constexpr std::string_view knacke_powers =
    "Knacke NWC TP 6575, Fig. 5-51: (t/t_f)^j; here above the initial drag area";

constexpr std::array<DragAreaLaw, 6> laws{{
    {"ludtke", "Ludtke's law for solid flat circular canopies, paper Eqs 14-15", ludtke, ludtke_integral},
    {"power-0.5", knacke_powers, power_of<1>, power_of_integral<1>},
    {"power-1", knacke_powers, power_of<2>, power_of_integral<2>},
    {"power-2", knacke_powers, power_of<4>, power_of_integral<4>},
    {"power-3", "here: between Knacke's powers of 2 and 6", power_of<6>, power_of_integral<6>},
    {"power-6", knacke_powers, power_of<12>, power_of_integral<12>},
}};

}  // namespace

std::span<const DragAreaLaw> drag_area_laws() {
    return laws;
}

ValueAndRate DragAreaGrowth::power(double x) const {
    return twinchute::power(x, eta, exponent);
}

double DragAreaGrowth::power_integral(double x) const {
    return twinchute::power_integral(x, eta, exponent);
}

const DragAreaLaw* find_drag_area_law(std::string_view name) {
    const auto row = std::ranges::find(laws, name, &DragAreaLaw::name);
    return row == laws.end() ? nullptr : &*row;
}

namespace {

/// Share of filling by which a piece goes on beyond its kinks, holding its ends: more than rounding makes of
/// a time.
constexpr double on_kink = 1e-9;

const gsl_interp* cubics_of(const std::shared_ptr<const void>& cubics) {
    return static_cast<const gsl_interp*>(cubics.get());
}

/// Change of slope at point i, none of a neighbour that is an end.
double change_of_slope(const std::vector<double>& x, const std::vector<double>& y, std::size_t i) {
    if (i == 0 || i + 1 == x.size()) return 0.0;
    return std::abs((y[i + 1] - y[i]) / (x[i + 1] - x[i]) - (y[i] - y[i - 1]) / (x[i] - x[i - 1]));
}

/// Whether an inner point is one, see DragAreaTable; nothing says so of three points.
bool is_kink(const std::vector<double>& x, const std::vector<double>& y, std::size_t i) {
    constexpr double more_than_smooth = 10.0;
    // Slopes are as exact as the digits of a file: what changes less is no kink.
    constexpr double straight = 1e-3;
    const double change = change_of_slope(x, y, i);
    return x.size() > 3 && change > straight &&
           change > more_than_smooth * (change_of_slope(x, y, i - 1) + change_of_slope(x, y, i + 1));
}

}  // namespace

DragAreaTable::DragAreaTable(std::string file, std::vector<double> fraction, std::vector<double> ratio)
    : file_(std::move(file)), fraction_(std::move(fraction)), ratio_(std::move(ratio)) {
    assert(fraction_.size() == ratio_.size() && fraction_.size() >= 3);
    const auto add = [&](std::size_t first, std::size_t last) {
        const std::size_t count = last - first + 1;
        const gsl_interp_type* type = count < 3 ? gsl_interp_linear : gsl_interp_steffen;
        const std::shared_ptr<gsl_interp> cubics(gsl_interp_alloc(type, count), gsl_interp_free);
        gsl_interp_init(cubics.get(), &fraction_[first], &ratio_[first], count);
        pieces_.push_back({first, last, cubics});
    };
    // Between points that stand there twice, each stretch is looked at by itself.
    for (std::size_t first = 0; first < fraction_.size();) {
        std::size_t last = first;
        while (last + 1 < fraction_.size() && fraction_[last + 1] > fraction_[last])
            ++last;
        const std::vector<double> x(&fraction_[first], &fraction_[last] + 1);
        const std::vector<double> y(&ratio_[first], &ratio_[last] + 1);
        std::size_t begin = 0;
        for (std::size_t i = 1; i + 1 < x.size(); ++i)
            if (is_kink(x, y, i)) add(first + std::exchange(begin, i), first + i);
        add(first + begin, last);
        first = last + 1;
    }
}

bool DragAreaTable::reaches(const Piece& piece, double x) const {
    return x >= fraction_[piece.first] - on_kink && x <= fraction_[piece.last] + on_kink;
}

ValueAndRate DragAreaTable::at(double x, std::size_t piece) const {
    const Piece* here = &pieces_[std::min(piece, pieces_.size() - 1)];
    if (!reaches(*here, x)) {
        const auto after =
            std::ranges::upper_bound(pieces_, x, {}, [this](const Piece& p) { return fraction_[p.first]; });
        here = after == pieces_.begin() ? &pieces_.front() : &*std::prev(after);
    }
    // Beyond its ends by round-off only.
    const double inside = std::clamp(x, fraction_[here->first], fraction_[here->last]);
    const double *points = &fraction_[here->first], *ratios = &ratio_[here->first];
    ValueAndRate at;
    gsl_interp_eval_e(cubics_of(here->cubics), points, ratios, inside, nullptr, &at.value);
    gsl_interp_eval_deriv_e(cubics_of(here->cubics), points, ratios, inside, nullptr, &at.rate);
    return at;
}

double DragAreaTable::integral(double x) const {
    double sum = 0.0;
    for (const Piece& piece : pieces_) {
        const double from = fraction_[piece.first], to = std::min(x, fraction_[piece.last]);
        if (!(to > from)) break;
        double integral = 0.0;
        gsl_interp_eval_integ_e(cubics_of(piece.cubics), &fraction_[piece.first], &ratio_[piece.first], from,
                                to, nullptr, &integral);
        sum += integral;
    }
    return sum;
}

double DragAreaTable::kink_after(std::size_t piece) const {
    return piece + 1 < pieces_.size() ? fraction_[pieces_[piece].last]
                                      : std::numeric_limits<double>::infinity();
}

}  // namespace twinchute
