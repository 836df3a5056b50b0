// Whether a descent is steady, and how much its rate will still change: from what the fall has done so far
// and from the balance of forces, the same for every fidelity.
//
// Terms. w: downward speed through the air; V: magnitude of that velocity, to whose square the drag is
// proportional; u = w sqrt(rho), free of the density; W: weight; mu = M_a/m. A bar is a mean over a window.
//
// Balance. Drag points along V, so that its vertical part is 1/2 rho C_D S V w. Over a window of length T
//   W - 1/2 C_D S bar(rho V w) = W J/(g T),   J = dw_m + mu dw_a [+ (dM_a/dt) w dt/m where air accretes],
// with the speeds gained by the material and by the air that moves along. A fall without swing or
// acceleration has 1/2 C_D S u_b^2 = W, therefore
//   u_b^2 = bar(rho V w)/(1 - J/(g T)).
// Other forces (drag of lines and payload) enter bar(u) and u_b alike. ln(bar(u)/u_b) is the change that
// remains if swing, bounce and transient die out, and it needs no period and no decay to be known:
//   transient: w = w_e (1 + a exp(-t/tau)), tau = (1 + mu) v/(2 g): ln(bar(u)/u_b) = bar(a exp(-t/tau)), once
//     J has taken out what the mean of w^2 holds of it;
//   swing: a velocity s sin(omega t) across gives bar(V w) = w^2 (1 + s^2/(4 w^2)): the mean rate is lower by
//     s^2/(8 w^2), second order in the amplitude; a pendulum of length L and angle theta has s^2 <= g L
//     theta^2;
//   a window that cuts a period: bar(u) is off, u_b is not, since J holds what was gained and lost.
//
// Trend. u_b is constant but for forces that the balance does not hold (a canopy that breathes while its
// shape settles). Means b1, b2, b3 over the thirds of the window, d1 = b2 - b1, d2 = b3 - b2; a decay by r =
// d2/d1 a third leaves d2 r/(1 - r) after b3 (Aitken). Where they differ in sign no decay is seen, and the
// larger one counts.
//
// Breathing. Where mu follows a canopy that breathes, int(mu dw_a) holds (mu - bar(mu)) dw_a as well, which
// does not sum to zero over a period: a force that lasts, and shifts the rate by its half share r of W. J
// takes it for transient, so that ln(bar(u)/u_b) holds it once. It goes with the square of an amplitude that
// may double: 3 r more may come. Without damping the amplitude itself can grow, tenfold within a minute
// (r = 0.02 % and 1 % of the rate at its end), and no rate says so: a canopy that breathes more in the second
// half of a window than in the first is not steady. Where air accretes, r holds the force that growth will
// ask for as well, but for the growth that denser air brings.
//
// Glide. Lift turns the force on the canopy by the angle gamma of the path, so that it carries the weight and
// w = w_e cos^1.5 gamma: lower by 3 gamma^2/4, of which bar(V w) holds gamma^2/4. The rest, |bar(V_h)|^2/(2
// w^2) of the mean horizontal velocity as a vector, may still come or go; a pendulum's averages out.
//
// Shape. A canopy that fell in and fills again under a prescribed drag area moves air and mass about in ways
// that no balance of means holds, and its speed may stay for a window: its mean projected area has to stay,
// too.
//
// Swing that lasts. In a limit cycle or a glide bar(u) stays below u_b for good. Then bar(u) itself has to
// stay, by the same extrapolation over three windows of two periods each. A swing that grows counts as
// growing on.
//
// Air. Denser air below brakes: D/W - 1 = (1 + mu) w^2/(2 g H), H = -rho/(drho/dz), so that u lies above u_b
// by lag = (1 + mu) w^2/(4 g H), which belongs to a steady fall; its change below does not. Wind that changes
// by dW over the way w^2/g in which the fall follows it leaves a velocity dW across and lowers the rate by
// (dW/w)^2/4; a pendulum that it sets swinging has twice that amplitude at most, (dW/w)^2/2 in the mean.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "lib/record/archive.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute {

/// The mean of v sqrt(rho) over one half of the window differs from that over the other by less than this.
inline constexpr double steady_descent_change = 0.005;
/// The estimate of the change that remains is below this: less than steady_descent_change by what estimates
/// have been found to be off, 0.15 % of the rate in the worst of 140 random scenes.
inline constexpr double steady_descent_remaining = 0.0035;
/// The mean projected area of the canopy over one half of the window differs from that over the other by
/// less.
inline constexpr double steady_descent_filling = 0.05;
/// A canopy whose projected area varies (root mean square over the mean) by more than this must not vary
/// more in the second half of the window than in the first. Ten times as much would move the rate by 0.2 %.
inline constexpr double steady_descent_breath = 0.005;
/// The amplitude of v sqrt(rho) over its mean from which on it is stated beside the rate.
inline constexpr double steady_descent_amplitude = 0.02;
/// [s] of fall that changes of air and wind below are looked for in. No similarity rules the depth of an
/// atmosphere, so that this does not scale.
inline constexpr double steady_descent_foresight = 60.0;

/// A fall at one instant.
struct FallSample {
    double time = 0.0;              ///< [s] since release
    double density = 0.0;           ///< [kg/m^3]
    double sink = 0.0;              ///< w [m/s] downward through the air, of the velocity that drag goes by
    double airspeed = 0.0;          ///< V [m/s]
    double updraft = 0.0;           ///< [m/s] of that air, upward
    double system_sink = 0.0;       ///< [m/s] downward over ground, mean over the material
    double air_sink = 0.0;          ///< [m/s] the same of the air that moves along
    double added_mass_ratio = 0.0;  ///< mu [-]
    double accretion = 0.0;  ///< [1/s] dM_a/dt over the material mass, where joining air is accelerated
    double growth = 0.0;     ///< [1/s] dM_a/dt likewise, of air that was accelerated before as well
    double swing = 0.0;      ///< [m^2/s^2] V_h^2 + 2 g L (1 - cos theta): s^2 of a pendulum at any phase
    double period = 0.0;     ///< [s] of that pendulum
    std::array<double, 2> across{};  ///< [m/s] horizontal velocity through that air
    double area = 0.0;               ///< [m^2] projected, of the canopy; 0 where it has no shape
};

/// The fall over one window.
struct DescentWindow {
    double from = 0.0, to = 0.0;  ///< [s] since release
    double rate = 0.0;            ///< [m/s] mean vertical speed over ground, downward
    double amplitude = 0.0;       ///< [-] half the range of u over its mean
    double drift = 0.0;           ///< [-] of the mean of u from the first half to the second
    double remaining = 0.0;       ///< [-] estimate of the change of the rate that remains, at equal density
    double breathing = 0.0;       ///< [-] what of that breathing and growth may still bring
    double filling = 0.0;         ///< [-] of the mean projected area, as drift
    /// [-] root mean square of the projected area about its mean, over that mean: in each half
    std::array<double, 2> breath{};
    double turns =
        1.0;  ///< of the canopy's skirt on its way around, furthest from 1: it does not cross itself

    bool breathes_more() const { return breath[1] > std::max(steady_descent_breath, breath[0]); }
    bool is_steady() const {
        return std::abs(drift) < steady_descent_change && remaining < steady_descent_remaining &&
               std::abs(filling) < steady_descent_filling && !breathes_more() && turns == 1.0;
    }
};

/// Length [m/s over m/s^2 = s] of a window without swing: 4 w/g, and five times tau.
inline double descent_window(double sink, double added_mass_ratio, double gravity) {
    return std::max(4.0, 2.5 * (1.0 + added_mass_ratio)) * sink / gravity;
}

/// lag [-] of a steady fall at `altitude` [m] and `sink` [m/s]: 0 in uniform air.
double density_lag(const Environment& environment, double altitude, double sink, double added_mass_ratio);

/// Change of the rate [-], at equal density, that air and wind below bring within steady_descent_foresight or
/// before the ground.
double change_below(const Environment& environment, double altitude, double sink, double added_mass_ratio);

/// Judges a fall sample by sample. One object for each drag area: restart() where that changes.
class SteadyDescent {
public:
    /// The environment outlives it.
    explicit SteadyDescent(const Environment& environment) : environment_(&environment) {}

    /// Forgets all samples.
    void restart() { rows_.clear(); }
    /// Later than the last one.
    void add(const FallSample& now);
    /// The window that ends with the last sample, at `altitude` [m]; nothing before there is a whole one.
    std::optional<DescentWindow> judge(double altitude);

    /// Between two samples.
    void serialize(Archive& archive);

private:
    /// Integrals from the first sample on.
    struct Row {
        double time, u;
        double descent, path, balance, gained, swing;
        double air_sink, added, air_gained;  // not an integral; of mu dt, of mu dw_a
        double grown;                        // integral of growth w, but for the density's
        std::array<double, 2> across;
        double area, area_squared;
    };
    std::size_t row_at(double time) const;
    double mean(double Row::*integral, std::size_t from, std::size_t to) const;
    double balanced(std::size_t from, std::size_t to) const;
    double trend_of_balance(std::size_t from, std::size_t to) const;
    double trend_of_mean(std::size_t from, std::size_t to) const;
    double amplitude(std::size_t from) const;
    double glide(std::size_t from, std::size_t to, double sink) const;
    double breath(std::size_t from, std::size_t to) const;
    double breathing(std::size_t from, std::size_t to) const;

    const Environment* environment_;
    FallSample last_;
    Row now_{};
    std::vector<Row> rows_;  // at least spacing apart, the last one as long as none is due
};

/// The warning of a run without a descent rate.
inline constexpr const char* not_steady_within_run = "no descent rate: not steady within the run";

/// Describes in words how a window is not steady.
std::string unsteadiness_text(const std::optional<DescentWindow>& last);

}  // namespace twinchute
