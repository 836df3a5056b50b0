#include "lib/models/isotensoid.hpp"

#include <array>
#include <cassert>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>

#include "lib/math/quadrature.hpp"
#include "lib/math/root.hpp"
#include "lib/math/vec.hpp"

namespace twinchute {
namespace {

// From the apex to the equator, of a bulb of radius 1: arc and height of the meridian, 1/a int dr/cos(phi)
// and int tan(phi) dr, volume over pi, and its moment about the equator over pi.
constexpr double cap_arc = 1.3110287771460599;
constexpr double cap_volume = cap_arc / 3.0;
constexpr double cap_moment = 0.10532862561290304;

// Beyond the equator the meridian turns by t: r = a sqrt(cos t), ds = a/2 dt/sqrt(cos t), dz = a/2 sqrt(cos
// t) dt.
double arc_to(double turn) {
    return integral([](double t) { return 0.5 / std::sqrt(std::cos(t)); }, turn);
}
double height_to(double turn) {
    return integral([](double t) { return 0.5 * std::sqrt(std::cos(t)); }, turn);
}

/// Radius of the bulb that hangs on lines and tube of the angle `beta`, `length` being L + 1/2: the tube
/// begins where the bulb's meridian points to the confluence.
double radius_at(double beta, double length) {
    return length * std::sin(beta) / (std::sqrt(std::cos(beta)) + (cap_arc + arc_to(beta)) * std::sin(beta));
}

/// Volume and its moment about the confluence, of bulb and tube.
struct Volume {
    double value, moment;
};

Volume volume_at(double beta, double a, double lines) {
    const double length = lines + 0.5 - a * (cap_arc + arc_to(beta));
    const double begin = lines * std::cos(beta), end = length * std::cos(beta);  // of the tube, z
    const double cone = pi * std::tan(beta) * std::tan(beta);
    const auto slice = [](double t) { return 0.5 * std::cos(t) * std::sqrt(std::cos(t)); };
    const double behind = integral(slice, beta);
    const double moment = integral([&](double t) { return slice(t) * height_to(t); }, beta);
    const double bulb = pi * a * a * a * (cap_volume + behind);
    const double equator = end + a * height_to(beta);
    return {bulb + cone * (end * end * end - begin * begin * begin) / 3.0,
            bulb * equator + pi * a * a * a * a * (cap_moment - moment) +
                cone * (std::pow(end, 4) - std::pow(begin, 4)) / 4.0};
}

}  // namespace

IsotensoidFamily::IsotensoidFamily(double lines) : lines_(lines) {
    assert(lines >= shortest_lines && lines <= longest_lines);
    constexpr double closeness = 1e-15, half_turn = 0.5 * pi;
    const double length = lines + 0.5;
    steady_line_angle_ =
        root_between([&](double beta) { return radius_at(beta, length) * (cap_arc + arc_to(beta)) - 0.5; },
                     1e-3, 0.8 * half_turn, closeness);
    steady_radius_ = radius_at(steady_line_angle_, length);
    // A step of an integrator looks a little beyond the full canopy before it goes back to it.
    const double largest_angle = 1.05 * steady_line_angle_, largest = radius_at(largest_angle, length);
    std::array<double, terms> angle, volume, arc, centre;
    for (std::size_t k = 0; k < terms; ++k) {
        const double a = Chebyshev<terms>::node(k, 0.0, largest);
        const double beta = root_between([&](double b) { return radius_at(b, length) - a; }, 0.0,
                                         1.01 * largest_angle, closeness);
        const Volume v = volume_at(beta, a, lines);
        angle[k] = beta / a;
        volume[k] = v.value / (a * a);
        arc[k] = cap_arc + arc_to(beta);
        centre[k] = v.moment / v.value;
    }
    angle_ = {angle, 0.0, largest};
    volume_ = {volume, 0.0, largest};
    arc_ = {arc, 0.0, largest};
    centre_ = {centre, 0.0, largest};
}

FillingShape IsotensoidFamily::at(double a) const {
    const auto angle = angle_.at(a), volume = volume_.at(a);
    const double beta = angle.value * a, beta_slope = angle.value + angle.slope * a;
    const double radius = lines_ * std::sin(beta), arc = arc_.at(a).value * a;
    FillingShape shape;
    shape.line_angle = beta;
    shape.volume = volume.value * a * a;
    shape.volume_slope = (2.0 * volume.value + volume.slope * a) * a;
    shape.mouth_area = pi * radius * radius;
    shape.mouth_slope = -radius * beta_slope;
    shape.fabric_area = pi * arc * arc;
    shape.centre_slope = centre_.at(a).slope;
    shape.mouth_radius = radius;
    return shape;
}

std::shared_ptr<const IsotensoidFamily> isotensoid_family(double lines) {
    static std::mutex one_at_a_time;
    static std::map<double, std::shared_ptr<const IsotensoidFamily>> made;
    constexpr std::size_t enough = 256;  // a sweep over lengths need not keep them all
    const std::lock_guard lock(one_at_a_time);
    if (made.size() >= enough) made.clear();
    auto& family = made[lines];
    if (!family) family = std::make_shared<const IsotensoidFamily>(lines);
    return family;
}

}  // namespace twinchute
