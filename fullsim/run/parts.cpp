#include "fullsim/run/parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "fullsim/cluster.hpp"
#include "fullsim/forces/registry.hpp"
#include "lib/scene/needs.hpp"
#include "lib/solve/hand_over.hpp"

namespace twinchute::fullsim {
namespace {

const Deployment& deployment(const Scene& scene) {
    return scene.parachutes.front().deploy;
}
bool packed(const Scene& scene) {
    return deployment(scene).starts_packed();
}
bool inflated(const Scene& scene) {
    return deployment(scene).by == DeployBy::inflated;
}
bool always(const Scene&) {
    return true;
}

std::string start(const Scene& scene) {
    if (packed(scene)) return "the scene starts packed";
    return inflated(scene) ? "the scene starts with the canopy open" : "the scene starts at line stretch";
}
std::string given(std::string_view key, bool is_given) {
    return fmt::format("{} is {}", key, is_given ? "given" : "absent");
}
bool hands_over(const Scene& scene) {
    return !scene.then.empty();
}
/// Reason for a part of the change from springs to finite elements.
std::string structure(const Scene& scene) {
    if (!packed(scene)) return start(scene);
    return fmt::format("full.structure is \"{}\"", scene.full.structure == Structure::fe ? "fe" : "msd-fe");
}
bool has_springs(const Scene& scene) {
    return packed(scene) && scene.full.structure == Structure::msd_fe;
}
bool has_sound(const Scene& scene) {
    return scene.environment.atmosphere.model->has_temperature;
}
std::string sound(const Scene& scene) {
    return has_sound(scene) ? "the air has a temperature" : "air of one density has no temperature";
}
std::string stop(const Scene&) {
    return "the scene may stop there";
}
std::string every_run(const Scene&) {
    return "every run has it";
}

/// Part of a run that is not a force block.
struct Part {
    PlanPart::Kind kind;
    std::string_view name, what;
    bool (*needed)(const Scene&);
    std::string (*why)(const Scene&);
};

using enum PlanPart::Kind;

constexpr std::array parts_of_runs{
    Part{dimension, "three dimensions", "places and velocities of all nodes", &always,
         [](const Scene&) { return std::string("fabric folds in all directions"); }},
    Part{
        dimension, "folds that differ from gore to gore", "all gores are computed, not one sector",
        [](const Scene& s) { return s.full.symmetry == Symmetry::none; },
        [](const Scene& s) {
            if (s.full.symmetry == Symmetry::none) return std::string("full.symmetry is \"none\"");
            return std::string(
                "full.symmetry is \"sector\": all sectors move alike. From the pack, where they do not, that "
                "would miss 16 % of the peak");
        }},
    Part{physics, "deployment", "lines and canopy are drawn out of the pack", &packed, &start},
    Part{physics, "snatch and inflation", "the canopy fills", [](const Scene& s) { return !inflated(s); },
         &start},
    Part{physics, "settling", "an open canopy takes its load before the run begins", &inflated, &start},
    Part{physics, "wind", "the air moves", [](const Scene& s) { return s.environment.wind.has_value(); },
         [](const Scene& s) { return given("environment.wind", s.environment.wind.has_value()); }},
    Part{physics, "added mass", "air moves with the canopy",
         [](const Scene& s) { return s.aerodynamics.added_mass.has_value(); },
         [](const Scene& s) {
             return given("aerodynamics.added_mass", s.aerodynamics.added_mass.has_value());
         }},
    Part{physics, "drag area by Mach number", "a factor on the prescribed one",
         [](const Scene& s) { return s.parachutes.front().drag_area_mach_table.has_value(); },
         [](const Scene& s) {
             return given("parachute.drag_area_mach_table",
                          s.parachutes.front().drag_area_mach_table.has_value());
         }},
    Part{physics, "shape of the canopy's type", "gores and openings as the type is sewn",
         [](const Scene& s) { return !stand_in(s.parachutes.front()); },
         [](const Scene& s) {
             if (const auto other = stand_in(s.parachutes.front())) return other->what;
             if (s.parachutes.front().mesh) return given("parachute.mesh", true);
             return std::string("the canopy is flat circular");
         }},
    Part{physics, "Mach number", "what is subsonic is judged by it", &has_sound, &sound},
    Part{physics, "turning of the payload",
         "it is a body of one density, of tetrahedra lumped into a rigid one or each by itself",
         [](const Scene& s) { return s.payload.body.has_value(); },
         [](const Scene& s) { return given("payload.body", s.payload.body.has_value()); }},
    Part{physics, "slings of the payload", "four, whose apex is fixed to the body",
         [](const Scene& s) { return s.payload.body && s.payload.body->sling_length; },
         [](const Scene& s) {
             return s.payload.body
                        ? given("payload.body.sling_length", s.payload.body->sling_length.has_value())
                        : given("payload.body", false);
         }},
    Part{physics, "attitude of the payload in the air",
         "its drag area follows the angle that it turns to the air",
         [](const Scene& s) { return s.payload.body && s.payload.drag_area_table; },
         [](const Scene& s) {
             if (!s.payload.drag_area_table) return given("payload.drag_area_table", false);
             if (!s.payload.body) return std::string("payload.body is absent: a point mass hangs straight");
             return given("payload.drag_area_table", true);
         }},
    Part{physics, "contact between canopies", "along a plane, without friction",
         [](const Scene& s) { return s.parachutes.front().count > 1; },
         [](const Scene& s) { return fmt::format("parachute.count is {}", s.parachutes.front().count); }},
    Part{physics, "initial noise", "the canopy's nodes start a little displaced",
         [](const Scene& s) { return s.full.noise.has_value(); },
         [](const Scene& s) { return given("full.noise", s.full.noise.has_value()); }},

    Part{event, "release", "the run begins with a pack", &packed, &start},
    Part{event, "line-stretch", "the run begins with lines drawn out",
         [](const Scene& s) { return !packed(s) && !inflated(s); }, &start},
    Part{event, "snatch", "lines come under load, the canopy begins to fill", &packed, &start},
    Part{event, "end-of-initial-phase", "the drag area begins to rise",
         [](const Scene& s) {
             const InitialPhase& initial = s.parachutes.front().initial_phase;
             return !inflated(s) && (initial.transit || initial.seconds > 0.0);
         },
         [](const Scene& s) { return inflated(s) ? start(s) : std::string("by parachute.initial_phase"); }},
    Part{event, "switch", "finite elements begin to take over from springs", &has_springs, &structure},
    Part{event, "finite-elements-alone", "springs are dropped", &has_springs, &structure},
    Part{event, "full-open", "the drag area is full", &always, &every_run},
    Part{event, "canopy-filled", "the projected area first reaches 98 % of its steady mean",
         [](const Scene& s) { return !inflated(s); }, &start},
    Part{event, "peak-force", "the opening force is largest", &always, &every_run},
    Part{event, "steady-descent", "the speed no longer changes", &always, &stop},
    Part{event, "ground", "the payload lands", &always, &stop},
    Part{event, "handed-over", "another model flies the rest of the fall, to the ground", &hands_over,
         [](const Scene& s) { return hands_over(s) ? then_text(s) : given("stop.then", false); }},

    Part{output, "record", "key figures, history, events", &always, &every_run},
    Part{output, "fields", "frames for VTK", [](const Scene& s) { return s.full.fields_rate.has_value(); },
         [](const Scene& s) { return given("full.fields_rate", s.full.fields_rate.has_value()); }},
};

PlanPart part_of(const ForceBlock& block, const Scene& scene) {
    std::string when;
    for (const Stage stage : stages_with(block, scene))
        when += (when.empty() ? "" : ", ") + std::string(stage_name(stage));
    return {PlanPart::Kind::block, std::string(block.name), when, !when.empty(), block.why(scene)};
}

}  // namespace

std::vector<PlanPart> parts_of(const Scene& scene) {
    std::vector<PlanPart> parts;
    if (scene.parachutes.size() > 1) {  // what any of them needs
        const PayloadFlight start = released_payload(scene);
        for (std::size_t p = 0; p < scene.parachutes.size(); ++p) {
            std::vector<PlanPart> own = parts_of(scene_in_flight(scene, p, start));
            if (p == 0) parts = own;
            for (std::size_t i = 0; i < own.size(); ++i) {
                if (!own[i].needed) continue;
                if (parts[i].needed && p > 0) continue;
                parts[i] = own[i];
                parts[i].why = scene.parachutes[p].name + ": " + parts[i].why;
            }
        }
        return parts;
    }
    for (const Part& part : parts_of_runs)
        parts.push_back(
            {part.kind, std::string(part.name), std::string(part.what), part.needed(scene), part.why(scene)});
    for (const ForceBlock& block : force_blocks())
        parts.push_back(part_of(block, scene));
    std::ranges::stable_sort(parts, {}, &PlanPart::kind);
    return parts;
}

}  // namespace twinchute::fullsim
