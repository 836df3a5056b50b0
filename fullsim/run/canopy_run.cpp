#include "fullsim/run/canopy_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fullsim/run/results.hpp"
#include "lib/solve/opening.hpp"

namespace twinchute::fullsim {
namespace {

// How long lines have to stay taut, since flailing ones do not, over the time that a wave takes along them:
// 2 ms of a C-9's line (7.31 m of 462 kg/m^3 and 0.97 GPa).
const double taut_hold = 2e-3 / (7.31 * std::sqrt(462.0 / 9.7e8));
// A canopy squids that has grown by less than this share of its area over so many diameters of travel.
constexpr double least_growth = 0.01, squid_travel = 5.0;
constexpr double least_drag_area = 0.5;  // over (C_D S)_0, of a canopy that is still open at the end

}  // namespace

CanopyRun::CanopyRun(const Scene& scene, double stated_mass, Cluster& canopies, std::size_t which,
                     OpeningSequence* shared, std::size_t number)
    : scene_(scene),
      canopies_(canopies),
      which_(which),
      observer_(canopies[which].mesh(), scene.environment.gravity, scene.full.row_rate(),
                canopies[which].sectors()),
      own_(shared || parachute().reefing.empty() ? std::optional<OpeningSequence>() : OpeningSequence(scene)),
      sequence_(shared ? shared
                : own_ ? &*own_
                       : nullptr),
      number_(number),
      view_{scene, stated_mass, canopies, which,
            1,     observer_,   found_,   parachute().reefing.empty() ? nullptr : sequence_} {
    found_.snatch = scene.release.time;
    if (own_) own_->release(flight_state());
    if (view_.packed()) {
        found_.snatch = infinity;
        observer_.count_peak_from(infinity);
    } else {
        observer_.count_peak_from(scene.release.time);
    }
}

FlightState CanopyRun::flight_state() const {
    const NodeRecord& payload = canopies_[which_].payload();
    return {system().time, payload.x[2], payload.v[2],
            (system().sums.system_velocity - system().air.wind).norm(), system().air.density};
}

void CanopyRun::observe(bool row_is_due) {
    observer_.observe(system(), simulation().payload_force());
    if (row_is_due) observer_.add_row(simulation().synchronised_state());
}

double CanopyRun::next_stop() const {
    const Inflation& inflation = canopies_[which_].inflation();
    const double deployed = deploys() ? std::min({hold_end_, last_deployment(), next_load_change()})
                                      : std::min(inflation.end_of(system().phase), inflation.next_kink());
    const double cut = own_ ? own_->next_time() : infinity;
    return std::min({deployed, cut, canopies_[which_].ramp_end()});
}

/// The next time at which the extraction force is not smooth.
double CanopyRun::next_load_change() const {
    const ForceHistory& force = parachute().deploy.extraction;
    const double zero = scene_.release.time, now = system().time;
    double next = zero + force.duration > now ? zero + force.duration : infinity;
    for (const double t : force.time)
        if (zero + t > now) next = std::min(next, zero + t);
    return force.time.empty() ? infinity : next;
}

const std::vector<const char*>& CanopyRun::look(bool falls_steadily) {
    happened_.clear();
    if (deploys()) {
        look_for_snatch();
    } else {
        look_for_opening();
        if (own_) look_for_disreef(falls_steadily);
        const double now = system().time;
        const bool opens = std::ranges::any_of(
            happened_, [](std::string_view name) { return name == "full-open" || name == "reefed-open"; });
        if (system().stage == Stage::springs && (opens || simulation().mouth_is_open())) {
            found_.switched_late = opens && !simulation().mouth_is_open();
            simulation().begin_ramp();
            happened_.push_back("switch");
        } else if (now >= simulation().ramp_end()) {
            simulation().end_ramp();
            happened_.push_back("finite-elements-alone");
        }
    }
    return happened_;
}

/// [s] at which it is too late.
double CanopyRun::last_deployment() const {
    return scene_.release.time + longest_deployment;
}

/// [s]
double CanopyRun::hold() const {
    const Parachute& chute = parachute();
    return taut_hold * (chute.line_length * std::sqrt(chute.line.density / chute.line.youngs_modulus));
}

/// Lines count as taut once they have stayed so for a while; the end of that is the snatch.
void CanopyRun::look_for_snatch() {
    const double now = system().time;
    if (!simulation().lines_are_taut()) {
        hold_end_ = infinity;
    } else if (hold_end_ == infinity) {
        hold_end_ = now + hold();
    }
    if (now < hold_end_) {
        if (now >= last_deployment())
            ending_ = RunStatus{
                StatusCode::time_limit,
                fmt::format("the lines never came taut within {:g} s of release, check parachute.deploy and "
                            "payload.drag_area, or end the run before by stop.time",
                            longest_deployment)};
        return;
    }
    found_.line_stretch_time = now - hold();
    found_.payload_snatch_speed = (to_vec3(simulation().payload().v) - system().air.wind_at_payload).norm();
    const Vec3 airspeed = system().sums.system_velocity - system().air.wind;
    found_.snatch_speed = airspeed.norm();
    found_.snatch_path_angle = angle_below_horizon(airspeed);
    found_.snatch_density = system().air.density;
    std::optional<Inflation> opening;
    if (sequence_ && !own_) {  // it knows the whole payload, of which this canopy carries a share
        sequence_->canopy_snatched(number_, flight_state());
        opening = sequence_->all()[number_].inflation;
    }
    if (auto refused = simulation().snatch(opening)) {
        ending_ = std::move(refused);
        return;
    }
    canopies_.start_anew_but(which_);
    if (own_) own_->snatched(0, flight_state());
    found_.snatch = now;
    happened_.push_back("snatch");
    observer_.count_peak_from(now + simulation().inflation().initial_time);
}

void CanopyRun::look_for_opening() {
    const double now = system().time;
    if (simulation().has_filled()) {
        simulation().end_filling();
        if (sequence_) {
            sequence_->grown(number_, {}, false, system().air.drag_area);
            sequence_->fills_up(number_, now, !system().inflow.has_been_full);
        }
    }
    watch_growth();
    while (now >= simulation().inflation().next_kink())
        simulation().pass_kink();
    if (now < simulation().inflation().end_of(system().phase)) return;
    const bool opens = system().phase == Phase::filling;
    if (opens && !found_.stages.back().full) found_.stages.back().full = now;
    if (system().phase != Phase::overshoot)
        happened_.push_back(!opens ? "end-of-initial-phase" : view_.reefed() ? "reefed-open" : "full-open");
    // Drag area and phi are continuous here, only their rates jump: the forces just evaluated are those of
    // the phase that begins, too.
    simulation().begin(simulation().inflation().after(system().phase));
}

/// Whether a canopy whose filling is predicted still grows.
void CanopyRun::watch_growth() {
    if (!simulation().predicts_filling() || system().phase == Phase::open) return;
    growth_.travelled += system().dt * system().air.airspeed;
    if (growth_.travelled < squid_travel * parachute().nominal_diameter) return;
    const double area = system().air.projected_area;
    growth_ = {0.0, area, area < (1.0 + least_growth) * growth_.area};
}

/// The canopies know when a line is cut; drag area and added mass go on from where they are.
void CanopyRun::look_for_disreef(bool falls_steadily) {
    if (falls_steadily && waits_for_steady_descent()) {
        happened_.push_back("steady-descent");
        own_->descends_steadily(flight_state());
    }
    for (const OpeningEvent& what : own_->advance(flight_state())) {
        if (what.kind != OpeningEvent::Kind::disreef) continue;
        happened_.push_back("disreef");
        disreef();
    }
}

void CanopyRun::disreef() {
    const Canopy& canopy = sequence_->all()[number_];
    found_.stages.push_back({system().time});
    observer_.begin_stage(system().time);
    simulation().disreef(canopy.inflation, canopy.stage);
    if (canopy.phase == Phase::initial) simulation().begin(Phase::initial);
}

std::optional<std::string> CanopyRun::squids() const {
    const Simulation& simulation = canopies_[which_];
    if (!simulation.predicts_filling()) return {};
    const bool open = system().phase == Phase::open;
    const bool fell_in = open && system().time >= view_.full_open() + shape_average &&
                         observer_.mean(&HistoryRow::drag_area, shape_average) <
                             least_drag_area * simulation.inflation().steady_drag_area;
    if (!fell_in && (open || !growth_.stands)) return {};
    const auto critical = filling_canopy(parachute()).critical_speed(system().air.density);
    const std::string opens =
        !critical          ? "by the reduced-order balance it opens at any subsonic speed"
        : *critical == 0.0 ? "by the reduced-order balance it opens at no speed"
                           : fmt::format("by the reduced-order balance it opens below {:.4g} m/s", *critical);
    return fmt::format(
        "at {:.4g} m/s the canopy {} {:.3g} m^2 of projected area; {}; a larger "
        "parachute.filling.initial_mouth fills it sooner",
        system().air.airspeed, fell_in ? "was full and fell in to" : "stands at", system().air.projected_area,
        opens);
}

void CanopyRun::serialize(Archive& archive) {
    observer_.serialize(archive);
    if (own_) own_->serialize(archive);
    archive.flag("stands", growth_.stands);
    for (double* x : {&hold_end_, &growth_.travelled, &growth_.area})
        archive.number("canopy", *x);
    found_.serialize(archive);
}

}  // namespace twinchute::fullsim
