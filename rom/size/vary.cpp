#include "rom/size/vary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/math/vec.hpp"
#include "lib/scene/drag_area.hpp"
#include "lib/scene/needs.hpp"
#include "lib/scene/scale_canopy.hpp"

namespace twinchute::rom {
namespace {

/// [m] Smallest that anyone drops anything under, and largest that a scene may say.
constexpr double smallest_diameter = 0.02, largest_diameter = 199.0;
/// [m/s] The models are subsonic.
constexpr double fastest_release = 340.0;

std::size_t sized_index(const Scene& scene) {
    if (!scene.size || scene.size->parachute.empty()) return 0;
    const auto named = std::ranges::find(scene.parachutes, scene.size->parachute, &Parachute::name);
    return static_cast<std::size_t>(named - scene.parachutes.begin());
}

/// By the scene itself, rather than a type, a design or a default.
bool is_given(const Scene& scene, std::string_view name) {
    const std::string whose = scene.parachutes.size() > 1 ? sized_parachute(scene).name + "." : "";
    const std::string key = fmt::format("parachute.{}{}", whose, name);
    const auto input = std::ranges::find(scene.inputs, key, &Input::key);
    return input != scene.inputs.end() && input->origin == InputOrigin::given;
}

double diameter(const Scene& scene) {
    return sized_parachute(scene).nominal_diameter;
}

/// Scales the parachute at one shape: vent, lines and risers with it, C_D0 as it is, as many gores.
void set_diameter(Scene& scene, double value) {
    Parachute& p = scene.parachutes[sized_index(scene)];
    scale_canopy(p, value, [](std::string_view) { return true; });
    set_drag_area(scene, p, p.drag_area);
}

/// Where a descent rate is asked for the smallest canopy that has it; otherwise the largest that the forces
/// allow.
Goal goal_of_diameter(const SizeSpec& size) {
    return size.max_descent_rate ? Goal::smallest : Goal::largest;
}

Bounds bounds_of_diameter(const Scene& scene) {
    const double near = scene.size->max_descent_rate ? diameter_by_descent_rate(scene) : diameter(scene);
    // The closed form is a few per cent off, so that smaller ones need no search; larger ones open
    // differently.
    const double below = scene.size->max_descent_rate ? 2.0 : 10.0,
                 above = scene.size->max_descent_rate ? 3.0 : 10.0;
    return {near / below, std::min(near * above, largest_diameter)};
}

Bounds ends_of_diameter(const Scene& scene) {
    const auto [low, high] = bounds_of_diameter(scene);
    return {std::min(low, smallest_diameter), std::max(high, largest_diameter)};
}

std::string always_available(const Scene&) {
    return {};
}

std::string requires_reefing(const Scene& scene) {
    return sized_parachute(scene).reefing.empty() ? "the scene has no [[parachute.reefing]]" : "";
}

Goal min_load(const SizeSpec&) {
    return Goal::min_load;
}

/// From just above what the canopy begins with to just below what comes next.
Bounds bounds_of_ratio(const Scene& scene) {
    const Parachute& p = sized_parachute(scene);
    const double next = p.reefing.size() > 1 ? p.reefing[1].drag_area_ratio : 1.0;
    const double first = p.filling.is_predicted() ? p.filling.initial_mouth : p.initial_drag_area_ratio;
    return {std::max(1.01 * first, 0.005), 0.95 * next};
}

Bounds bounds_of_speed(const Scene&) {
    return {1.0, fastest_release};
}
Bounds bounds_of_delay(const Scene&) {
    return {0.2, 30.0};
}

constexpr std::array<VaryRow, 4> vary_table{{
    {"nominal_diameter", "m", "nominal diameter D0",
     "vent, lines, risers, reefing lines and drag area grow with it, C_D0 and gores stay", always_available,
     goal_of_diameter, bounds_of_diameter, ends_of_diameter, diameter, set_diameter},
    {"release_speed", "m/s", "release speed over ground", "in the direction of the scene", always_available,
     [](const SizeSpec&) { return Goal::largest; }, bounds_of_speed, bounds_of_speed,
     [](const Scene& scene) { return scene.release.speed; },
     [](Scene& scene, double value) { scene.release.speed = value; }},
    {"reefing_ratio", "", "drag area of the first reefed stage over (C_D S)_0", "with the least load",
     requires_reefing, min_load, bounds_of_ratio, bounds_of_ratio,
     [](const Scene& scene) { return sized_parachute(scene).reefing.front().drag_area_ratio; },
     [](Scene& scene, double value) {
         scene.parachutes[sized_index(scene)].reefing.front().drag_area_ratio = value;
     }},
    {"cutter_delay", "s", "delay of the first cutter", "with the least load", requires_reefing, min_load,
     bounds_of_delay, bounds_of_delay,
     [](const Scene& scene) { return sized_parachute(scene).reefing.front().until.delay; },
     [](Scene& scene, double value) {
         scene.parachutes[sized_index(scene)].reefing.front().until.delay = value;
     }},
}};

}  // namespace

std::span<const VaryRow> vary_rows() {
    return vary_table;
}

const VaryRow* find_vary(std::string_view name) {
    const auto row = std::ranges::find(vary_table, name, &VaryRow::name);
    return row == vary_table.end() ? nullptr : &*row;
}

const Parachute& sized_parachute(const Scene& scene) {
    return scene.parachutes[sized_index(scene)];
}

double diameter_by_descent_rate(const Scene& scene) {
    const Parachute& p = sized_parachute(scene);
    const Environment& e = scene.environment;
    const double speed = *scene.size->max_descent_rate;
    const double coefficient =
        p.count * p.cluster_drag_ratio * p.drag_area / (0.25 * pi * p.nominal_diameter * p.nominal_diameter);
    double mass = scene.payload.mass, others = scene.payload.drag_area.value_or(0.0);
    for (const Parachute& one : scene.parachutes) {
        if (one.cut && &one != &p) continue;
        mass += one.count * one.mass;
        if (&one != &p) others += one.count * one.cluster_drag_ratio * one.drag_area;
    }
    const double density = e.atmosphere.at(e.ground).density, weight = mass * e.gravity;
    const double carried = std::max(weight - 0.5 * density * speed * speed * others, 0.01 * weight);
    return std::sqrt(8.0 * carried / (pi * density * coefficient)) / speed;
}

Scene with_type(const Scene& scene, const CanopyType& type, std::vector<std::string>& notes) {
    Scene changed = scene;
    Parachute& p = changed.parachutes[sized_index(scene)];
    if (p.type && p.type->name == type.name) return changed;
    p.type = type;
    std::vector<std::string> kept;
    const auto take = [&](const std::optional<TypeRange>& range, const char* name, auto&& set) {
        if (range && range->may_be_default())
            set(range->middle());
        else
            kept.emplace_back(name);
    };
    take(type.projected_diameter_ratio, "D_p/D0", [&](double ratio) { p.projected_diameter_ratio = ratio; });
    take(type.drag_coefficient, "C_D0", [&](double coefficient) {
        set_drag_area(changed, p, coefficient * 0.25 * pi * p.nominal_diameter * p.nominal_diameter);
    });
    p.opening_force_coefficient.reset();  // another type's would be wrong
    if (type.opening_force_coefficient && type.opening_force_coefficient->may_be_default())
        p.opening_force_coefficient = type.opening_force_coefficient->middle();
    const bool predicted = p.filling.is_predicted();
    if (!predicted && p.fill_time.model->name == "fill-constant" && !is_given(scene, "fill_time.n"))
        take(type.fill_constant, "n", [&](double n) {
            p.fill_time = {};
            p.fill_time.model = find_fill_time("fill-constant");
            p.fill_time.n = n;
        });
    if (!predicted && !is_given(scene, "drag_area_law") && !p.drag_area_table && !p.drag_area_exponent)
        take(type.growth_exponent, "law of growth", [&](double j) {
            if (const DragAreaLaw* law = find_drag_area_law(fmt::format("power-{:g}", j)))
                p.drag_area_law = law;
        });
    if (!kept.empty())
        notes.push_back(
            fmt::format("{} as in the scene: the catalogue has none for this type", fmt::join(kept, ", ")));
    return changed;
}

std::string mass_text(const Parachute& chute) {
    return missing_structure(chute).empty()
               ? "the scene's mass, scaled by fabric, tapes, lines and risers of its materials"
               : "the scene's mass, scaled by the nominal area: a canopy for larger loads is heavier for its "
                 "area";
}

}  // namespace twinchute::rom
