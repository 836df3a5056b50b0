// Integration of small systems by SUNDIALS: explicit Runge-Kutta pairs and diagonally implicit ones (ARKODE),
// and linear multistep methods (CVODE). This file pair is the only one that sees SUNDIALS.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace twinchute {

/// A row of the table of methods.
struct OdeMethod {
    std::string_view name;
    int order;       ///< of a Runge-Kutta pair; the highest that a multistep method goes to
    bool implicit;   ///< for stiff phases: Newton's method with a dense Jacobian of difference quotients
    bool multistep;  ///< order and step change as it goes; begins with order one after each restart
    std::string_view source;
};

std::span<const OdeMethod> ode_methods();  ///< what `rom.method` chooses from, the explicit ones first
std::span<const OdeMethod> explicit_methods();
std::span<const OdeMethod> implicit_methods();
const OdeMethod* find_ode_method(std::string_view name);

/// One initial-value problem, advanced one internal step at a time.
///
/// The caller sets a stop time at every discontinuity of the right-hand side: no step reaches
/// beyond it, and the last one ends on it exactly.
class OdeSolver {
public:
    /// dy/dt = f(t, y); y and dydt have the size of the initial state.
    using Rhs = std::function<void(double t, std::span<const double> y, std::span<double> dydt)>;
    /// g(t, y), one value per root; a sign change of any of them ends a step.
    using Roots = std::function<void(double t, std::span<const double> y, std::span<double> g)>;

    enum class Outcome { stepped, reached_stop, found_root, failed };

    /// atol: absolute tolerance of each component. `space` > 0 where the state is blocks of `space` positions
    /// followed by their velocities: what lies inside a step is then two orders closer (dense_output.hpp).
    /// Throws std::invalid_argument where SUNDIALS refuses its arguments.
    OdeSolver(const OdeMethod& method, Rhs rhs, double t0, std::span<const double> y0, double rtol,
              std::span<const double> atol, int space = 0);
    ~OdeSolver();
    OdeSolver(const OdeSolver&) = delete;
    OdeSolver& operator=(const OdeSolver&) = delete;

    /// Goes on from (t, y) as if new: the right-hand side may have changed there.
    void restart(double t, std::span<const double> y);
    void stop_at(double t);
    /// Steps of this length [s] from here on, without error control; 0 brings it back. Shorter only to
    /// end on a stop time. Throws std::invalid_argument for multistep methods.
    void fix_step(double dt);
    /// No step longer than this [s] from here on; 0 takes the limit away. For roots that a long step could
    /// cross twice.
    void limit_step(double dt);
    /// Looks for sign changes of `count` functions from here on; count = 0 ends the search. A step in which
    /// one changes its sign ends there, in the first moment of the other sign: time() and state() are those
    /// of the dense output. One that begins at zero takes its sign from the end of the first step.
    void watch(int count, Roots roots);

    /// One step, no longer than `longest` [s], which holds for this one alone: a method that may go farther
    /// grows to it again. After Outcome::failed, failure() says what SUNDIALS said and the state is that of
    /// the last good step.
    Outcome advance(double longest = std::numeric_limits<double>::infinity());

    double time() const;
    double previous_time() const;  ///< start of the last step: interpolate() holds from there
    std::span<const double> state() const;
    /// The dense output in [previous_time(), time()].
    void interpolate(double t, std::span<double> y) const;
    /// Which watched function ended the last step: its index.
    int root() const;
    const std::string& failure() const;

    struct Statistics {
        std::int64_t steps = 0, rhs_calls = 0, rejected = 0;
        double dt_min = 0.0, dt_max = 0.0;  ///< [s]
    };
    Statistics statistics() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace twinchute
