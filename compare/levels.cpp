#include "compare/levels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "compare/physics_effects.hpp"
#include "lib/scene/keys.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/solve/sundials.hpp"

namespace twinchute::compare {
namespace {

constexpr std::string_view closed = "closed form", rom = "rom", methods = "rom, other methods",
                           rom_without = "rom, without an effect", full = "full", in_time = "full, time step",
                           full_without = "full, without an effect";

/// Beyond the last one of a user's interest, as reference.
constexpr std::array tolerances{1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13};
constexpr std::array tolerances_of_methods{1e-4, 1e-6, 1e-8};

/// Elements in each direction, in those of the scene. An explicit run costs the third power: twice as many
/// each way are four times the elements in steps of half the length.
struct MeshRow {
    std::string_view word;
    double factor;
};
constexpr std::array meshes{MeshRow{"coarse", 0.5}, MeshRow{"default", 1.0}, MeshRow{"medium", 1.5},
                            MeshRow{"fine", 2.0}, MeshRow{"finest", 3.0}};
constexpr std::array time_steps{0.5, 0.25};

int scaled(int count, double factor, const char* key) {
    const KeyRange range = find_key(scene_keys(), key)->range;
    return static_cast<int>(std::clamp(std::round(count * factor), range.low, range.high));
}

void scale_mesh(MeshCounts& mesh, double factor) {
    mesh.gore_columns = scaled(mesh.gore_columns, factor, "full.mesh.gore_columns");
    mesh.gore_rows = scaled(mesh.gore_rows, factor, "full.mesh.gore_rows");
    mesh.line_elements = scaled(mesh.line_elements, factor, "full.mesh.line_elements");
    mesh.riser_elements = scaled(mesh.riser_elements, factor, "full.mesh.riser_elements");
}

/// [m/s] at which drag carries the weight, in the air at the release.
double steady_descent(const Scene& scene) {
    const Parachute& chute = scene.parachutes.front();
    const double weight = (scene.payload.mass + chute.mass) * scene.environment.gravity;
    const double area = chute.drag_area + scene.payload.drag_area.value_or(0.0);
    return std::sqrt(2.0 * weight / (scene.environment.atmosphere.at(scene.release.altitude).density * area));
}

/// [s] of a canopy that snatches at release.
double filling_time(const Scene& scene) {
    const Parachute& chute = scene.parachutes.front();
    Vec3 velocity = velocity_over_ground(scene.release);
    if (scene.environment.wind) velocity -= scene.environment.wind->at(scene.release.altitude);
    const double density = scene.environment.atmosphere.at(scene.release.altitude).density;
    return chute.fill_time.seconds(fill_inputs(scene, chute, velocity.norm(), density));
}

void add_closed_forms(std::vector<Level>& levels, const Scene& scene) {
    const Deployment& deploy = scene.parachutes.front().deploy;
    const auto add = [&](const char* name, const char* why, const char* metric) -> Level& {
        Level level{.name = name, .label = name, .family = std::string(closed), .why = why};
        level.physics = Physics::other;
        level.metric = metric;
        levels.push_back(std::move(level));
        return levels.back();
    };
    add("descent balance", "weight over drag area, air of the release", "descent_rate").closed_form =
        [scene] { return steady_descent(scene); };
    if (deploy.by == DeployBy::line_stretch)
        add("filling correlation", "filling time of the scene's correlation", "filling_time").closed_form =
            [scene] { return filling_time(scene); };
    if (!deploy.starts_packed()) return;
    // Both need the speed at which the lines come taut, so that they cost the fall until then.
    for (const auto& [name, why, key] :
         {std::array{"snatch, mass and spring", "lines without mass: dv sqrt(k m)",
                     "snatch_force_mass_spring_N"},
          std::array{"snatch, first wave", "lines as a wave guide: dv sqrt(EA mu)", "snatch_force_wave_N"}}) {
        Level& level = add(name, why, "snatch_force");
        level.fidelity = rom;
        level.key = key;
        level.cost = 1.0;
        level.change = [](Scene& s) { s.stop = {Trigger::Kind::line_stretch, 0.0, 0.0}; };
    }
}

bool same_tolerance(double a, double b) {
    return std::abs(a - b) <= 1e-9 * b;
}

/// "1e-4", where fmt writes 0.0001.
std::string tolerance_word(double rtol) {
    const int exponent = static_cast<int>(std::floor(std::log10(rtol) + 1e-9));
    return fmt::format("{:.3g}e{}", rtol / std::pow(10.0, exponent), exponent);
}

void add_rom(std::vector<Level>& levels, const Scene& scene) {
    std::vector<double> all(tolerances.begin(), tolerances.end());
    if (std::ranges::none_of(all, [&](double r) { return same_tolerance(r, scene.rom.rtol); }))
        all.push_back(scene.rom.rtol);
    std::ranges::sort(all, std::greater<>());
    for (const double rtol : all) {
        Level level{.name = "rom, rtol " + tolerance_word(rtol),
                    .label = tolerance_word(rtol),
                    .family = std::string(rom)};
        level.fidelity = rom;
        level.given = same_tolerance(rtol, scene.rom.rtol);
        level.why = level.given ? "the scene as it is" : "tolerance of the integrator";
        if (!level.given) level.change = [rtol](Scene& s) { s.rom.rtol = rtol; };
        level.sequence = "tolerance";
        level.cost = 1.0;
        levels.push_back(std::move(level));
    }
    for (const OdeMethod& method : ode_methods()) {
        if (method.name == scene.rom.method) continue;
        for (const double rtol : tolerances_of_methods) {
            Level level{
                .name = fmt::format("rom, {}, rtol {}", method.name, tolerance_word(rtol)),
                .label = fmt::format("{} {}", method.name, tolerance_word(rtol)),
                .family = std::string(methods),
                .why = fmt::format("a method of order {}{}", method.multistep ? "up to " : "", method.order)};
            level.fidelity = rom;
            level.change = [name = std::string(method.name), rtol](Scene& s) { s.rom = {name, rtol}; };
            level.cost = 1.0;
            levels.push_back(std::move(level));
        }
    }
}

void add_full(std::vector<Level>& levels) {
    for (const MeshRow& mesh : meshes) {
        Level level{.name = fmt::format("full, mesh x{:g}", mesh.factor),
                    .label = fmt::format("mesh x{:g}", mesh.factor),
                    .family = std::string(full)};
        level.fidelity = full;
        level.given = mesh.factor == 1.0;
        level.why = level.given ? std::string("the scene as it is") : fmt::format("{} mesh", mesh.word);
        if (!level.given)
            level.change = [factor = mesh.factor](Scene& s) { scale_mesh(s.full.mesh, factor); };
        level.sequence = "mesh";
        level.cost = std::pow(mesh.factor, 3);
        levels.push_back(std::move(level));
    }
    for (const double share : time_steps) {
        Level level{.name = fmt::format("full, time step x{:g}", share),
                    .label = fmt::format("dt x{:g}", share),
                    .family = std::string(in_time),
                    .why = "time step on the mesh of the scene"};
        level.fidelity = full;
        level.change = [share](Scene& s) { s.full.time_step_factor *= share; };
        level.sequence = "time step";
        level.cost = 1.0 / share;
        levels.push_back(std::move(level));
    }
}

void add_without(std::vector<Level>& levels, const Scene& scene, std::string_view fidelity) {
    for (const PhysicsEffect& effect : physics_effects()) {
        if (effect.level.empty() || !effect.present(scene) || (fidelity == rom && !effect.in_rom)) continue;
        Level level{.name = fmt::format("{}, {}", fidelity, effect.level),
                    .label = std::string(effect.level),
                    .family = std::string(fidelity == rom ? rom_without : full_without),
                    .why = std::string(effect.why)};
        level.fidelity = fidelity;
        level.change = effect.remove;
        level.physics = Physics::other;
        level.cost = effect.cost;
        levels.push_back(std::move(level));
    }
}

}  // namespace

std::vector<Level> ladder_levels(const Scene& scene) {
    std::vector<Level> levels;
    add_closed_forms(levels, scene);
    add_rom(levels, scene);
    add_without(levels, scene, rom);
    add_full(levels);
    add_without(levels, scene, full);
    return levels;
}

Scene scene_of(const Level& level, const Scene& scene, std::optional<std::uint64_t> seed) {
    Scene changed = scene;
    changed.full.fields_rate.reset();  // nobody looks at them here
    if (level.change) level.change(changed);
    if (seed && changed.full.noise) changed.full.noise->seed = *seed;
    return changed;
}

std::string setting_of(const Level& level, const Scene& scene) {
    if (level.closed_form) return "closed form";
    const Scene changed = scene_of(level, scene);
    std::string text;
    const auto say = [&](std::string_view key, const auto& before, const auto& after) {
        if (before == after) return;
        fmt::format_to(std::back_inserter(text), "{}{}={}", text.empty() ? "" : " ", key, after);
    };
    const MeshCounts &old_mesh = scene.full.mesh, &mesh = changed.full.mesh;
    const auto structure = [](const Scene& s) { return s.full.structure == Structure::fe ? "fe" : "msd-fe"; };
    const auto symmetry = [](const Scene& s) {
        return s.full.symmetry == Symmetry::sector ? "sector" : "none";
    };
    say("rom.method", scene.rom.method, changed.rom.method);
    say("rom.rtol", scene.rom.rtol, changed.rom.rtol);
    say("full.mesh.gore_columns", old_mesh.gore_columns, mesh.gore_columns);
    say("full.mesh.gore_rows", old_mesh.gore_rows, mesh.gore_rows);
    say("full.mesh.line_elements", old_mesh.line_elements, mesh.line_elements);
    say("full.mesh.riser_elements", old_mesh.riser_elements, mesh.riser_elements);
    say("full.time_step_factor", scene.full.time_step_factor, changed.full.time_step_factor);
    say("full.structure", std::string_view(structure(scene)), std::string_view(structure(changed)));
    say("full.symmetry", std::string_view(symmetry(scene)), std::string_view(symmetry(changed)));
    say("full.alpha", scene.full.alpha, changed.full.alpha);
    say("full.beta", scene.full.beta, changed.full.beta);
    say("full.bulk_viscosity", scene.full.bulk_viscosity, changed.full.bulk_viscosity);
    if (scene.stop.kind != changed.stop.kind) text += "stop.at=line-stretch";
    if (!text.empty()) return text;
    return level.given ? "as given" : level.label;
}

double mesh_size(const Scene& scene) {
    return 1.0 / std::sqrt(static_cast<double>(scene.full.mesh.gore_columns) * scene.full.mesh.gore_rows);
}

}  // namespace twinchute::compare
