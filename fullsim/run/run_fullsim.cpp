#include "fullsim/run/run_fullsim.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "fullsim/fidelity.hpp"
#include "fullsim/mesh/start.hpp"
#include "fullsim/run/full_run.hpp"
#include "fullsim/run/plan.hpp"
#include "fullsim/run/unsupported_keys.hpp"
#include "lib/record/metrics.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/solve/filling_bracket.hpp"

namespace twinchute::fullsim {
namespace {

constexpr std::string_view step_key = "full.time_step_factor";

/// Where nobody chose the step.
bool may_step_shorter(const Scene& scene) {
    return std::ranges::any_of(scene.inputs, [&](const Input& input) {
        return input.key == step_key && input.origin == InputOrigin::fallback &&
               std::get<double>(input.value) == scene.full.time_step_factor;
    });
}

Scene with_shorter_steps(Scene scene, double factor) {
    scene.full.time_step_factor = factor;
    for (Input& input : scene.inputs)
        if (input.key == step_key) input.value = factor;
    return scene;
}

/// One run, or several. What impacts add to the energy is chance, and grows with the step: where it becomes
/// too much in a step that nobody has asked for, the scene is run again with half of it.
RunRecord fly(const Scene& scene, std::span<const double> stated_masses, Run run) {
    Attempts before;
    if (!run.checkpoints.from.empty()) {
        Archive archive(run.checkpoints.from, run.checkpoints.file);
        before.serialize(archive);
    }
    for (;;) {
        const Scene shorter =
            with_shorter_steps(scene, std::ldexp(scene.full.time_step_factor, -before.count));
        FullRun attempt(shorter, stated_masses, run, before);
        attempt.fly();
        const StatusCode code = attempt.status().code;
        const bool adds_up = code != StatusCode::energy_grew && code != StatusCode::solver_failed;
        if (adds_up || before.count == Attempts::most || !may_step_shorter(scene)) return attempt.finish();
        before.add(attempt.status(), attempt.clock());
        run.checkpoints.from.clear();
    }
}

/// Snatch of a parachute, or its line stretch where it starts drawn out. head: what its events begin with.
const Event* first_load(const RunRecord& record, const std::string& head) {
    const Event* snatch = record.find_event(head + "snatch");
    return snatch ? snatch : record.find_event(head + "line-stretch");
}

/// A run past its peak force, for the bracket of a predicted filling.
RunRecord fly_to_peak(Scene scene, std::span<const double> stated_masses, const Run& run) {
    scene.stop = {Trigger::Kind::peak_force, 0.0, 0.0};
    Run control;
    control.stop = run.stop;
    control.threads = run.threads;
    control.force_unstructured = run.force_unstructured;
    RunRecord record = fly(scene, stated_masses, control);
    for (const Parachute& chute : scene.parachutes) {
        const bool several = scene.parachutes.size() > 1;
        const std::string head = several ? chute.name + "." : "";
        const Event *full = record.find_event(head + "full-open"), *begin = first_load(record, head);
        if (!full) continue;
        const double time = full->time - (begin ? begin->time : 0.0);
        const std::string key = (several ? metric_head(chute.name) : "") + "filling_time_s";
        if (!several || !record.find_metric(key)) record.add_metric(key, time);
        if (several) continue;
        record.add_metric("fill_constant",
                          time * record.metric("snatch_speed_m_s").value_or(release_airspeed(scene).norm()) /
                              chute.nominal_diameter);
    }
    return record;
}

}  // namespace

RunRecord run_fullsim(const Scene& scene, Run& run) {
    const Scene heavy = weighed(scene);
    const bool is_one = !has_stages(scene) && scene.parachutes.front().count == 1;
    const Scene meshed = is_one ? scene_of_canopy(heavy, 0) : heavy;
    std::vector<double> stated_masses;
    for (const Parachute& chute : scene.parachutes)
        stated_masses.push_back(chute.mass);
    RunRecord record = fly(meshed, stated_masses, run);
    const bool ended = record.status.code == StatusCode::completed ||
                       record.status.code == StatusCode::stopped_by_event ||
                       record.status.code == StatusCode::squids;
    if (ended) {
        // Among several parachutes it is the first whose filling is predicted.
        const auto predicted = std::ranges::find_if(
            scene.parachutes, [](const Parachute& p) { return p.filling.is_predicted(); });
        const bool named = scene.parachutes.size() > 1 && predicted != scene.parachutes.end();
        const Event* snatch = first_load(record, named ? predicted->name + "." : "");
        const double altitude = snatch != nullptr ? snatch->altitude : scene.release.altitude;
        add_filling_bracket(record, meshed, scene.environment.atmosphere.at(altitude).density,
                            [&](const Scene& other) { return fly_to_peak(other, stated_masses, run); });
    }
    return record;
}

const Fidelity& full_fidelity() {
    static constexpr Fidelity row{.name = "full",
                                  .title = "full aeroelastic model",
                                  .run = &run_fullsim,
                                  .unsupported_keys = &unsupported_keys,
                                  .gives_fields = true,
                                  .has_threads = true,
                                  .plan = &plan_full,
                                  .keeps_checkpoints = true};
    return row;
}

}  // namespace twinchute::fullsim
