#include "rom/flight.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "rom/methods.hpp"
#include "rom/rigid_composite.hpp"

namespace twinchute::rom {
namespace {

constexpr double explicit_reach = 3.3;  // of Dormand and Prince's pair on the negative real axis
constexpr double many_steps = 100.0;    // for which another method pays

template <int dimensions, Air air>
class Flight {
    using Model = RigidComposite<dimensions, air>;

public:
    Flight(const Scene& scene, Course& course, Canopies& canopies, double time, Motion<dimensions>& motion,
           double separation, Openings& openings)
        : scene_(scene),
          course_(course),
          canopies_(canopies),
          motion_(motion),
          result_(openings.result),
          openings_(openings),
          separation_(separation),
          model_(make_model()),
          solver_(make_solver(opening_method(scene), scene.rom.rtol, time, state_of(motion))) {
        course_.observer.watch([this](double t, std::span<const double> y) { return row(t, y); });
    }

    std::optional<RunStatus> fly() {
        const std::optional<Leg> leg = follow();
        course_.count(*solver_);
        motion_ = here();
        if (refusal_.code == StatusCode::refused) return refusal_;
        if (!leg) return std::nullopt;
        if (*leg != Leg::root) return course_.ending(*leg, *solver_);
        course_.add_event("ground");
        result_.landing_time = solver_->time();
        return course_.landed("");
    }

private:
    enum class Root { ground, steady, peak, trigger };

    Model make_model() const {
        Model model;
        model.atmosphere = scene_.environment.atmosphere;
        model.canopies = &canopies_;
        model.gravity = scene_.environment.gravity;
        model.payload_mass = scene_.payload.mass;
        model.payload_drag_area = scene_.payload.drag_area.value_or(0.0);
        if (scene_.aerodynamics.added_mass) model.added_mass = &*scene_.aerodynamics.added_mass;
        if (scene_.environment.wind) model.wind = &*scene_.environment.wind;
        return model;
    }

    std::unique_ptr<OdeSolver> make_solver(const OdeMethod& method, double rtol, double time,
                                           std::span<const double> y) {
        return std::make_unique<OdeSolver>(
            method,
            [this](double t, std::span<const double> state, std::span<double> dydt) { rhs(t, state, dydt); },
            time, y, rtol, std::vector<double>(2 * dimensions, smallest_scale * rtol), dimensions);
    }

    static std::vector<double> state_of(const Motion<dimensions>& m) {
        std::vector<double> y(m.position.begin(), m.position.end());
        y.insert(y.end(), m.velocity.begin(), m.velocity.end());
        return y;
    }

    void rhs(double t, std::span<const double> y, std::span<double> dydt) const {
        const auto motion = motion_of<dimensions>(y);
        const auto acceleration = model_.acceleration(t, motion);
        for (int i = 0; i < dimensions; ++i) {
            dydt[i] = motion.velocity[i];
            dydt[dimensions + i] = acceleration[i];
        }
    }

    HistoryRow row(double t, std::span<const double> y) const {
        const auto m = motion_of<dimensions>(y);
        const auto loads = model_.loads(t, m);
        HistoryRow r{};
        r.time = t;
        r.altitude = m.altitude();
        r.vertical_speed = m.velocity[dimensions - 1];
        r.speed = m.velocity.norm();
        if constexpr (dimensions >= 2) r.east = m.position[0];
        if constexpr (dimensions == 3) r.north = m.position[1];
        r.force = model_.opening_force(loads);
        r.drag_area = loads.drag_area;
        if (has_cluster_ && r.drag_area > 0.0)
            r.canopy_force = r.force * canopies_.largest_drag_area(t) / r.drag_area;
        r.dynamic_pressure = 0.5 * loads.density * loads.airspeed.squaredNorm();
        r.acceleration = loads.acceleration.norm();
        r.separation = separation_;
        r.added_mass = loads.added_mass;
        return r;
    }

    /// Relative change per second of v sqrt(rho), v through the air, less the limit; negative once the
    /// descent is steady.
    double unsteadiness(double t, const Motion<dimensions>& m) const {
        const double z = m.altitude(), climb = m.velocity[dimensions - 1];
        const auto density = [&](double h) { return scene_.environment.atmosphere.at(h).density; };
        const double relative_density_slope = (density(z + 1.0) - density(z - 1.0)) / (2.0 * density(z));
        const Vec<dimensions> velocity = model_.airspeed(m);
        if (velocity.squaredNorm() == 0.0) return 1.0;  // at rest nothing is steady yet
        Vec<dimensions> rate = model_.acceleration(t, m);
        if constexpr (dimensions == 3)  // falling through shear changes the speed through the air, too
            rate -= climb * 0.5 * (model_.wind->at(z + 1.0) - model_.wind->at(z - 1.0));
        const double relative_rate =
            velocity.dot(rate) / velocity.squaredNorm() + 0.5 * relative_density_slope * climb;
        return std::abs(relative_rate) - steady_descent_change;
    }
    double unsteadiness() const { return unsteadiness(solver_->time(), here()); }

    Motion<dimensions> here() const { return motion_of<dimensions>(solver_->state()); }
    Situation now() const { return situation_of<dimensions>(scene_, solver_->time(), here()); }

    /// Negative once the force has fallen well below its peak.
    double above_past_peak(double t, const Motion<dimensions>& m) const {
        return model_.opening_force(model_.loads(t, m)) - past_peak * course_.observer.peak().value;
    }

    /// The right-hand side changes here: a new start from the state reached. The stage ends at its time, at
    /// the ground, at what triggers wait for, and at `sought`.
    void begin_stage(const std::vector<Root>& sought) {
        const std::vector<double> y(solver_->state().begin(), solver_->state().end());
        solver_->restart(solver_->time(), y);
        roots_ = {Root::ground};
        roots_.insert(roots_.end(), sought.begin(), sought.end());
        roots_.resize(roots_.size() + canopies_.watch_count(), Root::trigger);
        solver_->watch(static_cast<int>(roots_.size()),
                       [this](double t, std::span<const double> state, std::span<double> g) {
                           look(t, motion_of<dimensions>(state), g);
                       });
        if (canopies_.watches_pressure() != is_limited_) {
            is_limited_ = !is_limited_;
            solver_->limit_step(is_limited_ ? pressure_step : 0.0);
        }
        course_.observer.mark(solver_->time(), y);
    }

    void look(double t, const Motion<dimensions>& motion, std::span<double> g) const {
        std::size_t i = 0;
        for (; i < roots_.size() && roots_[i] != Root::trigger; ++i)
            g[i] = roots_[i] == Root::ground   ? motion.altitude() - course_.floor()
                   : roots_[i] == Root::steady ? unsteadiness(t, motion)
                                               : above_past_peak(t, motion);
        if (i == roots_.size()) return;
        for (const double left : canopies_.watch(situation_of<dimensions>(scene_, t, motion)))
            g[i++] = left;
    }

    /// From event to event, to the end of the run or to a pack that has to be left; the last leg, or nothing.
    std::optional<Leg> follow() {
        for (;;) {
            const std::vector<Occurrence> done = canopies_.advance(now());
            openings_.before_stage(done, now());
            refusal_ = openings_.check();
            if (refusal_.code == StatusCode::refused) return Leg::reached_end;
            if (!done.empty()) is_steady_ = false;
            begin_stage(sought());
            openings_.after_stage(done, solver_->time());
            if (canopies_.leaves_pack()) return std::nullopt;
            if (solver_->time() >= course_.stop_time) return Leg::reached_end;
            if (const std::optional<Leg> last = fly_stage()) return last;
        }
    }

    std::vector<Root> sought() const {
        const bool last = canopies_.is_settled();
        if (is_steady_ || !canopies_.is_quiet() || !(last || canopies_.waits_for_steady_descent())) return {};
        if (last && scene_.stop.kind == Trigger::Kind::peak_force) return {Root::steady, Root::peak};
        return {Root::steady};
    }

    /// One stage; the leg that ends the run, or nothing.
    std::optional<Leg> fly_stage() {
        const bool seeks_steady = roots_.size() > 1 && roots_[1] == Root::steady;
        const bool seeks_peak = roots_.size() > 2 && roots_[2] == Root::peak;
        if (seeks_peak && above_past_peak(solver_->time(), here()) < 0.0) return end_after_peak();
        if (!seeks_steady || !(unsteadiness() < 0.0)) {
            const Leg leg =
                course_.integrate_to(*solver_, std::min(canopies_.next_time(), course_.stop_time));
            if (leg == Leg::reached_end && goes_on()) return std::nullopt;
            if (leg != Leg::root) return leg;
            const auto root = static_cast<std::size_t>(solver_->root());
            if (roots_[root] == Root::ground) return leg;
            if (roots_[root] == Root::peak) return end_after_peak();
            if (roots_[root] == Root::trigger) {
                canopies_.met(root - (roots_.size() - canopies_.watch_count()), now());
                return std::nullopt;
            }
        }
        return verify_steady();
    }

    /// What happens at the very end of a run has happened, too.
    bool goes_on() const {
        return solver_->time() < course_.stop_time || canopies_.next_time() <= solver_->time();
    }

    /// Steady by its rate now; declared so after a second of it (see steady_descent_change).
    std::optional<Leg> verify_steady() {
        const double steady_since = solver_->time() + 1.0;
        begin_stage({});
        const double end = std::min({steady_since, canopies_.next_time(), course_.stop_time});
        const Leg leg = course_.integrate_to(*solver_, end);
        if (leg == Leg::root && roots_[static_cast<std::size_t>(solver_->root())] == Root::trigger) {
            canopies_.met(static_cast<std::size_t>(solver_->root()) - 1, now());
            return std::nullopt;
        }
        if (leg != Leg::reached_end) return leg;
        if (solver_->time() < steady_since) return goes_on() ? std::nullopt : std::optional(leg);
        if (unsteadiness() >= 0.0) return std::nullopt;  // a turning point of the speed, no steady descent
        is_steady_ = true;
        const bool last = canopies_.is_settled();
        course_.add_event("steady-descent");
        canopies_.descends_steadily(now());
        if (!last) return std::nullopt;
        result_.descent_altitude = course_.observer.rows().back().altitude;
        const Trigger& stop = scene_.stop;
        if (stop.kind == Trigger::Kind::peak_force || stop.kind == Trigger::Kind::steady_descent)
            course_.end_at(solver_->time() + stop.delay);
        if (solver_->time() >= course_.stop_time) return leg;
        if (scene_.rom.method == automatic && is_long(course_.stop_time))
            change_to(descent_method(), descent_tolerance * scene_.rom.rtol);
        return course_.integrate_to(*solver_, course_.stop_time);
    }

    /// The force is well past its peak, the run goes on for the delay.
    Leg end_after_peak() {
        course_.end_at(solver_->time() + scene_.stop.delay);
        begin_stage({});
        return solver_->time() < course_.stop_time ? course_.integrate_to(*solver_, course_.stop_time)
                                                   : Leg::reached_end;
    }

    /// Whether an explicit method would take many steps for its stability alone in a steady descent to `end`:
    /// each may last for explicit_reach v/(2 g), and v goes with the density.
    bool is_long(double end) const {
        constexpr int layers = 32;
        const auto here = motion_of<dimensions>(solver_->state());
        const double speed = -here.velocity[dimensions - 1];
        if (!(speed > 0.0)) return false;
        const auto density = [&](double z) { return scene_.environment.atmosphere.at(z).density; };
        const double layer = (here.altitude() - course_.floor()) / layers;
        const double here_density = density(here.altitude());
        double left = end - solver_->time(), steps = 0.0;
        for (int k = 0; k < layers && left > 0.0; ++k) {
            const double z = here.altitude() - (k + 0.5) * layer;
            const double v = speed * std::sqrt(here_density / density(z));
            const double duration = std::min(left, layer / v);
            steps += duration * 2.0 * scene_.environment.gravity / (explicit_reach * v);
            left -= duration;
        }
        return steps > many_steps;
    }

    void change_to(const OdeMethod& method, double rtol) {
        course_.count(*solver_);
        const std::vector<double> y(solver_->state().begin(), solver_->state().end());
        solver_ = make_solver(method, rtol, solver_->time(), y);
        begin_stage({});
    }

    const Scene& scene_;
    Course& course_;
    Canopies& canopies_;
    Motion<dimensions>& motion_;
    OpeningResult& result_;
    Openings& openings_;
    const double separation_;  // [m] of payload and parachute, from lock-up on
    Model model_;
    std::unique_ptr<OdeSolver> solver_;
    RunStatus refusal_;        // of an opening that cannot take place
    std::vector<Root> roots_;  // of the stage, in the solver's order
    const bool has_cluster_ =
        std::ranges::any_of(scene_.parachutes, [](const Parachute& p) { return p.count > 1; });
    bool is_limited_ = false;  // the length of steps
    bool is_steady_ = false;   // since the last event of a canopy
};

}  // namespace

template <int dimensions>
std::optional<RunStatus> fly_on(const Scene& scene, Course& course, Canopies& canopies, double time,
                                Motion<dimensions>& motion, double separation, Openings& openings) {
    const auto fly = [&]<Air air>() {
        return Flight<dimensions, air>(scene, course, canopies, time, motion, separation, openings).fly();
    };
    if (!scene.aerodynamics.added_mass) return fly.template operator()<Air::none>();
    if (scene.aerodynamics.added_mass->momentum == AddedMassMomentum::accreting)
        return fly.template operator()<Air::accreting>();
    return fly.template operator()<Air::inertia_only>();
}

template std::optional<RunStatus> fly_on(const Scene&, Course&, Canopies&, double, Motion<1>&, double,
                                         Openings&);
template std::optional<RunStatus> fly_on(const Scene&, Course&, Canopies&, double, Motion<2>&, double,
                                         Openings&);
template std::optional<RunStatus> fly_on(const Scene&, Course&, Canopies&, double, Motion<3>&, double,
                                         Openings&);

}  // namespace twinchute::rom
