#include "rom/run_rom.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lib/solve/opening.hpp"
#include "lib/solve/stopwatch.hpp"
#include "rom/deployment.hpp"
#include "rom/estimates.hpp"
#include "rom/fidelity.hpp"
#include "rom/flight.hpp"
#include "rom/plan.hpp"
#include "rom/rom_record.hpp"

namespace twinchute::rom {
namespace {

/// Whether an opening takes place at all, whatever the speed at snatch turned out to be.
RunStatus check_times(const Inflation& inflation) {
    if (std::isfinite(inflation.filling_time) && inflation.initial_time < inflation.filling_time) return {};
    return {
        StatusCode::refused,
        fmt::format("at snatch the initial phase is not shorter than the filling time (t_s = {:.4g} s, t_i = "
                    "{:.4g} s, t_f = {:.4g} s), shorten parachute.initial_phase or lengthen fill_time",
                    inflation.snatch, inflation.initial_time, inflation.filling_time)};
}

/// Runs a scene; what an opening is judged by goes to `result`.
template <int dimensions>
void fly(const Scene& scene, Course& course, OpeningResult& result) {
    const Parachute& chute = scene.parachutes.front();
    RunRecord& record = course.record;
    Motion<dimensions> start = released<dimensions>(scene);
    double separation = 0.0;
    const char* event = "line-stretch";
    const Vec3 airspeed = release_airspeed(scene);
    result.snatch_speed = result.payload_snatch_speed = airspeed.norm();
    result.snatched = chute.deploy.by != DeployBy::inflated;

    if (chute.deploy.starts_packed()) {
        const Deployed<dimensions> deployed = deploy<dimensions>(scene, course);
        result.line_stretch_time = deployed.line_stretch_time;
        result.snatched = deployed.locked.has_value();
        record.status = deployed.status;
        if (deployed.payload_landed) result.landing_time = course.observer.rows().back().time;
        if (deployed.line_stretch_time)
            add_snatch_forms(record, scene, deployed.parting_speed, deployed.stretch);
        if (!deployed.locked) return;
        start = *deployed.locked;
        separation = deployed.separation;
        event = "snatch";
        const Wind* wind = scene.environment.wind ? &*scene.environment.wind : nullptr;
        result.snatch_time = deployed.snatch_time;
        result.snatch_speed = airspeed_of<dimensions>(start.velocity, start.altitude(), wind).norm();
        result.payload_snatch_speed = deployed.payload_speed;
    }
    result.snatch_density = scene.environment.atmosphere.at(start.altitude()).density;
    const Inflation inflation = result.snatched ? make_inflation(chute, result.snatch_time,
                                                                 result.snatch_speed, result.snatch_density)
                                                : inflated(chute);
    if (result.snatched) {
        record.status = check_times(inflation);
        if (record.status.code == StatusCode::refused) return;
        add_opening_warnings(record, scene, inflation, result.snatch_speed, result.snatch_density);
    }
    record.status = fly_on<dimensions>(scene, course, inflation, start, separation, event, result);
}

/// What the observer knows of the whole run.
void judge(const Scene& scene, int dimensions, Course& course, OpeningResult& result) {
    const Observer& observer = course.observer;
    const bool packed = scene.parachutes.front().deploy.starts_packed();
    const HistoryRow& last = observer.rows().back();
    RunRecord& record = course.record;
    if (packed && !result.snatch_force) {  // the run ended before the peak began to count
        result.max_force = observer.peak().value;
        if (result.snatched) result.snatch_force = result.max_force;
    } else {
        result.peak_force = observer.peak().value;
        result.peak_time = observer.peak().at;
        result.max_force = std::max(*result.peak_force, result.snatch_force.value_or(0.0));
        const HistoryRow& top = observer.row_near(result.peak_time);
        record.events.push_back({"peak-force", result.peak_time, top.altitude, top.speed});
        std::ranges::stable_sort(record.events, {}, &Event::time);
    }
    if (result.filling_time)
        result.impulse =
            observer.impulse_between(result.snatch_time, result.snatch_time + *result.filling_time);
    result.max_deceleration = observer.largest_deceleration();
    if (result.descent_altitude) result.descent_rate = observer.altitude_at(last.time - 1.0) - last.altitude;
    result.end_position = place_of(last, scene, dimensions);
}

void add_metrics(RunRecord& record, const Scene& scene, const OpeningResult& result) {
    const FillTime& fill = scene.parachutes.front().fill_time;
    const Metric filling{"", 0.0, Standing::input,
                         fill.model->name == "given" ? std::string("given in the scene")
                         : fill.porosity > 0.0
                             ? fmt::format("prescribed: lambda_g = {:g} and the snatch speed", fill.porosity)
                             : fmt::format("prescribed: n = {:g} and the snatch speed", fill.n)};
    const Metric descent{"", 0.0, Standing::mixed,
                         "(C_D S)_0 and mass are inputs; the balance is the result"};
    add_opening_metrics(record, scene, result, filling, descent);
    if (record.status.code == StatusCode::completed && !result.descent_rate &&
        scene.stop.kind == Trigger::Kind::time)
        record.warnings.push_back({"no descent rate", "the run ended before the descent was steady",
                                   "set stop.time later, or stop.at = \"steady-descent\""});
}

template <int dimensions>
RunRecord run_in(const Scene& scene, Run& run) {
    RunRecord record = begin_record(scene, "rom");
    const Stopwatch watch;
    Course course(scene, run, record);
    OpeningResult result;
    fly<dimensions>(scene, course, result);
    judge(scene, dimensions, course, result);
    record.cost.wall_s = watch.wall();
    record.cost.cpu_s = watch.cpu();
    add_metrics(record, scene, result);
    add_estimates(record, scene, result);
    add_channels(record, course.observer.rows(), scene, dimensions);
    record.left_out = left_out_of(parts_of(scene));
    add_scene_warnings(record, scene);
    return record;
}

/// A pack without drag falls beside its payload.
std::vector<std::string> lacks(const Scene& scene) {
    const Deployment& deploy = scene.parachutes.front().deploy;
    if (deploy.by == DeployBy::free && !(deploy.pack_drag_area > 0.0))
        return {"parachute.deploy.pack_drag_area"};
    return {};
}

}  // namespace

RunRecord run_rom(const Scene& scene, Run& run) {
    switch (dimensions_of(scene)) {
        case 1:
            return run_in<1>(scene, run);
        case 2:
            return run_in<2>(scene, run);
        default:
            return run_in<3>(scene, run);
    }
}

const Fidelity& rom_fidelity() {
    static constexpr Fidelity row{"rom", "reduced-order model", &run_rom, &lacks, false, false, &plan_rom};
    return row;
}

}  // namespace twinchute::rom
