#include "lib/models/filling.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "lib/math/root.hpp"
#include "lib/math/vec.hpp"

namespace twinchute {
namespace {

/// m_r [kg] of a bulb with radius R [m]: half that of a sphere that pulsates, 2 pi rho R^3.
double radial_mass(const FillingCanopy& canopy, double density, double R) {
    return canopy.filling().apparent_mass * 2.0 * pi * density * R * R * R;
}

/// [N] of a mass m_r ~ R^3 that grows: 1/2 m_r' (dR/dt)^2.
double growth_of_mass(double mass, double R, double R_rate) {
    return 1.5 * mass / R * R_rate * R_rate;
}

/// Eq. 6: the tube's pressure drives the bulb's growth, axial inertia helps it, apparent mass and damping
/// resist.
double predicted(const FillingCanopy& canopy, const FillingMotion& motion, const FillingAir& air,
                 const FillingLoads& now, double pull_excess) {
    const double D0 = canopy.sizes().nominal_diameter;
    const double R = motion.radius * D0, R_rate = motion.rate * D0;
    const double mass = radial_mass(canopy, air.density, R);
    const double damping =
        canopy.filling().radial_damping * air.density * std::abs(air.speed) * 2.0 * pi * R * R;
    // Beyond full open, where G < 0 brings the canopy back, the suction outside counts as well.
    const double share = motion.radius / canopy.steady_radius();
    const double drive = now.tube_pressure + (share > 1.0 ? canopy.suction() * share : 0.0);
    const double force = now.shape.work() * D0 * D0 * now.pressure * drive +
                         now.shape.centre_slope * pull_excess - damping * R_rate -
                         growth_of_mass(mass, R, R_rate);
    return force / (mass * D0);
}

/// Eq. 9, Wolf's momentum: a radial force coefficient against the lines' inward pull.
double wolf(const FillingCanopy& canopy, const FillingMotion& motion, const FillingAir& air,
            const FillingLoads& now, double pull_excess) {
    const double D0 = canopy.sizes().nominal_diameter;
    const double R = motion.radius * D0, R_rate = motion.rate * D0;
    const double mass = radial_mass(canopy, air.density, R);
    // In the steady canopy both balance.
    const double coefficient = (1.0 + canopy.suction()) * std::tan(canopy.family().steady_line_angle());
    const double force = coefficient * now.pressure * pi * R * R -
                         (now.drag + pull_excess) * std::tan(now.shape.line_angle) -
                         growth_of_mass(mass, R, R_rate);
    return force / (mass * D0);
}

constexpr std::array<FillingModel, 3> models{{
    {"predicted",
     "isotensoid bulb on a tube, mass balance with entrance loss; derived in docs/theory/filling.md",
     "subsonic, solid fabric; n within 25 % for flat circular canopies, 40 % for slotted ones (expected)",
     predicted},
    {"wolf", "radial momentum in the manner of Wolf, with the family's line angle",
     "to compare with: its filling time knows neither fabric nor speed", wolf, false},
    {"mass-balance", "the mass balance alone, without inertia: the slow manifold of \"predicted\"",
     "to compare with; nothing overshoots", nullptr},
}};

}  // namespace

std::span<const FillingModel> filling_models() {
    return models;
}

const FillingModel* find_filling(std::string_view name) {
    const auto row = std::ranges::find(models, name, &FillingModel::name);
    return row == models.end() ? nullptr : &*row;
}

FillingCanopy::FillingCanopy(const Filling& filling, const FillingSizes& sizes)
    : filling_(filling),
      sizes_(sizes),
      family_(isotensoid_family(sizes.line_length / sizes.nominal_diameter)) {
    const double D0 = sizes.nominal_diameter, full = family_->steady_radius() * D0;
    initial_radius_ = std::sqrt(filling.initial_mouth) * family_->steady_radius();
    suction_ = sizes.drag_area / (pi * full * full) - 1.0;
}

FillingCanopy::Leak FillingCanopy::leak(double fabric_area, double dp, double density) const {
    const double open = sizes_.geometric_porosity;
    const double u = sizes_.fabric.speed(dp);
    Leak total{(1.0 - open) * fabric_area * u, 0.0};
    if (!sizes_.fabric.is_tight())
        total.slope =
            (1.0 - open) * fabric_area / (sizes_.fabric.alpha + 2.0 * sizes_.fabric.beta * std::abs(u));
    if (open > 0.0) {
        const double jet = opening_speed(dp, density);
        total.flow += open * fabric_area * jet;
        total.slope += dp > 0.0 ? 0.5 * open * fabric_area * jet / dp : 0.0;
    }
    return total;
}

/// Eqs 3 and 4. Momentum that the air brings from the mouth adds pressure in the bulb, up to the whole of
/// what the inflow cost and no further.
double FillingCanopy::bulb_pressure(const FillingShape& shape, double radius, double inflow,
                                    double pressure) const {
    const double narrowing = shape.mouth_area / (pi * radius * radius);
    const double loss = std::max(0.0, filling_.entrance_loss - 2.0 * narrowing);
    const double inside = std::max(0.0, 1.0 - loss * inflow * std::abs(inflow));
    return pressure * std::max(0.0, inside + suction_ * radius / family_->steady_radius());
}

/// Eq. 1: A_m w s = dV/dt + leak(dp_b(s)). The right side falls with s, so that one root is bracketed between
/// the inflow without leak and that with the leak of the pressure there; Newton's steps, halved where they
/// leave it. A fixed-point iteration flips between full and empty bulbs.
double FillingCanopy::inflow(const FillingShape& shape, double radius, double volume_rate, double density,
                             double speed) const {
    const double D0 = sizes_.nominal_diameter;
    const double capacity = shape.mouth_area * D0 * D0 * speed, fabric = shape.fabric_area * D0 * D0;
    const double pressure = 0.5 * density * speed * speed;
    double low = volume_rate / capacity;
    if (sizes_.fabric.is_tight() && sizes_.geometric_porosity == 0.0) return low;
    double high = low + leak(fabric, bulb_pressure(shape, radius, low, pressure), density).flow / capacity;
    const double loss =
        std::max(0.0, filling_.entrance_loss - 2.0 * shape.mouth_area / (pi * radius * radius));
    double s = high, last_step = high - low, step = last_step;
    constexpr int enough = 100;  // halvings alone take 53
    for (int i = 0; i < enough; ++i) {
        const double dp = bulb_pressure(shape, radius, s, pressure);
        const Leak out = leak(fabric, dp, density);
        const double excess = capacity * s - volume_rate - out.flow;
        (excess > 0.0 ? high : low) = s;
        const double slope = capacity + out.slope * 2.0 * loss * std::abs(s) * pressure;
        // Newton's step, or half the bracket where that leaves it or does not shrink: the leak has a kink
        // where the bulb is empty.
        const double before = std::exchange(last_step, step);
        step = excess / slope;
        double next = s - step;
        if (!(next > low && next < high) || 2.0 * std::abs(step) > std::abs(before)) {
            next = 0.5 * (low + high);
            step = 0.5 * (high - low);
        }
        s = next;
        if (std::abs(step) <= 4e-16 * (1.0 + std::abs(s))) break;
    }
    return s;
}

FillingLoads FillingCanopy::loads(const FillingMotion& motion, const FillingAir& air) const {
    const double D0 = sizes_.nominal_diameter, a = motion.radius;
    FillingLoads now;
    now.shape = family_->at(a);
    now.volume = now.shape.volume * D0 * D0 * D0;
    now.volume_rate = now.shape.volume_slope * motion.rate * D0 * D0 * D0;
    now.mouth_area = now.shape.mouth_area * D0 * D0;
    // Air meets the mouth, which moves toward the payload while it widens.
    const double speed = air.speed - D0 * now.shape.mouth_slope * motion.rate;
    if (!(speed > 0.0)) return now;
    now.pressure = 0.5 * air.density * speed * speed;
    if (!filling_.model->has_balance) {
        now.bulb_pressure = now.pressure * (1.0 + suction_);
        now.drag = now.bulb_pressure * pi * a * a * D0 * D0;
        return now;
    }
    now.inflow = inflow(now.shape, a, now.volume_rate, air.density, speed);
    now.tube_pressure = 1.0 - filling_.entrance_loss * now.inflow * std::abs(now.inflow);
    now.bulb_pressure = bulb_pressure(now.shape, a, now.inflow, now.pressure);
    now.leak = leak(now.shape.fabric_area * D0 * D0, now.bulb_pressure, air.density).flow;
    now.drag = now.bulb_pressure * pi * a * a * D0 * D0;
    return now;
}

double FillingCanopy::acceleration(const FillingMotion& motion, const FillingAir& air,
                                   const FillingLoads& now, double pull_excess) const {
    return filling_.model->acceleration(*this, motion, air, now, pull_excess);
}

double FillingCanopy::balanced_rate(double radius, const FillingAir& air) const {
    const double D0 = sizes_.nominal_diameter;
    const FillingShape shape = family_->at(radius);
    const double inflow = 1.0 / std::sqrt(filling_.entrance_loss);
    const double pressure = 0.5 * air.density * air.speed * air.speed;
    const double out =
        leak(shape.fabric_area * D0 * D0, bulb_pressure(shape, radius, inflow, pressure), air.density).flow;
    return (shape.mouth_area * D0 * D0 * inflow * air.speed - out) / (shape.volume_slope * D0 * D0 * D0);
}

FillingMotion FillingCanopy::start(double radius, const FillingAir& air) const {
    return {radius, filling_.model->has_balance ? std::max(0.0, balanced_rate(radius, air)) : 0.0};
}

double FillingCanopy::reefed_radius(double line_length) const {
    const double skirt = line_length / (2.0 * pi * sizes_.nominal_diameter), full = steady_radius();
    if (skirt >= family_->at(full).mouth_radius) return full;
    return root_between([&](double a) { return family_->at(a).mouth_radius - skirt; }, 0.0, full, 1e-14);
}

std::optional<double> FillingCanopy::critical_speed(double density) const {
    constexpr int radii = 64;
    constexpr double slowest = 0.01, fastest = 340.0;  // [m/s]
    const double inflow = 1.0 / std::sqrt(filling_.entrance_loss), D0 = sizes_.nominal_diameter;
    // Least excess of inflow over leak, over speed and D0^2.
    const auto excess = [&](double speed) {
        double least = 1.0;
        for (int i = 0; i < radii; ++i) {
            const double a = initial_radius_ + (steady_radius() - initial_radius_) * i / radii;
            const FillingShape shape = family_->at(a);
            const double dp = bulb_pressure(shape, a, inflow, 0.5 * density * speed * speed);
            const double out = leak(shape.fabric_area * D0 * D0, dp, density).flow;
            least = std::min(least, shape.mouth_area * inflow - out / (speed * D0 * D0));
        }
        return least;
    };
    if (excess(fastest) > 0.0) return std::nullopt;
    if (excess(slowest) <= 0.0) return 0.0;
    return root_between(excess, slowest, fastest, 1e-9);
}

}  // namespace twinchute
