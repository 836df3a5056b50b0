#include "rom/deployment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "lib/scene/line_stretch.hpp"
#include "lib/solve/opening.hpp"
#include "rom/canopy_force.hpp"
#include "rom/methods.hpp"
#include "rom/two_bodies.hpp"

namespace twinchute::rom {
namespace {

/// [m/s] of a release that is at rest in the air; what is left of equal velocities after rounding is less.
constexpr double at_rest = 1e-6;

/// [s] since release at which the extraction force bends or jumps, in rising order. `begin` [s]: of the
/// deployment, from which its history counts.
std::vector<double> corners_of(const ForceHistory& force, double begin) {
    std::vector<double> corners;
    if (force.time.empty()) return corners;
    const double end = std::min(force.time.back(), force.duration);
    for (const double t : force.time)
        if (t > 0.0 && t < end) corners.push_back(begin + t);
    corners.push_back(begin + end);
    return corners;
}

/// The force from `begin` to the corner after it, by two points inside: at its ends the history is that of
/// either side.
/// `zero` [s]: where its history counts from. count: of packs that are pulled at once, each by the force.
ForcePiece piece_of(const ForceHistory& force, int count, double zero, double begin, double end) {
    if (!std::isfinite(end)) return {};
    const double quarter = 0.25 * (end - begin), middle = begin + 2.0 * quarter;
    const double value = count * force.at(middle - zero);
    return {value, (value - count * force.at(begin + quarter - zero)) / quarter, middle};
}

template <int dimensions>
class DeploymentRun {
    static constexpr int size = 4 * dimensions;
    using Model = TwoBodies<dimensions>;

public:
    DeploymentRun(const Scene& scene, RunContext& context, OpeningSequence& sequence, Openings& openings,
                  double time, const Motion<dimensions>& motion)
        : scene_(scene),
          chute_(scene.parachutes[*sequence.leaves_pack()]),
          context_(context),
          sequence_(sequence),
          openings_(openings),
          begin_(time),
          corners_(corners_of(chute_.deploy.extraction, time)),
          model_(make_model(motion)) {}

    Deployed<dimensions> run(const Motion<dimensions>& motion) {
        Deployed<dimensions> result;
        std::vector<double> y(size, 0.0);
        std::ranges::copy(motion.position, y.begin());
        std::ranges::copy(motion.velocity, y.begin() + dimensions);
        if (chute_.deploy.by == DeployBy::mortar) eject_from_mortar(y);
        const bool tied = chute_.deploy.by == DeployBy::static_line;
        model_.phase = tied ? DeploymentPhase::static_line : DeploymentPhase::free_pack;
        if (tied && !chute_.deploy.anchor_moves)  // it stands still, and so does the parachute
            for (int i = 0; i < dimensions; ++i)
                y[3 * dimensions + i] = -y[dimensions + i];
        context_.observer.watch([this](double t, std::span<const double> state) { return row(t, state); });
        OdeSolver solver(opening_method(scene_), rhs(), begin_, y, scene_.rom.rtol, tolerances(), dimensions);
        if (pay_out(solver, result)) stretch(solver, result);
        context_.count(solver);
        return result;
    }

private:
    enum Root { payload_ground = RunContext::floor_root, parachute_ground, along_lines, first_trigger };

    Model make_model(const Motion<dimensions>& motion) const {
        Model model;
        model.atmosphere = scene_.environment.atmosphere;
        if (scene_.environment.wind) model.wind = &*scene_.environment.wind;
        model.gravity = scene_.environment.gravity;
        model.payload_drag_area = scene_.payload.drag_area.value_or(0.0);
        model.parachute_mass = chute_.count * chute_.mass;
        model.pack_drag_area = chute_.count * chute_.deploy.pack_drag_area;
        model.stiffness = line_stiffness(chute_);
        model.taut_distance = taut_distance(chute_);
        model.canopies = &sequence_;
        model.by_mach = sequence_.go_by_mach();
        if (scene_.aerodynamics.added_mass && sequence_.out_mass() > 0.0)
            model.added_mass = &*scene_.aerodynamics.added_mass;
        const Vec<dimensions> velocity =
            airspeed_of<dimensions>(motion.velocity, motion.altitude(), model.wind);
        model.behind = Vec<dimensions>::Unit(dimensions - 1);
        if (velocity.norm() > at_rest) model.behind = -velocity.normalized();
        return model;
    }

    double carried_mass() const { return scene_.payload.mass + sequence_.packed_mass(); }

    /// Mortar ejection: the pack gets its speed, the payload recoils; momentum is conserved.
    void eject_from_mortar(std::vector<double>& y) const {
        const double pack = model_.parachute_mass, payload = carried_mass() + sequence_.out_mass();
        const Vec<dimensions> speed = chute_.deploy.muzzle_speed * model_.behind;
        for (int i = 0; i < dimensions; ++i) {
            y[dimensions + i] -= pack / (pack + payload) * speed[i];
            y[3 * dimensions + i] = speed[i];
        }
    }

    /// Until the lines come taut.
    bool pay_out(OdeSolver& solver, Deployed<dimensions>& result) {
        const IntegrationSegment segment = integrate(solver, begin_ + longest_deployment);
        if (segment != IntegrationSegment::root || solver.root() != along_lines) {
            result.status = ending(segment, solver, result);
            return false;
        }
        const auto separation = Model::separation_of(solver.state());
        const auto motion = motion_of<dimensions>(solver.state());
        context_.add_event(*sequence_.leaves_pack(), "line-stretch");
        openings_.lines_taut();
        result.line_stretch_time = start_ = solver.time();
        result.payload_speed =
            airspeed_of<dimensions>(motion.velocity, motion.altitude(), model_.wind).norm();
        result.separation_speed = separation.speed();
        return true;
    }

    /// Until the lines have brought both bodies to one speed along them.
    void stretch(OdeSolver& solver, Deployed<dimensions>& result) {
        model_.phase = DeploymentPhase::taut_lines;
        const IntegrationSegment segment = integrate(solver, start_ + longest_deployment);
        const auto separation = Model::separation_of(solver.state());
        result.separation = separation.length();
        result.stretch =
            (result.separation - model_.taut_distance) / (chute_.line_length + chute_.riser_length);
        if (segment != IntegrationSegment::root || solver.root() != along_lines) {
            result.status = ending(segment, solver, result);
            return;
        }
        auto motion = motion_of<dimensions>(solver.state());
        motion.velocity = model_.locked_velocity(motion, separation);
        result.locked = motion;
        result.snatch_time = solver.time();
    }

    /// Stops where the right-hand side changes: at each corner of the extraction force, and where something
    /// happens to a canopy that is out.
    IntegrationSegment integrate(OdeSolver& solver, double limit) {
        const auto end = [&] {
            return std::min(context_.stop_time, limit);
        };  // an altitude may bring it nearer
        for (;;) {
            const std::vector<double> y(solver.state().begin(), solver.state().end());
            const auto done = sequence_.advance(now(solver));
            openings_.before_stage(done, now(solver));
            if (const Canopy* fills = sequence_.fills_itself()) {
                refusal_ = {
                    StatusCode::refused,
                    fmt::format(
                        "{} still fills while {} leaves its pack (a predicted filling is followed above "
                        "one body, not above two that move apart), deploy {} later, or give {} a fill_time",
                        fills->chute->name, chute_.name, chute_.name, fills->chute->name)};
                return IntegrationSegment::reached_end;
            }
            const auto corner = std::ranges::upper_bound(corners_, solver.time());
            const double bend = corner == corners_.end() ? std::numeric_limits<double>::infinity() : *corner;
            const double next = std::min(bend, sequence_.next_time());
            model_.payload_mass = carried_mass() + sequence_.out_mass();
            model_.extraction = piece_of(chute_.deploy.extraction, chute_.count, begin_, solver.time(), bend);
            solver.restart(solver.time(), y);
            watch(solver);
            if (sequence_.watches_pressure()) solver.limit_step(pressure_step);
            context_.observer.mark(solver.time(), y);
            openings_.after_stage(done, solver.time());
            const IntegrationSegment segment = context_.integrate_to(solver, std::min(next, end()));
            if (segment == IntegrationSegment::root && solver.root() >= first_trigger)
                sequence_.met(static_cast<std::size_t>(solver.root() - first_trigger), now(solver));
            else if (segment != IntegrationSegment::reached_end || solver.time() >= end())
                return segment;
        }
    }

    FlightState now(const OdeSolver& solver) const {
        return flight_state_of<dimensions>(scene_, solver.time(), motion_of<dimensions>(solver.state()));
    }

    void watch(OdeSolver& solver) const {
        const auto count = first_trigger + static_cast<int>(sequence_.watch_count());
        solver.watch(count, [this](double t, std::span<const double> y, std::span<double> g) {
            const auto motion = motion_of<dimensions>(y);
            const auto s = Model::separation_of(y);
            const double height = motion.altitude() - scene_.environment.ground;
            g[payload_ground] = motion.altitude() - context_.floor();
            g[parachute_ground] = height + s.distance[dimensions - 1];
            g[along_lines] =
                model_.phase == DeploymentPhase::taut_lines ? s.speed() : s.length() - model_.taut_distance;
            if (g.size() > first_trigger)
                std::ranges::copy(sequence_.watch(flight_state_of<dimensions>(scene_, t, motion)),
                                  g.begin() + first_trigger);
        });
    }

    OdeSolver::Rhs rhs() const {
        return [this](double t, std::span<const double> y, std::span<double> dydt) {
            const auto motion = motion_of<dimensions>(y);
            const auto s = Model::separation_of(y);
            const Vec<dimensions> a = model_.payload_acceleration(t, motion, s);
            const Vec<dimensions> separation_acceleration = model_.parachute_acceleration(t, motion, s) - a;
            std::ranges::copy(motion.velocity, dydt.begin());
            std::ranges::copy(a, dydt.begin() + dimensions);
            std::ranges::copy(s.velocity, dydt.begin() + 2 * dimensions);
            std::ranges::copy(separation_acceleration, dydt.begin() + 3 * dimensions);
        };
    }

    std::vector<double> tolerances() const {
        return std::vector<double>(size, smallest_scale * scene_.rom.rtol);
    }

    HistoryRow row(double t, std::span<const double> y) const {
        const auto m = motion_of<dimensions>(y);
        const auto s = Model::separation_of(y);
        HistoryRow r{};
        r.time = t;
        r.altitude = m.altitude();
        r.vertical_speed = m.velocity[dimensions - 1];
        r.speed = m.velocity.norm();
        if constexpr (dimensions >= 2) r.east = m.position[0];
        if constexpr (dimensions == 3) r.north = m.position[1];
        r.force = model_.riser_force(t, m, s, carried_mass(), model_.payload_drag_area);
        r.drag_area = model_.canopy_drag_area(t, m) +
                      (model_.phase == DeploymentPhase::static_line ? 0.0 : model_.pack_drag_area);
        r.dynamic_pressure = 0.5 * model_.atmosphere.at(m.altitude()).density *
                             airspeed_of<dimensions>(m.velocity, m.altitude(), model_.wind).squaredNorm();
        const Vec<dimensions> acceleration = model_.payload_acceleration(t, m, s);
        r.acceleration = acceleration.norm();
        r.specific_force = (acceleration + model_.gravity * Vec<dimensions>::Unit(dimensions - 1)).norm();
        r.separation = s.length();
        if (several_) {
            const LargestPull pull = largest_pull<dimensions>(
                sequence_, {t, model_.atmosphere.at(m.altitude()).density, model_.gravity,
                            model_.mach_number(m), model_.added_mass, model_.accretes(),
                            airspeed_of<dimensions>(m.velocity, m.altitude(), model_.wind), acceleration});
            const double own = model_.tension(s) / chute_.count;  // alike, and drawn out together
            const auto leaving = std::ranges::find(sequence_.all(), *sequence_.leaves_pack(), &Canopy::index);
            r.canopies = pull.canopies + (own > 0.0 ? chute_.count : 0);
            r.canopy_force = std::max(own, pull.force);
            r.canopy =
                own > pull.force ? static_cast<std::size_t>(leaving - sequence_.all().begin()) : pull.canopy;
        }
        return r;
    }

    /// In words, since a parachute that never opens is what a user wants to know most.
    RunStatus ending(IntegrationSegment segment, const OdeSolver& solver, Deployed<dimensions>& result) {
        if (refusal_.code == StatusCode::refused) return refusal_;
        const auto s = Model::separation_of(solver.state());
        const std::string apart =
            fmt::format("payload and parachute are {:.4g} m apart at t = {:.4g} s, taut lines take {:.4g} m",
                        s.length(), solver.time(), model_.taut_distance);
        const std::string why = result.line_stretch_time ? "the lines were still stretching: " + apart
                                                         : "the lines never came taut: " + apart;
        context_.record.warnings.push_back(
            {result.line_stretch_time ? "the run ended before snatch" : "the parachute did not deploy", why,
             "check parachute.deploy, the payload's drag area and stop"});
        if (segment == IntegrationSegment::root) {
            context_.add_event("ground");
            result.payload_landed = solver.root() == payload_ground;
            return result.payload_landed
                       ? context_.landed(why)
                       : RunStatus{StatusCode::stopped_by_event, "the parachute reached the ground: " + why};
        }
        if (segment == IntegrationSegment::reached_end && solver.time() < context_.stop_time)
            return {
                StatusCode::time_limit,
                why + ", check parachute.deploy and payload.drag_area, or end the run before by stop.time"};
        return context_.ending(segment, solver);
    }

    const Scene& scene_;
    const Parachute& chute_;
    RunContext& context_;
    OpeningSequence& sequence_;
    Openings& openings_;
    const double begin_;  // [s]
    const std::vector<double> corners_;
    Model model_;
    double start_ = 0.0;  // [s] of the stage of taut lines
    RunStatus refusal_;   // of what this model cannot follow
    const bool several_ = has_several_canopies(scene_);
};

}  // namespace

double taut_distance(const Parachute& chute) {
    const double lines = chute.line_length + chute.riser_length;
    if (chute.deploy.by != DeployBy::static_line) return lines;
    return chute.deploy.static_line_length + lines + 0.5 * chute.nominal_diameter;
}

template <int dimensions>
Motion<dimensions> released(const Scene& scene) {
    const Release& release = scene.release;
    const double down = release.speed * std::sin(release.path_angle);
    Motion<dimensions> m;
    m.position.setZero();
    m.position[dimensions - 1] = release.altitude;
    if constexpr (dimensions == 1) m.velocity << 0.0 - down;  // no -0 at rest
    if constexpr (dimensions == 2) m.velocity << release.speed * std::cos(release.path_angle), 0.0 - down;
    if constexpr (dimensions == 3) m.velocity = velocity_over_ground(release);
    return m;
}

template <int dimensions>
Deployed<dimensions> deploy(const Scene& scene, RunContext& context, OpeningSequence& sequence,
                            Openings& openings, double time, const Motion<dimensions>& motion) {
    return DeploymentRun<dimensions>(scene, context, sequence, openings, time, motion).run(motion);
}

template Motion<1> released(const Scene&);
template Motion<2> released(const Scene&);
template Motion<3> released(const Scene&);
template Deployed<1> deploy(const Scene&, RunContext&, OpeningSequence&, Openings&, double, const Motion<1>&);
template Deployed<2> deploy(const Scene&, RunContext&, OpeningSequence&, Openings&, double, const Motion<2>&);
template Deployed<3> deploy(const Scene&, RunContext&, OpeningSequence&, Openings&, double, const Motion<3>&);

}  // namespace twinchute::rom
