#include "rom/run_rom.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lib/scene/line_stretch.hpp"
#include "lib/solve/opening.hpp"
#include "lib/solve/stopwatch.hpp"
#include "lib/solve/sundials.hpp"
#include "rom/fidelity.hpp"
#include "rom/observer.hpp"

namespace twinchute::rom {
namespace {

/// Below this many metres, or metres per second, the relative tolerance stops to be relative.
constexpr double smallest_scale = 1.0;

/// A descent of ten hours takes 40 000: where more are needed, something is stiffer than this method.
constexpr int most_steps = 100'000;

template <int dimensions, Air air>
class Flight {
    using Model = RigidComposite<dimensions, air>;

public:
    Flight(const Scene& scene, Run& run)
        : scene_(scene),
          run_(run),
          chute_(scene.parachutes.front()),
          density_(scene.environment.atmosphere.at(scene.release.altitude).density),
          model_(make_model()),
          solver_(
              *find_explicit_method(scene.rom.method),
              [this](double t, std::span<const double> y, std::span<double> dydt) { rhs(t, y, dydt); }, 0.0,
              initial_state(), scene.rom.rtol,
              std::vector<double>(2 * dimensions, smallest_scale * scene.rom.rtol)),
          observer_(model_, solver_) {}

    RunRecord fly() {
        RunRecord record = begin_record(scene_, "rom");
        const Stopwatch watch;
        const auto result = integrate(record);
        record.cost.wall_s = watch.wall();
        record.cost.cpu_s = watch.cpu();
        const auto statistics = solver_.statistics();
        record.cost.steps = statistics.steps;
        record.cost.rhs_calls = statistics.rhs_calls;
        record.cost.rejected_steps = statistics.rejected;
        record.cost.dt_min_s = statistics.dt_min;
        record.cost.dt_max_s = statistics.dt_max;
        add_metrics(record, result);
        add_channels(record);
        add_left_out(record);
        add_opening_warnings(record, scene_, model_.inflation, release_airspeed(scene_).norm(), density_);
        add_scene_warnings(record, scene_);
        return record;
    }

private:
    enum Root { ground_root, steady_root };

    Model make_model() const {
        Model model;
        model.atmosphere = scene_.environment.atmosphere;
        model.inflation = make_inflation(chute_, 0.0, release_airspeed(scene_).norm(), density_);
        model.gravity = scene_.environment.gravity;
        model.payload_mass = scene_.payload.mass;
        model.parachute_mass = chute_.mass;
        model.payload_drag_area = scene_.payload.drag_area.value_or(0.0);
        model.steady_radius = steady_radius(chute_);
        if (scene_.aerodynamics.added_mass) model.added_mass = &*scene_.aerodynamics.added_mass;
        if (scene_.environment.wind) model.wind = &*scene_.environment.wind;
        return model;
    }

    std::vector<double> initial_state() const {
        const Release& release = scene_.release;
        const double down = release.speed * std::sin(release.path_angle);
        if constexpr (dimensions == 1) return {release.altitude, -down};
        if constexpr (dimensions == 2)
            return {0.0, release.altitude, release.speed * std::cos(release.path_angle), -down};
        const Vec3 velocity = velocity_over_ground(release);
        return {0.0, 0.0, release.altitude, velocity.x(), velocity.y(), velocity.z()};
    }

    void rhs(double t, std::span<const double> y, std::span<double> dydt) const {
        const auto motion = motion_of<dimensions>(y);
        const auto acceleration = model_.acceleration(t, motion);
        for (int i = 0; i < dimensions; ++i) {
            dydt[i] = motion.velocity[i];
            dydt[dimensions + i] = acceleration[i];
        }
    }

    /// Relative change per second of v sqrt(rho), v through the air, less the limit; negative once the
    /// descent is steady.
    double unsteadiness(double t, const Motion<dimensions>& m) const {
        const double z = m.altitude(), climb = m.velocity[dimensions - 1];
        const auto density = [&](double h) { return scene_.environment.atmosphere.at(h).density; };
        const double relative_density_slope = (density(z + 1.0) - density(z - 1.0)) / (2.0 * density(z));
        const Vec<dimensions> velocity = model_.airspeed(m);
        Vec<dimensions> rate = model_.acceleration(t, m);
        if constexpr (dimensions == 3)  // falling through shear changes the speed through the air, too
            rate -= climb * 0.5 * (model_.wind->at(z + 1.0) - model_.wind->at(z - 1.0));
        const double relative_rate =
            velocity.dot(rate) / velocity.squaredNorm() + 0.5 * relative_density_slope * climb;
        return std::abs(relative_rate) - steady_descent_change;
    }

    void watch(bool steady) {
        solver_.watch(steady ? 2 : 1, [this](double t, std::span<const double> y, std::span<double> g) {
            const auto motion = motion_of<dimensions>(y);
            g[ground_root] = motion.altitude() - scene_.environment.ground;
            if (g.size() > 1) g[steady_root] = unsteadiness(t, motion);
        });
    }

    /// Steps to `end`; says why it stopped before, if it did.
    enum class Leg { reached_end, ground, steady, failed, not_finite, interrupted, too_many_steps };
    Leg integrate_to(double end) {
        solver_.stop_at(end);
        for (;;) {
            if (run_.stop.stop_requested()) return Leg::interrupted;
            if (++steps_ > most_steps) return Leg::too_many_steps;
            const auto outcome = solver_.advance();
            if (outcome == ErkSolver::Outcome::failed) return Leg::failed;
            observer_.step();
            if (!observer_.is_finite()) return Leg::not_finite;
            if (outcome == ErkSolver::Outcome::reached_stop) return Leg::reached_end;
            if (outcome == ErkSolver::Outcome::found_root)
                return solver_.root() == steady_root ? Leg::steady : Leg::ground;
        }
    }

    /// The right-hand side changes here: a new start from the state reached.
    void begin_stage(Phase phase, bool search_steady) {
        const std::vector<double> y(solver_.state().begin(), solver_.state().end());
        model_.phase = phase;
        solver_.restart(solver_.time(), y);
        watch(search_steady);
        observer_.mark(solver_.time());
    }

    void add_event(RunRecord& record, const char* name) const {
        const HistoryRow& r = observer_.rows().back();
        record.events.push_back({name, r.time, r.altitude, r.speed});
    }

    OpeningResult integrate(RunRecord& record) {
        OpeningResult result;
        const Inflation& inflation = model_.inflation;
        const Trigger& stop = scene_.stop;
        const double stop_time = stop.kind == Trigger::Kind::time ? stop.value + stop.delay : longest_flight;
        std::optional<double> steady_since;
        Leg leg = Leg::reached_end;

        begin_stage(inflation.initial_time > 0.0 ? Phase::initial : Phase::filling, false);
        add_event(record, "line-stretch");
        if (model_.phase == Phase::initial) {
            leg = integrate_to(std::min(inflation.end_of(Phase::initial), stop_time));
            if (leg == Leg::reached_end && solver_.time() < stop_time) {
                add_event(record, "end-of-initial-phase");
                begin_stage(Phase::filling, false);
            }
        }
        if (leg == Leg::reached_end && solver_.time() < stop_time)
            leg = integrate_to(std::min(inflation.end_of(Phase::filling), stop_time));
        if (leg == Leg::reached_end && solver_.time() >= inflation.end_of(Phase::filling)) {
            result.filling_time = inflation.filling_time;
            add_event(record, "full-open");
            begin_stage(Phase::open, true);
            const auto here = motion_of<dimensions>(solver_.state());
            if (solver_.time() < stop_time)
                leg = unsteadiness(solver_.time(), here) < 0.0 ? Leg::steady : integrate_to(stop_time);
            if (leg == Leg::steady) {
                // Steady by its rate now; declared so after a second of it (see steady_descent_change).
                steady_since = solver_.time() + 1.0;
                begin_stage(Phase::open, false);
                leg = integrate_to(std::min(*steady_since, stop_time));
                if (leg == Leg::reached_end && solver_.time() >= *steady_since) {
                    add_event(record, "steady-descent");
                    result.descent_altitude = observer_.rows().back().altitude;
                    const bool ends_here = stop.kind == Trigger::Kind::steady_descent;
                    const double end =
                        ends_here ? std::min(stop_time, solver_.time() + stop.delay) : stop_time;
                    if (solver_.time() < end) leg = integrate_to(end);
                }
            }
        }
        finish(record, result, leg, stop_time);
        return result;
    }

    void finish(RunRecord& record, OpeningResult& result, Leg leg, double stop_time) const {
        const HistoryRow& last = observer_.rows().back();
        const Trigger& stop = scene_.stop;
        switch (leg) {
            case Leg::reached_end:
                if (stop.kind == Trigger::Kind::time || last.time < stop_time)
                    record.status = {StatusCode::completed, "stop condition met"};
                else
                    record.status = {
                        StatusCode::time_limit,
                        fmt::format("stop condition not met within {:g} s of flight", stop_time)};
                break;
            case Leg::ground:
                add_event(record, "ground");
                result.landing_time = last.time;
                record.status =
                    stop.kind == Trigger::Kind::ground
                        ? RunStatus{StatusCode::completed, "ground reached"}
                        : RunStatus{StatusCode::stopped_by_event, "ground reached before the stop condition"};
                break;
            case Leg::not_finite:
                record.status = {StatusCode::not_finite,
                                 fmt::format("force or acceleration after t = {:.6g} s", last.time)};
                break;
            case Leg::too_many_steps:
                record.status = {StatusCode::step_limit,
                                 fmt::format("more than {} steps by t = {:.6g} s", most_steps, last.time)};
                break;
            case Leg::interrupted:
                record.status = {StatusCode::interrupted, "stopped on request"};
                break;
            case Leg::steady:  // handled by the caller
            case Leg::failed:
                record.status = {StatusCode::solver_failed, solver_.failure()};
                break;
        }
        result.snatch_speed = release_airspeed(scene_).norm();
        result.payload_snatch_speed = result.snatch_speed;
        result.snatch_density = density_;
        result.max_force = observer_.peak().value;
        result.peak_force = result.max_force;
        result.peak_time = observer_.peak().at;
        const HistoryRow& top = observer_.row_near(result.peak_time);
        record.events.push_back({"peak-force", result.peak_time, top.altitude, top.speed});
        std::ranges::stable_sort(record.events, {}, &Event::time);
        if (result.filling_time) result.impulse = observer_.impulse_until(*result.filling_time);
        result.max_deceleration = observer_.largest_deceleration();
        if (result.descent_altitude)
            result.descent_rate = observer_.altitude_at(last.time - 1.0) - last.altitude;
        result.end_position = place(last);
    }

    /// East and north of the release [m] and altitude [m].
    Vec3 place(const HistoryRow& r) const {
        if constexpr (dimensions == 3) return {r.east, r.north, r.altitude};
        return r.east * heading_direction(scene_.release) + r.altitude * Vec3::UnitZ();
    }

    void add_metrics(RunRecord& record, const OpeningResult& result) const {
        const bool known_fill = chute_.fill_time.model->name == "given";
        const Metric filling{
            "", 0.0, Standing::input,
            known_fill ? std::string("given in the scene")
                       : fmt::format("prescribed: n = {:g} and the snatch speed", chute_.fill_time.n)};
        const Metric descent{"", 0.0, Standing::mixed,
                             "(C_D S)_0 and mass are inputs; the balance is the result"};
        add_opening_metrics(record, scene_, result, filling, descent);
        if (record.status.code == StatusCode::completed && !result.descent_rate &&
            scene_.stop.kind == Trigger::Kind::time)
            record.warnings.push_back({"no descent rate", "the run ended before the descent was steady",
                                       "set stop.time later, or stop.at = \"steady-descent\""});
    }

    void add_channels(RunRecord& record) const {
        const auto& rows = observer_.rows();
        const auto channel = [&](const char* name, const char* unit, auto&& value) {
            Channel c{name, unit, {}};
            c.values.reserve(rows.size());
            for (const HistoryRow& r : rows)
                c.values.push_back(value(r));
            record.channels.push_back(std::move(c));
        };
        channel("time", "s", [](const HistoryRow& r) { return r.time; });
        channel("altitude", "m", [](const HistoryRow& r) { return r.altitude; });
        if constexpr (dimensions >= 2) {
            channel("east", "m", [this](const HistoryRow& r) { return place(r).x(); });
            channel("north", "m", [this](const HistoryRow& r) { return place(r).y(); });
        }
        channel("speed", "m/s", [](const HistoryRow& r) { return r.speed; });
        channel("vertical_speed", "m/s", [](const HistoryRow& r) { return r.vertical_speed; });
        channel("acceleration", "m/s^2", [](const HistoryRow& r) { return r.acceleration; });
        channel("force", "N", [](const HistoryRow& r) { return r.force; });
        channel("drag_area", "m^2", [](const HistoryRow& r) { return r.drag_area; });
        channel("dynamic_pressure", "Pa", [](const HistoryRow& r) { return r.dynamic_pressure; });
        if constexpr (air != Air::none)
            channel("added_mass", "kg", [](const HistoryRow& r) { return r.added_mass; });
    }

    void add_left_out(RunRecord& record) const {
        const auto out = [&](const char* what, const char* why) { record.left_out.push_back({what, why}); };
        if constexpr (dimensions == 1)
            out("horizontal motion", "the release is straight down and the air is still");
        if constexpr (dimensions == 2) out("motion across the release plane", "the air is still");
        if constexpr (dimensions != 3) out("wind", "environment.wind is absent");
        out("second body", "the scene starts at line stretch");
        out("canopy structure", "this model moves payload and parachute as one rigid body");
        if (scene_.aerodynamics.line_drag) out("line drag", "this model has no lines; the full model has");
        if (scene_.aerodynamics.breathing_damping) out("breathing damping", "this model has no canopy shape");
        if constexpr (air == Air::none) out("added mass", "aerodynamics.added_mass is absent");
        if (!scene_.payload.drag_area) out("payload drag", "payload.drag_area is absent");
    }

    const Scene& scene_;
    Run& run_;
    const Parachute& chute_;
    const double density_;  // [kg/m^3] at release
    Model model_;
    ErkSolver solver_;
    Observer<Model, dimensions> observer_;
    int steps_ = 0;
};

template <int dimensions>
RunRecord fly(const Scene& scene, Run& run) {
    if (!scene.aerodynamics.added_mass) return Flight<dimensions, Air::none>(scene, run).fly();
    switch (scene.aerodynamics.added_mass->momentum) {
        case AddedMassMomentum::accreting:
            return Flight<dimensions, Air::accreting>(scene, run).fly();
        case AddedMassMomentum::inertia_only:
            break;
    }
    return Flight<dimensions, Air::inertia_only>(scene, run).fly();
}

}  // namespace

RunRecord run_rom(const Scene& scene, Run& run) {
    if (scene.environment.wind) return fly<3>(scene, run);
    // A path within 1e-9 rad of the vertical has no horizontal part that anyone could measure.
    const bool vertical = scene.release.speed == 0.0 || std::abs(std::cos(scene.release.path_angle)) < 1e-9;
    return vertical ? fly<1>(scene, run) : fly<2>(scene, run);
}

const Fidelity& rom_fidelity() {
    static constexpr Fidelity row{"rom", "reduced-order model", &run_rom,
                                  [](const Scene&) { return std::vector<std::string>{}; }};
    return row;
}

}  // namespace twinchute::rom
