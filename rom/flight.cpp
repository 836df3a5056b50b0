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
    Flight(const Scene& scene, Course& course, const Inflation& inflation, const Motion<dimensions>& start,
           double separation, OpeningResult& result)
        : scene_(scene),
          course_(course),
          result_(result),
          separation_(separation),
          model_(make_model(inflation)),
          solver_(make_solver(opening_method(scene), scene.rom.rtol, inflation.snatch, state_of(start))) {
        course_.observer.watch([this](double t, std::span<const double> y) { return row(t, y); });
    }

    RunStatus fly(const char* event) {
        const bool inflated = scene_.parachutes.front().deploy.by == DeployBy::inflated;
        const Leg leg = inflated ? descend() : fill(event);
        course_.count(*solver_);
        if (leg != Leg::root) return course_.ending(leg, *solver_);
        course_.add_event("ground");
        result_.landing_time = solver_->time();
        return course_.landed("");
    }

private:
    enum Root { ground_root = Course::floor_root, steady_root, peak_root };

    Model make_model(const Inflation& inflation) const {
        const Parachute& chute = scene_.parachutes.front();
        Model model;
        model.atmosphere = scene_.environment.atmosphere;
        model.inflation = inflation;
        model.gravity = scene_.environment.gravity;
        model.payload_mass = scene_.payload.mass;
        model.parachute_mass = chute.mass;
        model.payload_drag_area = scene_.payload.drag_area.value_or(0.0);
        model.steady_radius = steady_radius(chute);
        if (scene_.aerodynamics.added_mass) model.added_mass = &*scene_.aerodynamics.added_mass;
        if (scene_.environment.wind) model.wind = &*scene_.environment.wind;
        return model;
    }

    std::unique_ptr<OdeSolver> make_solver(const OdeMethod& method, double rtol, double time,
                                           std::span<const double> y) {
        return std::make_unique<OdeSolver>(
            method,
            [this](double t, std::span<const double> state, std::span<double> dydt) { rhs(t, state, dydt); },
            time, y, rtol, std::vector<double>(2 * dimensions, smallest_scale * rtol));
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
        const double rho = model_.atmosphere.at(m.altitude()).density;
        HistoryRow r{};
        r.time = t;
        r.altitude = m.altitude();
        r.vertical_speed = m.velocity[dimensions - 1];
        r.speed = m.velocity.norm();
        if constexpr (dimensions >= 2) r.east = m.position[0];
        if constexpr (dimensions == 3) r.north = m.position[1];
        r.force = model_.opening_force(t, m);
        r.drag_area = model_.drag_area(t);
        r.dynamic_pressure = 0.5 * rho * model_.airspeed(m).squaredNorm();
        r.acceleration = model_.acceleration(t, m).norm();
        r.separation = separation_;
        if (model_.added_mass)
            r.added_mass =
                model_.inflation.added_mass(*model_.added_mass, model_.phase, t, rho, model_.steady_radius)
                    .value;
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
    double unsteadiness() const {
        return unsteadiness(solver_->time(), motion_of<dimensions>(solver_->state()));
    }

    /// Negative once the force has fallen well below its peak.
    double above_past_peak(double t, const Motion<dimensions>& m) const {
        return model_.opening_force(t, m) - past_peak * course_.observer.peak().value;
    }

    /// What a stage ends at besides its time.
    enum class Search { ground, steady, steady_or_peak };

    /// The right-hand side changes here: a new start from the state reached.
    void begin_stage(Phase phase, Search search) {
        const std::vector<double> y(solver_->state().begin(), solver_->state().end());
        model_.phase = phase;
        solver_->restart(solver_->time(), y);
        const int count = search == Search::ground ? 1 : search == Search::steady ? 2 : 3;
        solver_->watch(count, [this](double t, std::span<const double> state, std::span<double> g) {
            const auto motion = motion_of<dimensions>(state);
            g[ground_root] = motion.altitude() - course_.floor();
            if (g.size() > steady_root) g[steady_root] = unsteadiness(t, motion);
            if (g.size() > peak_root) g[peak_root] = above_past_peak(t, motion);
        });
        course_.observer.mark(solver_->time(), y);
    }

    /// From snatch to full open, and on.
    Leg fill(const char* event) {
        const Inflation& inflation = model_.inflation;
        const bool packed = scene_.parachutes.front().deploy.starts_packed();
        Leg leg = Leg::reached_end;
        const auto goes_on = [&] { return leg == Leg::reached_end && solver_->time() < course_.stop_time; };
        const auto to_end_of = [&](Phase phase) {
            return course_.integrate_to(*solver_, std::min(inflation.end_of(phase), course_.stop_time));
        };
        const auto begin_filling = [&] {
            if (packed) {  // the snatch force is known, from here on the peak counts
                result_.snatch_force = course_.observer.peak().value;
                course_.observer.forget_peak();
            }
            begin_stage(Phase::filling, Search::ground);
        };

        if (inflation.initial_time > 0.0) {
            begin_stage(Phase::initial, Search::ground);
            course_.add_event(event);
            course_.met(Trigger::Kind::line_stretch, solver_->time());
            leg = to_end_of(Phase::initial);
            if (goes_on()) {
                course_.add_event("end-of-initial-phase");
                begin_filling();
            }
        } else {
            begin_filling();
            course_.add_event(event);
            course_.met(Trigger::Kind::line_stretch, solver_->time());
        }
        if (goes_on()) leg = to_end_of(Phase::filling);
        if (leg != Leg::reached_end || solver_->time() < inflation.end_of(Phase::filling)) return leg;
        result_.filling_time = inflation.filling_time;
        course_.add_event("full-open");
        course_.met(Trigger::Kind::full_open, solver_->time());
        return descend();
    }

    /// From full open to the end of the run.
    Leg descend() {
        const Trigger& stop = scene_.stop;
        const bool to_peak = stop.kind == Trigger::Kind::peak_force;
        for (;;) {
            begin_stage(Phase::open, to_peak ? Search::steady_or_peak : Search::steady);
            if (solver_->time() >= course_.stop_time) return Leg::reached_end;
            const auto here = motion_of<dimensions>(solver_->state());
            if (to_peak && above_past_peak(solver_->time(), here) < 0.0) return end_after(stop.delay);
            if (!(unsteadiness() < 0.0)) {
                const Leg leg = course_.integrate_to(*solver_, course_.stop_time);
                if (leg != Leg::root || solver_->root() == ground_root) return leg;
                if (solver_->root() == peak_root) return end_after(stop.delay);
            }
            // Steady by its rate now; declared so after a second of it (see steady_descent_change).
            const double steady_since = solver_->time() + 1.0;
            begin_stage(Phase::open, Search::ground);
            const Leg leg = course_.integrate_to(*solver_, std::min(steady_since, course_.stop_time));
            if (leg != Leg::reached_end || solver_->time() < steady_since) return leg;
            if (unsteadiness() >= 0.0) continue;  // a turning point of the speed, no steady descent
            course_.add_event("steady-descent");
            result_.descent_altitude = course_.observer.rows().back().altitude;
            const bool ends_here = to_peak || stop.kind == Trigger::Kind::steady_descent;
            const double end =
                ends_here ? std::min(course_.stop_time, solver_->time() + stop.delay) : course_.stop_time;
            if (solver_->time() >= end) return leg;
            if (scene_.rom.method == automatic && is_long(end))
                change_to(descent_method(), descent_tolerance * scene_.rom.rtol);
            return course_.integrate_to(*solver_, end);
        }
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
        begin_stage(Phase::open, Search::ground);
    }

    /// The stop condition is met, the run goes on a while.
    Leg end_after(double delay) {
        const double end = std::min(course_.stop_time, solver_->time() + delay);
        begin_stage(Phase::open, Search::ground);
        return solver_->time() < end ? course_.integrate_to(*solver_, end) : Leg::reached_end;
    }

    const Scene& scene_;
    Course& course_;
    OpeningResult& result_;
    const double separation_;  // [m] of payload and parachute, from lock-up on
    Model model_;
    std::unique_ptr<OdeSolver> solver_;
};

}  // namespace

template <int dimensions>
RunStatus fly_on(const Scene& scene, Course& course, const Inflation& inflation,
                 const Motion<dimensions>& start, double separation, const char* event,
                 OpeningResult& result) {
    const auto fly = [&]<Air air>() {
        return Flight<dimensions, air>(scene, course, inflation, start, separation, result).fly(event);
    };
    if (!scene.aerodynamics.added_mass) return fly.template operator()<Air::none>();
    if (scene.aerodynamics.added_mass->momentum == AddedMassMomentum::accreting)
        return fly.template operator()<Air::accreting>();
    return fly.template operator()<Air::inertia_only>();
}

template RunStatus fly_on(const Scene&, Course&, const Inflation&, const Motion<1>&, double, const char*,
                          OpeningResult&);
template RunStatus fly_on(const Scene&, Course&, const Inflation&, const Motion<2>&, double, const char*,
                          OpeningResult&);
template RunStatus fly_on(const Scene&, Course&, const Inflation&, const Motion<3>&, double, const char*,
                          OpeningResult&);

}  // namespace twinchute::rom
