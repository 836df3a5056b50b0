#include "rom/flight.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "lib/scene/line_stretch.hpp"
#include "rom/canopy_force.hpp"
#include "rom/methods.hpp"
#include "rom/rigid_composite.hpp"

namespace twinchute::rom {
namespace {

constexpr double explicit_reach = 3.3;  // of Dormand and Prince's pair on the negative real axis
constexpr double many_steps = 100.0;    // for which another method pays

/// Remainder [-] of a departure from the steady rate, over a window in which it decays to exp(-x) of its
/// first value, x = T/tau: in the mean, and from the mean of the first half to that of the second.
double mean_of_decay(double x) {
    return -std::expm1(-x) / x;
}
double drift_of_decay(double x) {
    return 2.0 / x * std::expm1(-0.5 * x) * std::expm1(-0.5 * x);
}

template <int dimensions>
class Flight {
    using Model = RigidComposite<dimensions>;

public:
    Flight(const Scene& scene, RunContext& context, OpeningSequence& sequence, double time,
           Motion<dimensions>& motion, double separation, Openings& openings)
        : scene_(scene),
          context_(context),
          sequence_(sequence),
          motion_(motion),
          result_(openings.result),
          openings_(openings),
          separation_(separation),
          model_(make_model()),
          solver_(make_solver(opening_method(scene), scene.rom.rtol, time, state_of(motion))) {
        context_.observer.watch([this](double t, std::span<const double> y) { return row(t, y); });
    }

    std::optional<RunStatus> fly() {
        const std::optional<IntegrationSegment> segment = follow();
        note_last_window();
        note_bulbs();
        context_.count(*solver_);
        motion_ = here();
        if (refusal_.code == StatusCode::refused) return refusal_;
        if (!segment) return std::nullopt;
        if (*segment != IntegrationSegment::root) return context_.ending(*segment, *solver_);
        context_.add_event("ground");
        result_.landing_time = solver_->time();
        return context_.landed("");
    }

private:
    enum class Root { ground, steady, peak, bulb, trigger };

    /// A canopy that fills by itself; its bulb's radius and rate stand behind the motion in the state.
    struct Bulb {
        enum class State {
            waits,  ///< initial phase, or held by its reefing line
            grows,  ///< to its limit, or back to where it began
            squids  ///< held where it began: the fabric lets out all that the mouth takes in
        };
        std::size_t canopy;  ///< of OpeningSequence::all()
        double limit;        ///< [-] radius of the full or reefed canopy
        State state;
    };
    /// [-] below its initial radius a bulb counts as fallen back; growth by less than e in a thousand
    /// diameters is none.
    static constexpr double fallen_back = 0.99, least_growth = 1e-3;

    Model make_model() const {
        Model model;
        model.atmosphere = scene_.environment.atmosphere;
        model.canopies = &sequence_;
        model.by_mach = sequence_.go_by_mach();
        model.gravity = scene_.environment.gravity;
        model.payload_mass = scene_.payload.mass;
        model.payload_drag_area = scene_.payload.drag_area.value_or(0.0);
        if (scene_.aerodynamics.added_mass) model.added_mass = &*scene_.aerodynamics.added_mass;
        if (scene_.environment.wind) model.wind = &*scene_.environment.wind;
        return model;
    }

    std::unique_ptr<OdeSolver> make_solver(const OdeMethod& method, double rtol, double time,
                                           std::span<const double> y) {
        if (!bulbs_.empty()) return make_filling_solver(method, rtol, time, y);
        return std::make_unique<OdeSolver>(
            method,
            [this](double t, std::span<const double> state, std::span<double> dydt) { rhs(t, state, dydt); },
            time, y, rtol, std::vector<double>(2 * dimensions, smallest_scale * rtol), dimensions);
    }

    std::unique_ptr<OdeSolver> make_filling_solver(const OdeMethod& method, double rtol, double time,
                                                   std::span<const double> y) {
        std::vector<double> atol(2 * dimensions, smallest_scale * rtol);
        for (const Bulb& bulb : bulbs_) {
            const FillingCanopy& canopy = *sequence_.all()[bulb.canopy].filling;
            const double radius = canopy.initial_radius();
            const double rate = radius * now_at(time, y).airspeed / canopy.sizes().nominal_diameter;
            atol.insert(atol.end(), {rtol * radius, rtol * rate});
        }
        return std::make_unique<OdeSolver>(
            method,
            [this](double t, std::span<const double> state, std::span<double> dydt) {
                filling_rhs(t, state, dydt);
            },
            time, y, rtol, atol);
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

    FillingMotion bulb_motion(std::size_t i, std::span<const double> y) const {
        return {y[2 * dimensions + 2 * i], y[2 * dimensions + 2 * i + 1]};
    }

    /// Motion of one bulb from the state: without inertia its rate follows from the balance of its air.
    struct FilledBulb {
        FillingMotion motion;
        FillingLoads loads;
        Filled filled;  ///< of one canopy
    };
    FilledBulb filling(std::size_t i, std::span<const double> y, const FillingAir& flow) const {
        const FillingCanopy& canopy = *sequence_.all()[bulbs_[i].canopy].filling;
        FilledBulb one{bulb_motion(i, y), {}, {}};
        if (bulbs_[i].state != Bulb::State::grows)
            one.motion.rate = 0.0;
        else if (!canopy.filling().model->acceleration)
            one.motion.rate = canopy.balanced_rate(one.motion.radius, flow);
        one.loads = canopy.loads(one.motion, flow);
        if (flow.speed > 0.0)
            one.filled.drag_area = one.loads.drag / (0.5 * flow.density * flow.speed * flow.speed);
        if (model_.added_mass) {
            constexpr double apparent = 0.375;  // over the air within (paper, Eq. 18)
            one.filled.added_mass = (1.0 + apparent) * flow.density * one.loads.volume;
            one.filled.capture = apparent * flow.density * std::max(0.0, one.loads.volume_rate);
        }
        return one;
    }
    FillingAir filling_air(const Motion<dimensions>& motion) const {
        return {scene_.environment.atmosphere.at(motion.altitude()).density,
                model_.canopy_airspeed(motion, model_.airspeed(motion)).norm()};
    }
    /// Sum over all; each by itself is in inside_ then.
    Filled all_filled(std::span<const double> y, const FillingAir& flow) const {
        Filled sum;
        inside_.resize(bulbs_.size());
        for (std::size_t i = 0; i < bulbs_.size(); ++i) {
            inside_[i] = filling(i, y, flow);
            const Filled& one = inside_[i].filled;
            const int count = sequence_.all()[bulbs_[i].canopy].count;
            sum.drag_area += count * one.drag_area;
            sum.added_mass += count * one.added_mass;
            sum.capture += count * one.capture;
        }
        return sum;
    }

    typename Model::Loads loads(double t, std::span<const double> y) const {
        const auto motion = motion_of<dimensions>(y);
        return bulbs_.empty() ? model_.loads(t, motion)
                              : model_.loads(t, motion, all_filled(y, filling_air(motion)));
    }

    /// The trajectory, and beside it the bulbs.
    void filling_rhs(double t, std::span<const double> y, std::span<double> dydt) const {
        const auto motion = motion_of<dimensions>(y);
        const FillingAir flow = filling_air(motion);
        const auto loads = model_.loads(t, motion, all_filled(y, flow));
        for (int i = 0; i < dimensions; ++i) {
            dydt[i] = motion.velocity[i];
            dydt[dimensions + i] = loads.acceleration[i];
        }
        const Vec<dimensions> velocity = model_.canopy_airspeed(motion, loads.airspeed);
        Vec<dimensions> ahead = Vec<dimensions>::Zero();
        if (flow.speed > 0.0) ahead = velocity / flow.speed;
        const double slowing = loads.acceleration.dot(ahead),
                     weight = -model_.gravity * ahead[dimensions - 1];
        for (std::size_t i = 0; i < bulbs_.size(); ++i) {
            const Canopy& c = sequence_.all()[bulbs_[i].canopy];
            const FilledBulb& one = inside_[i];
            // T - D of this canopy: inertia of fabric and air, and what joins, less the fabric's weight.
            const double excess = (c.chute->mass + one.filled.added_mass) * slowing - c.chute->mass * weight +
                                  one.filled.capture * flow.speed;
            const bool moves = bulbs_[i].state == Bulb::State::grows;
            double* const rates = &dydt[2 * dimensions + 2 * i];
            rates[0] = moves ? one.motion.rate : 0.0;
            rates[1] = moves && c.filling->filling().model->acceleration
                           ? c.filling->acceleration(one.motion, flow, one.loads, excess)
                           : 0.0;
        }
    }

    HistoryRow row(double t, std::span<const double> y) const {
        const auto m = motion_of<dimensions>(y);
        const auto loads = this->loads(t, y);
        HistoryRow r{};
        r.time = t;
        r.altitude = m.altitude();
        r.vertical_speed = m.velocity[dimensions - 1];
        r.speed = m.velocity.norm();
        if constexpr (dimensions >= 2) r.east = m.position[0];
        if constexpr (dimensions == 3) r.north = m.position[1];
        r.force = model_.opening_force(loads);
        r.drag_area = loads.drag_area;
        if (several_) {
            const LargestPull pull = largest_pull<dimensions>(
                sequence_,
                CanopyAir<dimensions>{t, loads.density, scene_.environment.gravity,
                                      model_.mach_number(m, loads.airspeed), model_.added_mass,
                                      model_.accretes(), model_.canopy_airspeed(m, loads.airspeed),
                                      loads.acceleration},
                [&](std::size_t canopy) -> const Filled* {
                    const auto bulb = std::ranges::find(bulbs_, canopy, &Bulb::canopy);
                    return bulb == bulbs_.end()
                               ? nullptr
                               : &inside_[static_cast<std::size_t>(bulb - bulbs_.begin())].filled;
                });
            r.canopy_force = pull.force;
            r.canopy = pull.canopy;
            r.canopies = pull.canopies;
        }
        r.dynamic_pressure = 0.5 * loads.density * loads.airspeed.squaredNorm();
        r.acceleration = loads.acceleration.norm();
        r.specific_force =
            (loads.acceleration + model_.gravity * Vec<dimensions>::Unit(dimensions - 1)).norm();
        r.separation = separation_;
        r.added_mass = loads.added_mass;
        if (predicted_) add_air_within(r);
        return r;
    }

    /// Numbers of the first canopy whose filling is predicted.
    void add_air_within(HistoryRow& r) const {
        if (!bulbs_.empty()) {
            const FillingLoads& now = inside_.front().loads;
            r.volume = now.volume, r.mouth_area = now.mouth_area, r.inflow = now.inflow;
            return;
        }
        const auto open =
            std::ranges::find_if(sequence_.all(), [](const Canopy& c) { return c.filling && c.is_out(); });
        if (open == sequence_.all().end()) return;
        const double D0 = open->chute->nominal_diameter;
        const FillingShape shape = open->filling->family().at(open->filling->steady_radius());
        r.volume = shape.volume * D0 * D0 * D0, r.mouth_area = shape.mouth_area * D0 * D0;
    }

    /// How a point mass with constant drag area falls; see lib/solve/steady_descent.hpp for the terms.
    struct Fall {
        double sink = 0.0;              ///< w [m/s]
        double added_mass_ratio = 0.0;  ///< mu [-]
        double departure = 1.0;  ///< [-] |ln(w/w_e)|, of slip and of drag against weight, each for itself
    };
    /// Without slip 1/2 rho C_D S w^2 = W; so 2 ln(u/u_b) = ln(w/V) + ln(D/W), D/W = 1 + (1 + mu) a/g with a
    /// upward. Both terms fade at the same rate and may have opposite signs: where the speed has a turning
    /// point they cancel, and do not stay so.
    Fall fall(double t, std::span<const double> y) const {
        const auto m = motion_of<dimensions>(y);
        const auto loads = this->loads(t, y);
        const Vec<dimensions> velocity = model_.canopy_airspeed(m, loads.airspeed);
        const double sink = -velocity[dimensions - 1];
        Fall now{sink, loads.added_mass / (model_.hung_mass() + sequence_.out_mass()), 1.0};
        const double drag =
            1.0 + (1.0 + now.added_mass_ratio) * loads.acceleration[dimensions - 1] / model_.gravity;
        if (!(sink > 0.0) || !(drag > 0.0)) return now;
        const double lag = density_lag(scene_.environment, m.altitude(), sink, now.added_mass_ratio);
        now.departure =
            0.5 * std::abs(std::log(sink / velocity.norm())) + std::abs(0.5 * std::log(drag) - lag);
        return now;
    }
    Fall fall() const { return fall(solver_->time(), solver_->state()); }

    /// The departure at the beginning of a window less the one from which on the mean over it is steady;
    /// negative once such a window may begin.
    double unsteadiness(double t, std::span<const double> y) const {
        const Fall now = fall(t, y);
        const double lasts =
            2.0 * descent_window(1.0, now.added_mass_ratio, 1.0) / (1.0 + now.added_mass_ratio);
        return now.departure - std::min(steady_descent_remaining / mean_of_decay(lasts),
                                        steady_descent_change / drift_of_decay(lasts));
    }
    double unsteadiness() const { return unsteadiness(solver_->time(), solver_->state()); }

    /// The window that ends now, where the drag area has not changed in it.
    std::optional<DescentWindow> window() const {
        const Fall now = fall();
        const double end = solver_->time(), altitude = here().altitude();
        const double length = descent_window(std::max(0.0, now.sink), now.added_mass_ratio, model_.gravity);
        if (!(length > 0.0) || end - length < open_since_) return std::nullopt;
        const auto u = [&](double rate, double z) {
            return rate * std::sqrt(scene_.environment.atmosphere.at(z).density);
        };
        const double begin = context_.observer.altitude_at(end - length),
                     middle = context_.observer.altitude_at(end - 0.5 * length);
        const double first = u(2.0 * (begin - middle) / length, 0.5 * (begin + middle)),
                     second = u(2.0 * (middle - altitude) / length, 0.5 * (middle + altitude));
        const double last = u(-here().velocity[dimensions - 1], altitude);
        double low = last, high = last;
        const auto& rows = context_.observer.rows();
        for (auto row = rows.rbegin(); row != rows.rend() && row->time >= end - length; ++row) {
            low = std::min(low, u(-row->vertical_speed, row->altitude));
            high = std::max(high, u(-row->vertical_speed, row->altitude));
        }
        DescentWindow window{end - length, end, (begin - altitude) / length, 0.0, second / first - 1.0, 0.0};
        window.amplitude = (high - low) / (first + second);
        window.remaining = std::abs(std::log(0.5 * (first + second) / last)) + now.departure;
        if (!std::isfinite(window.remaining)) return std::nullopt;
        if (window.is_steady())
            window.remaining += change_below(scene_.environment, altitude, now.sink, now.added_mass_ratio);
        return window;
    }

    /// The window at the end of the run: a ground that comes first does not make it less steady.
    void note_last_window() {
        if (!is_carried()) {  // it lands by itself
            result_.descent.reset();
            result_.descent_altitude.reset();
            return;
        }
        result_.last_window = window();
        if (!result_.last_window || !result_.last_window->is_steady() || !sequence_.is_settled()) return;
        result_.descent = result_.last_window;
        if (!result_.descent_altitude) result_.descent_altitude = here().altitude();
    }

    Motion<dimensions> here() const { return motion_of<dimensions>(solver_->state()); }
    FlightState now() const { return now_at(solver_->time(), solver_->state()); }
    FlightState now_at(double t, std::span<const double> y) const {
        return flight_state_of<dimensions>(scene_, t, motion_of<dimensions>(y));
    }

    /// Negative once the force has fallen well below its peak.
    double above_past_peak(double t, std::span<const double> y) const {
        return model_.opening_force(loads(t, y)) - past_peak * context_.observer.peak().value;
    }

    /// The right-hand side changes here: a new start from the state reached. The stage ends at its time, at
    /// the ground, at what triggers wait for, and at `sought`.
    void begin_stage(const std::vector<Root>& sought) {
        const std::vector<double> y(solver_->state().begin(), solver_->state().end());
        solver_->restart(solver_->time(), y);
        roots_ = {Root::ground};
        roots_.insert(roots_.end(), sought.begin(), sought.end());
        watched_bulbs_.clear();
        for (std::size_t i = 0; i < bulbs_.size(); ++i)
            if (bulbs_[i].state != Bulb::State::waits) watched_bulbs_.push_back(i);
        roots_.resize(roots_.size() + watched_bulbs_.size(), Root::bulb);
        roots_.resize(roots_.size() + sequence_.watch_count(), Root::trigger);
        solver_->watch(static_cast<int>(roots_.size()), [this](double t, std::span<const double> state,
                                                               std::span<double> g) { look(t, state, g); });
        if (sequence_.watches_pressure() != is_limited_) {
            is_limited_ = !is_limited_;
            solver_->limit_step(is_limited_ ? pressure_step : 0.0);
        }
        context_.observer.mark(solver_->time(), y);
    }

    void look(double t, std::span<const double> y, std::span<double> g) const {
        const auto motion = motion_of<dimensions>(y);
        std::size_t i = 0, bulb = 0;
        for (; i < roots_.size() && roots_[i] != Root::trigger; ++i)
            g[i] = roots_[i] == Root::ground   ? motion.altitude() - context_.floor()
                   : roots_[i] == Root::steady ? unsteadiness(t, y)
                   : roots_[i] == Root::bulb   ? until_turn(watched_bulbs_[bulb++], y)
                                               : above_past_peak(t, y);
        if (i == roots_.size()) return;
        for (const double left : sequence_.watch(flight_state_of<dimensions>(scene_, t, motion)))
            g[i++] = left;
    }

    /// [-] Growth of a bulb on the slow manifold over one diameter of travel, over its radius.
    static double growth(const FillingCanopy& canopy, double radius, const FillingAir& flow) {
        if (!canopy.filling().model->has_balance) return 1.0;
        if (!(flow.speed > 0.0)) return 0.0;
        return canopy.balanced_rate(radius, flow) * canopy.sizes().nominal_diameter / (flow.speed * radius);
    }

    /// Falls to zero where a bulb is full or has fallen back, or where one that squids begins to grow.
    double until_turn(std::size_t i, std::span<const double> y) const {
        const FillingCanopy& canopy = *sequence_.all()[bulbs_[i].canopy].filling;
        const double a = bulb_motion(i, y).radius, first = canopy.initial_radius();
        if (bulbs_[i].state == Bulb::State::squids)
            return least_growth - growth(canopy, first, filling_air(motion_of<dimensions>(y)));
        const double limit = bulbs_[i].limit;
        return (limit - a) * (a - fallen_back * first) / (limit * limit);
    }

    /// A bulb has come to one of these.
    void turn(std::size_t i) {
        Bulb& bulb = bulbs_[i];
        const double a = bulb_motion(i, solver_->state()).radius;
        note_bulbs();
        if (bulb.state == Bulb::State::squids)
            bulb.state = Bulb::State::waits;  // arrange_bulbs() lets it grow
        else if (2.0 * a > bulb.limit)
            fill_up(bulb);
        else
            bulb.state = Bulb::State::squids;
    }

    void fill_up(const Bulb& bulb) {
        const double full = sequence_.all()[bulb.canopy].filling->steady_radius();
        sequence_.fills_up(bulb.canopy, solver_->time(), bulb.limit < full);
    }

    /// The sequence knows how far each has come. One that grows no more, before it is full, squids too.
    void note_bulbs() {
        const std::span<const double> y = solver_->state();
        for (std::size_t i = 0; i < bulbs_.size(); ++i) {
            const FillingAir flow = filling_air(motion_of<dimensions>(y));
            const FilledBulb one = filling(i, y, flow);
            const FillingCanopy& canopy = *sequence_.all()[bulbs_[i].canopy].filling;
            const bool squids = bulbs_[i].state == Bulb::State::squids ||
                                (bulbs_[i].state == Bulb::State::grows &&
                                 growth(canopy, one.motion.radius, flow) < least_growth);
            sequence_.grown(bulbs_[i].canopy, one.motion, squids, one.filled.drag_area);
        }
    }

    /// Which canopies fill by themselves from here on, and how; the state grows or shrinks by them.
    void arrange_bulbs() {
        if (!predicted_) return;
        const FillingAir flow = filling_air(here());
        std::vector<Bulb> next;
        std::vector<double> y(solver_->state().begin(), solver_->state().begin() + 2 * dimensions);
        for (std::size_t k = 0; k < sequence_.all().size(); ++k) {
            const Canopy& c = sequence_.all()[k];
            if (!c.fills_itself()) continue;
            const auto before = std::ranges::find(bulbs_, k, &Bulb::canopy);
            FillingMotion motion = c.bulb;
            if (before != bulbs_.end())
                motion = bulb_motion(static_cast<std::size_t>(before - bulbs_.begin()), solver_->state());
            if (!(motion.radius > 0.0)) motion.radius = c.filling->initial_radius();
            const double limit =
                c.is_reefed() ? std::max(c.filling->reefed_radius(reefing_line_length(*c.chute, c.stage)),
                                         c.filling->initial_radius())
                              : c.filling->steady_radius();
            Bulb bulb{k, limit, before != bulbs_.end() ? before->state : Bulb::State::waits};
            if (c.phase != Phase::filling) {
                bulb.state = Bulb::State::waits;
                motion.rate = 0.0;
            } else if (bulb.state == Bulb::State::waits) {
                const bool grows = growth(*c.filling, motion.radius, flow) >= least_growth ||
                                   motion.radius > c.filling->initial_radius();
                bulb.state = grows ? Bulb::State::grows : Bulb::State::squids;
                motion = grows ? c.filling->start(motion.radius, flow) : FillingMotion{motion.radius, 0.0};
            }
            if (c.phase == Phase::filling && motion.radius >= limit) {  // its line is taut from the start
                fill_up(bulb);
                bulb.state = Bulb::State::waits;
                motion.rate = 0.0;
            }
            if (bulb.state == Bulb::State::squids) motion = {c.filling->initial_radius(), 0.0};
            next.push_back(bulb);
            y.insert(y.end(), {motion.radius, motion.rate});
        }
        if (next.empty() && bulbs_.empty()) return;
        const bool changes = next.size() != bulbs_.size();
        bulbs_ = std::move(next);
        if (!changes) return solver_->restart(solver_->time(), y);
        context_.count(*solver_);
        const double time = solver_->time();
        takes_long_steps_ = false;
        solver_ = make_solver(bulbs_.empty() ? opening_method(scene_) : filling_method(scene_),
                              scene_.rom.rtol, time, y);
        is_limited_ = false;
    }

    /// From event to event, to the end of the run or to a pack that has to be left; the last segment, or
    /// nothing.
    std::optional<IntegrationSegment> follow() {
        for (;;) {
            const std::vector<OpeningEvent> done = sequence_.advance(now());
            openings_.before_stage(done, now());
            refusal_ = openings_.check();
            if (refusal_.code == StatusCode::refused) return IntegrationSegment::reached_end;
            if (!done.empty()) is_steady_ = false, open_since_ = solver_->time();
            arrange_bulbs();
            begin_stage(sought());
            openings_.after_stage(done, solver_->time());
            if (sequence_.leaves_pack()) return std::nullopt;
            if (solver_->time() >= context_.stop_time) return IntegrationSegment::reached_end;
            if (const std::optional<IntegrationSegment> last = fly_stage()) return last;
        }
    }

    /// Whether any parachute is out: a payload that falls alone has no descent rate.
    bool is_carried() const { return std::ranges::any_of(sequence_.all(), &Canopy::is_out); }

    std::vector<Root> sought() const {
        const bool last = sequence_.is_settled() && is_carried();
        if (is_steady_ || is_past_peak_ || !sequence_.is_quiet() ||
            !(last || sequence_.waits_for_steady_descent()))
            return {};
        if (last && scene_.stop.kind == Trigger::Kind::peak_force) return {Root::steady, Root::peak};
        return {Root::steady};
    }

    /// One stage; the segment that ends the run, or nothing.
    std::optional<IntegrationSegment> fly_stage() {
        const bool seeks_steady = roots_.size() > 1 && roots_[1] == Root::steady;
        const bool seeks_peak = roots_.size() > 2 && roots_[2] == Root::peak;
        if (seeks_peak && above_past_peak(solver_->time(), solver_->state()) < 0.0) return end_after_peak();
        if (!seeks_steady || !(unsteadiness() < 0.0)) {
            settling_since_.reset();
            const IntegrationSegment segment =
                context_.integrate_to(*solver_, std::min(sequence_.next_time(), context_.stop_time));
            if (segment == IntegrationSegment::reached_end && goes_on()) return std::nullopt;
            if (segment != IntegrationSegment::root) return segment;
            const auto root = static_cast<std::size_t>(solver_->root());
            if (roots_[root] == Root::ground) return segment;
            if (roots_[root] == Root::peak) return end_after_peak();
            if (roots_[root] == Root::bulb) {
                const auto first =
                    static_cast<std::size_t>(std::ranges::find(roots_, Root::bulb) - roots_.begin());
                turn(watched_bulbs_[root - first]);
                return std::nullopt;
            }
            if (roots_[root] == Root::trigger) {
                sequence_.met(root - (roots_.size() - sequence_.watch_count()), now());
                return std::nullopt;
            }
        }
        return verify_steady();
    }

    /// Whether the run goes on; events due at its very end still happen.
    bool goes_on() const {
        return solver_->time() < context_.stop_time || sequence_.next_time() <= solver_->time();
    }

    /// Declared steady after a window that begins here; where it is not, looked at again and again.
    std::optional<IntegrationSegment> verify_steady() {
        constexpr double again = 0.5;  // of a window
        const Fall begin = fall();
        const double length = descent_window(begin.sink, begin.added_mass_ratio, model_.gravity);
        if (!settling_since_) settling_since_ = solver_->time();
        const double steady_since = std::max(*settling_since_ + length, solver_->time() + again * length);
        begin_stage({});
        const double end = std::min({steady_since, sequence_.next_time(), context_.stop_time});
        const IntegrationSegment segment = context_.integrate_to(*solver_, end);
        if (segment == IntegrationSegment::root &&
            roots_[static_cast<std::size_t>(solver_->root())] == Root::trigger) {
            sequence_.met(static_cast<std::size_t>(solver_->root()) - 1, now());
            return std::nullopt;
        }
        if (segment != IntegrationSegment::reached_end) return segment;
        if (solver_->time() < steady_since) return goes_on() ? std::nullopt : std::optional(segment);
        const std::optional<DescentWindow> found = window();
        if (!found || !found->is_steady()) {
            if (sequence_.is_settled()) take_long_steps();  // thin air may keep it from being steady for long
            return std::nullopt;
        }
        is_steady_ = true;
        const bool last = sequence_.is_settled();
        context_.add_event("steady-descent");
        sequence_.descends_steadily(now());
        if (!last) return std::nullopt;
        result_.descent = found;
        result_.descent_altitude = context_.observer.rows().back().altitude;
        const Trigger& stop = scene_.stop;
        if (stop.kind == Trigger::Kind::peak_force || stop.kind == Trigger::Kind::steady_descent)
            context_.end_at(solver_->time() + stop.delay);
        if (solver_->time() >= context_.stop_time) return segment;
        take_long_steps();
        return to_the_end();
    }

    /// Where nothing is waited for any more; otherwise from event to event.
    std::optional<IntegrationSegment> to_the_end() {
        if (!sequence_.is_over()) return std::nullopt;
        return context_.integrate_to(*solver_, context_.stop_time);
    }

    /// The force is well past its peak, the run goes on for the delay.
    std::optional<IntegrationSegment> end_after_peak() {
        context_.end_at(solver_->time() + scene_.stop.delay);
        is_past_peak_ = true;
        begin_stage({});
        return solver_->time() < context_.stop_time ? to_the_end() : IntegrationSegment::reached_end;
    }

    /// Whether an explicit method would take many steps for its stability alone in a steady descent to `end`:
    /// each may last for explicit_reach v/(2 g), and v goes with the density.
    bool is_long(double end) const {
        constexpr int layers = 32;
        const auto here = motion_of<dimensions>(solver_->state());
        const double speed = -here.velocity[dimensions - 1];
        if (!(speed > 0.0)) return false;
        const auto density = [&](double z) { return scene_.environment.atmosphere.at(z).density; };
        const double layer = (here.altitude() - context_.floor()) / layers;
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

    void take_long_steps() {
        if (takes_long_steps_ || scene_.rom.method != automatic || !is_long(context_.stop_time)) return;
        takes_long_steps_ = true;
        change_to(descent_method(), descent_tolerance * scene_.rom.rtol);
    }

    void change_to(const OdeMethod& method, double rtol) {
        context_.count(*solver_);
        const std::vector<double> y(solver_->state().begin(), solver_->state().end());
        solver_ = make_solver(method, rtol, solver_->time(), y);
        begin_stage({});
    }

    const Scene& scene_;
    RunContext& context_;
    OpeningSequence& sequence_;
    Motion<dimensions>& motion_;
    OpeningResult& result_;
    Openings& openings_;
    const double separation_;  // [m] of payload and parachute, from lock-up on
    Model model_;
    const bool predicted_ =
        std::ranges::any_of(scene_.parachutes, [](const Parachute& p) { return p.filling.is_predicted(); });
    mutable std::vector<FilledBulb> inside_;  // of the state that was looked at last
    std::vector<Bulb> bulbs_;                 // in the order of the state
    std::vector<std::size_t> watched_bulbs_;  // by their roots
    std::unique_ptr<OdeSolver> solver_;
    bool is_past_peak_ = false;
    RunStatus refusal_;        // of an opening that cannot take place
    std::vector<Root> roots_;  // of the stage, in the solver's order
    const bool several_ = has_several_canopies(scene_);
    bool is_limited_ = false;  // the length of steps
    bool takes_long_steps_ = false;
    bool is_steady_ = false;                // since the last event of a canopy
    double open_since_ = 0.0;               // [s] that event
    std::optional<double> settling_since_;  // [s] from which on unsteadiness() has been negative
};

}  // namespace

template <int dimensions>
std::optional<RunStatus> fly_on(const Scene& scene, RunContext& context, OpeningSequence& sequence,
                                double time, Motion<dimensions>& motion, double separation,
                                Openings& openings) {
    return Flight<dimensions>(scene, context, sequence, time, motion, separation, openings).fly();
}

template std::optional<RunStatus> fly_on(const Scene&, RunContext&, OpeningSequence&, double, Motion<1>&,
                                         double, Openings&);
template std::optional<RunStatus> fly_on(const Scene&, RunContext&, OpeningSequence&, double, Motion<2>&,
                                         double, Openings&);
template std::optional<RunStatus> fly_on(const Scene&, RunContext&, OpeningSequence&, double, Motion<3>&,
                                         double, Openings&);

}  // namespace twinchute::rom
