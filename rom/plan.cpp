#include "rom/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lib/solve/hand_over.hpp"
#include "lib/solve/stopwatch.hpp"
#include "rom/observer.hpp"
#include "rom/run_rom.hpp"

namespace twinchute::rom {
namespace {

constexpr int max_runs = 15;

struct Parts {
    std::vector<PlanPart> rows;

    void add(PlanPart::Kind kind, const char* name, const char* what, bool needed, std::string why) {
        rows.push_back({kind, name, what, needed, std::move(why)});
    }
    void optional(const char* name, const char* what, const char* key, bool is_given) {
        add(PlanPart::Kind::physics, name, what, is_given,
            std::string(key) + (is_given ? " is given" : " is absent"));
    }
};

}  // namespace

int dimensions_of(const Scene& scene) {
    if (scene.environment.wind) return 3;
    // A path within 1e-9 rad of the vertical has no horizontal part that anyone could measure.
    const bool vertical = scene.release.speed == 0.0 || std::abs(std::cos(scene.release.path_angle)) < 1e-9;
    return vertical ? 1 : 2;
}

std::vector<PlanPart> parts_of(const Scene& scene) {
    using enum PlanPart::Kind;
    const auto any = [&](auto&& is) { return std::ranges::any_of(scene.parachutes, is); };
    const bool packed = any([](const Parachute& p) { return p.deploy.starts_packed(); });
    const bool inflated = !any([](const Parachute& p) { return p.deploy.by != DeployBy::inflated; });
    const bool windy = scene.environment.wind.has_value();
    const int dimensions = dimensions_of(scene);
    const std::string start = packed     ? "the scene starts packed"
                              : inflated ? "the scene starts with the canopy open"
                                         : "the scene starts at line stretch";
    const std::string every_run = "every run has it", stop = "the scene may stop there";
    Parts parts;
    parts.add(dimension, "vertical motion", "altitude and its rate", true, every_run);
    parts.add(dimension, "horizontal motion", "downrange", dimensions >= 2,
              dimensions >= 2 ? windy ? "the air moves" : "the release is not straight down"
                              : "the release is straight down and the air is still");
    parts.add(dimension, "motion across the release plane", "crossrange", dimensions == 3,
              windy             ? "the air moves"
              : dimensions == 2 ? "the air is still"
                                : "the release is straight down and the air is still");
    parts.optional("wind", "the air moves", "environment.wind", windy);
    parts.add(physics, "second body", "payload and pack part until the lines are taut", packed, start);
    parts.add(physics, "filling", "the drag area grows", !inflated, start);
    const bool predicted = any([](const Parachute& p) { return p.filling.is_predicted(); });
    parts.add(physics, "predicted filling", "how fast the canopy takes in air", predicted,
              predicted ? "parachute.filling predicts it" : "parachute.filling is absent: it is prescribed");
    for (const std::string& key : scene.overridden)
        parts.rows.push_back({physics, key, "how the canopy fills, as its design prescribes", false,
                              "parachute.filling predicts it"});
    parts.optional("reefing", "stages with the mouth held together", "parachute.reefing",
                   any([](const Parachute& p) { return !p.reefing.empty(); }));
    const bool several = scene.parachutes.size() > 1 || any([](const Parachute& p) { return p.count > 1; });
    parts.add(physics, "several parachutes", "one after the other, or in clusters", several,
              several ? "the scene has them" : "the scene has one parachute");
    if (packed) {
        parts.add(physics, "drawing out of fabric and lines", "their motion until snatch", false,
                  "payload and parachute are two point masses until snatch");
        parts.optional("drag of the pack", "until snatch", "parachute.deploy.pack_drag_area",
                       any([](const Parachute& p) { return p.deploy.pack_drag_area > 0.0; }));
    }
    parts.add(physics, "canopy structure", "fabric and lines with stresses", false,
              packed ? "this model moves payload and parachute as one rigid body from snatch on"
                     : "this model moves payload and parachute as one rigid body");
    if (scene.aerodynamics.line_drag)
        parts.add(physics, "line drag", "of the suspension lines", false,
                  "this model has no lines; the full model has");
    if (scene.aerodynamics.breathing_damping)
        parts.add(physics, "breathing damping", "of fabric against air", false,
                  "this model has no canopy shape");
    if (scene.payload.body)
        parts.add(physics, "turning of the payload", "of its body", false,
                  "this model's payload is a point mass");
    if (scene.payload.drag_area_table)
        parts.add(physics, "attitude of the payload in the air", "its drag area by angle", false,
                  "this model's payload hangs straight behind the parachute: the drag area of angle 0");
    parts.optional("added mass", "air moves with the canopy", "aerodynamics.added_mass",
                   scene.aerodynamics.added_mass.has_value());
    parts.optional("drag area by Mach number", "a factor on the prescribed one",
                   "parachute.drag_area_mach_table",
                   any([](const Parachute& p) { return p.drag_area_mach_table.has_value(); }));
    const bool has_sound = scene.environment.atmosphere.model->has_temperature;
    parts.add(physics, "Mach number", "what is subsonic is judged by it", has_sound,
              has_sound ? "the air has a temperature" : "air of one density has no temperature");
    parts.optional("payload drag", "of its body in the air", "payload.drag_area",
                   scene.payload.drag_area.has_value());

    parts.add(event, "line-stretch", "lines come taut", !inflated, start);
    parts.add(event, "snatch", "payload and parachute have one velocity", packed, start);
    parts.add(event, "end-of-initial-phase", "the drag area begins to rise", any([](const Parachute& p) {
                  return p.deploy.by != DeployBy::inflated &&
                         (p.initial_phase.transit || p.initial_phase.seconds > 0.0);
              }),
              inflated ? start : "by parachute.initial_phase");
    parts.add(event, "full-open", "the drag area is full", true, every_run);
    parts.add(event, "peak-force", "the opening force is largest", true, every_run);
    parts.add(event, "steady-descent", "the speed no longer changes", true, stop);
    parts.add(event, "ground", "the payload lands", true, stop);
    parts.add(event, "handed-over", "the rest of the fall, to the ground, is a run of its own",
              !scene.then.empty(), scene.then.empty() ? "stop.then is absent" : then_text(scene));
    parts.add(output, "record", "key figures, history, events", true, every_run);
    parts.add(output, "fields", "frames for VTK", false, "this model has no shape");
    return std::move(parts.rows);
}

Plan plan_rom(const Scene& scene, const PlanBasis& basis) {
    Plan plan;
    plan.parts = parts_of(scene);
    std::vector<double> seconds;
    RunRecord record;
    const Stopwatch all;
    do {
        Run run;
        record = run_rom(scene, run);
        seconds.push_back(record.cost.cpu_s);
    } while (static_cast<int>(seconds.size()) < max_runs && all.wall() < 0.2 * basis.probe);
    // Processor time, since other work on the machine is none of the run's; interrupts make some runs dear.
    const auto middle = seconds.begin() + static_cast<std::ptrdiff_t>(seconds.size() / 2);
    std::ranges::nth_element(seconds, middle);

    const Channel& time = *record.find_channel("time");
    const bool packed =
        std::ranges::any_of(scene.parachutes, [](const Parachute& p) { return p.deploy.starts_packed(); });
    const std::size_t bodies = packed ? 2 : 1;
    add_bytes(plan.arrays, "state",
              2 * bodies * static_cast<std::size_t>(dimensions_of(scene)) * sizeof(double));
    add_bytes(plan.arrays, "history", time.values.size() * sizeof(HistoryRow));
    plan.stages.push_back(
        {"trajectory", 0.0, time.values.back(), static_cast<double>(record.cost.steps), *middle});
    plan.how =
        fmt::format("{} whole runs, the middle one's time: they are cheaper than any guess", seconds.size());
    return plan;
}

}  // namespace twinchute::rom
