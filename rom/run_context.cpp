#include "rom/run_context.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "lib/solve/opening.hpp"

namespace twinchute::rom {
namespace {

/// A descent of ten hours takes 40 000: where more are needed, something is stiffer than this method.
constexpr int max_steps = 100'000;

}  // namespace

double RunContext::unlimited() {
    return longest_flight;
}

IntegrationSegment RunContext::integrate_to(OdeSolver& solver, double end) {
    if (end - solver.time() <= 64.0 * std::numeric_limits<double>::epsilon() * end) {
        // A stage without length, to round-off: ARKODE would refuse it.
        const std::vector<double> y(solver.state().begin(), solver.state().end());
        solver.restart(end, y);
        return IntegrationSegment::reached_end;
    }
    solver.stop_at(end);
    for (;;) {
        if (run_.stop.stop_requested()) return IntegrationSegment::interrupted;
        if (++steps_ > max_steps) return IntegrationSegment::too_many_steps;
        const auto outcome = solver.advance(longest_step());
        if (outcome == OdeSolver::Outcome::failed) return IntegrationSegment::failed;
        observer.step(solver);
        if (!observer.is_finite()) return IntegrationSegment::not_finite;
        if (outcome == OdeSolver::Outcome::reached_stop) return IntegrationSegment::reached_end;
        if (outcome != OdeSolver::Outcome::found_root) continue;
        if (solver.root() != floor_root || !stops_above_ground()) return IntegrationSegment::root;
        // Not the ground but the altitude to stop at: from here on the ground is watched.
        below_stop_altitude_ = true;
        met(Trigger::Kind::altitude, solver.time());
        end = std::min(end, stop_time);
        const std::vector<double> y(solver.state().begin(), solver.state().end());
        solver.restart(solver.time(), y);
        if (solver.time() >= end) return IntegrationSegment::reached_end;
        solver.stop_at(end);
    }
}

double RunContext::longest_step() const {
    const Environment& air = scene_.environment;
    const HistoryRow& now = observer.rows().back();
    double reach = air.atmosphere.reach(now.altitude);
    if (air.wind) reach = std::min(reach, air.wind->reach(now.altitude));
    if (!std::isfinite(reach)) return reach;
    const double climb = std::abs(now.vertical_speed);  // and it falls freely at most
    return 2.0 * reach / (climb + std::sqrt(climb * climb + 2.0 * air.gravity * reach));
}

bool RunContext::stops_above_ground() const {
    return scene_.stop.kind == Trigger::Kind::altitude && !below_stop_altitude_;
}

double RunContext::floor() const {
    return stops_above_ground() ? scene_.stop.value : scene_.environment.ground;
}

void RunContext::met(Trigger::Kind what, double time) {
    if (scene_.stop.kind == what) end_at(time + scene_.stop.delay);
}

void RunContext::end_at(double time) {
    stop_time = std::min(stop_time, time);
    stop_is_set_ = true;
}

void RunContext::add_event(const char* name) {
    const HistoryRow& r = observer.rows().back();
    record.events.push_back({name, r.time, r.altitude, r.speed});
}

void RunContext::add_event(std::size_t parachute, const char* name) {
    if (scene_.parachutes.size() == 1) return add_event(name);
    add_event((scene_.parachutes[parachute].name + "." + name).c_str());
}

void RunContext::count(const OdeSolver& solver) {
    const auto s = solver.statistics();
    Cost& cost = record.cost;
    if (s.steps > 0) {
        cost.dt_min_s = cost.steps > 0 ? std::min(cost.dt_min_s, s.dt_min) : s.dt_min;
        cost.dt_max_s = std::max(cost.dt_max_s, s.dt_max);
    }
    cost.steps += s.steps;
    cost.rhs_calls += s.rhs_calls;
    cost.rejected_steps += s.rejected;
}

RunStatus RunContext::ending(IntegrationSegment segment, const OdeSolver& solver) const {
    const double time = observer.rows().back().time;
    switch (segment) {
        case IntegrationSegment::reached_end:
            if (stop_is_set_ || time < stop_time) return {StatusCode::completed, "stop condition met"};
            return {StatusCode::time_limit,
                    fmt::format("stop condition not met within {:g} s of flight, stop at what comes sooner, "
                                "e.g. stop.time or stop.altitude",
                                stop_time)};
        case IntegrationSegment::not_finite:
            return {
                StatusCode::not_finite,
                fmt::format(
                    "force or acceleration after t = {:.6g} s, take another rom.method, or check the inputs "
                    "that act there",
                    time)};
        case IntegrationSegment::too_many_steps:
            return {StatusCode::step_limit,
                    fmt::format(
                        "more than {} steps by t = {:.6g} s, give a larger rom.rtol, an implicit rom.method "
                        "or an earlier stop",
                        max_steps, time)};
        case IntegrationSegment::interrupted:
            return {StatusCode::interrupted, "stopped on request"};
        case IntegrationSegment::root:  // the caller's
        case IntegrationSegment::failed:
            break;
    }
    return {StatusCode::solver_failed, solver.failure() + ", take another rom.method or a larger rom.rtol"};
}

RunStatus RunContext::landed(const std::string& before) const {
    if (scene_.stop.kind == Trigger::Kind::ground)
        return {StatusCode::completed, "ground reached" + (before.empty() ? "" : ": " + before)};
    return {StatusCode::stopped_by_event,
            "ground reached before " +
                (before.empty() ? "the stop condition" : "the parachute opened: " + before)};
}

}  // namespace twinchute::rom
