#include "lib/solve/hand_over.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lib/math/vec.hpp"
#include "lib/record/metrics.hpp"
#include "lib/solve/steady_descent.hpp"

namespace twinchute {
namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// The last of a channel; 0 of one that a fidelity leaves out, as motion across a straight fall.
double last(const RunRecord& record, std::string_view channel) {
    const Channel* found = record.find_channel(channel);
    return found == nullptr || found->values.empty() ? 0.0 : found->values.back();
}

/// Rate at the last row of a channel over time: of the polynomial through its last rows of different times,
/// as many as there are up to five. Two rows of one time are a jump of something else: places have none.
double last_rate(const RunRecord& record, std::string_view channel) {
    constexpr std::size_t max_points = 5;
    const Channel *time = record.find_channel("time"), *values = record.find_channel(channel);
    if (time == nullptr || values == nullptr) return 0.0;
    std::vector<double> t, x;  // the last one first
    for (std::size_t i = time->values.size(); i-- > 0 && t.size() < max_points;)
        if (t.empty() || time->values[i] < t.back()) {
            t.push_back(time->values[i]);
            x.push_back(values->values[i]);
        }
    // Divided differences (Newton): the rate at t[0] is f[0,1] + f[0,1,2] (t0 - t1) + ...
    double rate = 0.0, product = 1.0;
    for (std::size_t order = 1; order < t.size(); ++order) {
        for (std::size_t i = 0; i + order < t.size(); ++i)
            x[i] = (x[i] - x[i + 1]) / (t[i] - t[i + order]);
        rate += product * x[0];
        product *= t[0] - t[order];
    }
    return rate;
}

/// Tells whether an event happened to a parachute; of several, each has its name before the event's.
bool has_event(const RunRecord& record, const Scene& scene, const Parachute& chute, std::string_view name) {
    const bool one = scene.parachutes.size() == 1;
    return record.find_event(one ? std::string(name) : fmt::format("{}.{}", chute.name, name)) != nullptr;
}

/// Prefix of the channels of the only one of several parachutes that flies on: in the rest of the fall they
/// are those of the whole. Nothing where several fly on, or the scene has one.
std::optional<std::string> prefix_of_the_only_one(const RunRecord& record, const Scene& scene) {
    const auto flies_on = [&](const Parachute& chute) { return !has_event(record, scene, chute, "cut"); };
    if (scene.parachutes.size() == 1 || std::ranges::count_if(scene.parachutes, flies_on) != 1) return {};
    return metric_head(std::ranges::find_if(scene.parachutes, flies_on)->name);
}

/// Rows of `rest` but for its first, which is the last one of `first`.
void join_channels(RunRecord& first, const Scene& scene, const RunRecord& rest) {
    const auto prefix = prefix_of_the_only_one(first, scene);
    const std::size_t rows = rest.channels.front().values.size();
    for (Channel& channel : first.channels) {
        const double before = channel.values.back();
        const bool counts_on = channel.name == "time" || channel.name == "east" || channel.name == "north";
        const Channel* more = rest.find_channel(channel.name);
        if (more == nullptr && prefix && channel.name.starts_with(*prefix))
            more = rest.find_channel(channel.name.substr(prefix->size()));
        for (std::size_t i = 1; i < rows; ++i) {
            const double nothing = counts_on ? before : not_a_number;  // no motion across is none
            channel.values.push_back(more == nullptr ? nothing
                                     : counts_on     ? before + more->values[i]
                                                     : more->values[i]);
        }
    }
}

void join_events(RunRecord& first, const RunRecord& rest, double time) {
    first.events.push_back({"handed-over", time, last(first, "altitude"), last(first, "speed")});
    for (const Event& event : rest.events) {
        // Events at its beginning have happened before, and so has the peak.
        const bool is_new = event.time > 0.0 && event.name != "peak-force" && !first.find_event(event.name);
        if (is_new) first.events.push_back({event.name, time + event.time, event.altitude, event.speed});
    }
}

/// A metric of `rest` and what has to be added to it.
struct Taken {
    const char* key;
    double more;
};

void join_metrics(RunRecord& first, const Scene& scene, const RunRecord& rest) {
    HandOver& made = *first.handed_over;
    std::vector<Taken> taken{{"flight_time_s", made.time},
                             {"landing_east_m", last(first, "east")},
                             {"landing_north_m", last(first, "north")},
                             {"landing_vertical_speed_m_s", 0.0},
                             {"landing_energy_J", 0.0}};
    if (!first.find_metric("descent_rate_m_s"))
        taken.insert(taken.end(), {{"descent_rate_m_s", 0.0},
                                   {"descent_rate_amplitude", 0.0},
                                   {"descent_rate_remaining_change", 0.0},
                                   {"descent_altitude_m", 0.0},
                                   {"altitude_loss_m", scene.release.altitude - last(first, "altitude")}});
    const std::string from =
        fmt::format("by {} from t = {:.4g} s on, where its time begins; ", rest.fidelity, made.time);
    for (const auto& [key, more] : taken) {
        const Metric* metric = rest.find_metric(key);
        if (metric == nullptr) continue;
        first.add_metric(key, metric->value + more, metric->kind,
                         metric->note.empty() ? from.substr(0, from.size() - 2) : from + metric->note);
        made.metrics.emplace_back(key);
    }
    if (const Metric* drift = rest.find_metric("drift_m")) {
        const auto part = [&](const char* key) { return first.metric(key).value_or(0.0); };
        first.add_metric("drift_m", std::hypot(part("landing_east_m"), part("landing_north_m")), drift->kind,
                         from + drift->note);
        made.metrics.emplace_back("drift_m");
    }
    // Metrics that the first part did not reach come from the rest.
    if (first.find_metric("descent_rate_m_s"))
        std::erase_if(first.warnings,
                      [](const Warning& warning) { return warning.what == not_steady_within_run; });
}

struct Obstacle {
    std::string why, hint;
};

/// The first reason why the canopies at the end of a record cannot fly on as they are, if there is one.
std::optional<Obstacle> obstacle_to(const Scene& scene, const RunRecord& record) {
    for (const Parachute& chute : scene.parachutes) {
        if (has_event(record, scene, chute, "cut")) continue;
        const std::string who = scene.parachutes.size() == 1 ? "the canopy" : chute.name;
        // A canopy that over-inflates has settled once the descent is steady.
        const bool settles = chute.drag_area_table && chute.drag_area_table->end() > 1.0;
        const bool is_open = has_event(record, scene, chute, "full-open");
        if (!is_open || (settles && !record.find_event("steady-descent")))
            return Obstacle{
                fmt::format("the run stopped before {} {}", who,
                            is_open ? "had settled from over-inflating" : "was open"),
                fmt::format("stop later, e.g. at = \"{}\"", settles ? "steady-descent" : "full-open")};
        if (chute.cut)
            return Obstacle{fmt::format("{} is still to be cut", who),
                            "stop after that, or leave stop.then out and stop at \"ground\""};
    }
    return {};
}

void add_cost(Cost& cost, const Cost& more) {
    cost.wall_s += more.wall_s;
    cost.cpu_s += more.cpu_s;
    cost.steps += more.steps;
    cost.rhs_calls += more.rhs_calls;
    cost.rejected_steps += more.rejected_steps;
}

}  // namespace

std::string then_text(const Scene& scene) {
    return fmt::format("stop.then is \"{}\": from the last row on, once the canopy is open", scene.then);
}

Scene continued_from(const Scene& scene, const RunRecord& record) {
    Scene rest = scene;
    rest.then.clear();
    rest.stop = {Trigger::Kind::ground, 0.0, 0.0, ""};
    const double east = last_rate(record, "east"), north = last_rate(record, "north"),
                 climb = last(record, "vertical_speed");
    const double across = std::hypot(east, north);
    rest.release.altitude = last(record, "altitude");
    rest.release.speed = std::hypot(across, climb);
    rest.release.path_angle = rest.release.speed > 0.0 ? std::atan2(-climb, across) : 0.5 * pi;
    rest.release.heading = std::atan2(east, north);
    std::erase_if(rest.parachutes,
                  [&](const Parachute& chute) { return has_event(record, scene, chute, "cut"); });
    for (Parachute& chute : rest.parachutes) {
        chute.deploy = {};
        chute.deploy.by = DeployBy::inflated;
        chute.deploy_when.reset();
        chute.reefing.clear();
        chute.lag.clear();
        chute.skips_reefing = 0;
    }
    return rest;
}

RunRecord joined(RunRecord first, const Scene& scene, const RunRecord& rest) {
    const double time = last(first, "time");
    first.handed_over = HandOver{rest.fidelity, time, {}};
    join_metrics(first, scene, rest);
    std::erase_if(first.missing,
                  [&](const MissingMetric& row) { return first.find_metric(row.metric) != nullptr; });
    join_events(first, rest, time);
    join_channels(first, scene, rest);
    add_cost(first.cost, rest.cost);
    for (const Warning& warning : rest.warnings)
        if (std::ranges::find(first.warnings, warning.what, &Warning::what) == first.warnings.end())
            first.warnings.push_back(warning);
    if (rest.fidelity != first.fidelity)
        first.left_out.push_back(
            {fmt::format("physics of '{}' from t = {:.4g} s on", first.fidelity, time),
             fmt::format("stop.then is \"{}\": it flies the rest of the fall", rest.fidelity)});
    first.status = rest.status;
    first.status.detail =
        fmt::format("{}, by {} from t = {:.4g} s on", rest.status.detail, rest.fidelity, time);
    return first;
}

RunRecord run_scene(const Fidelity& fidelity, const Scene& scene, Run& run,
                    std::span<const Fidelity* const> others) {
    RunRecord record = fidelity.run(scene, run);
    if (scene.then.empty() || record.status.code != StatusCode::completed) return record;
    const auto then = std::ranges::find_if(others, [&](const Fidelity* f) { return f->name == scene.then; });
    if (then == others.end()) return record;
    if (const auto obstacle = obstacle_to(scene, record)) {
        record.warnings.push_back(
            {fmt::format("the fall was not handed over to {}", scene.then), obstacle->why, obstacle->hint});
        return record;
    }
    Run rest{run.stop, run.progress};
    const RunRecord after = (*then)->run(continued_from(scene, record), rest);
    return joined(std::move(record), scene, after);
}

}  // namespace twinchute
