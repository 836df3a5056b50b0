// Stiff and extreme cases of the full model, on few elements.
#include <fmt/format.h>

#include <cmath>

#include "compare/stability/base_scenes.hpp"
#include "compare/stability/cases.hpp"
#include "compare/stability/checks.hpp"
#include "lib/math/vec.hpp"

namespace twinchute::compare {
namespace {

const StabilityMethod whole{"whole", [](Scene& s) { s.full.symmetry = Symmetry::none; }};
const StabilityMethod sector{"sector", [](Scene& s) { s.full.symmetry = Symmetry::sector; }};
/// All gores on node records, as imported and graded meshes are: these are regular, so that their own layout
/// has to give the same forces.
StabilityMethod unstructured() {
    return {"unstructured", whole.choose, true, same_in_the_layout_of_its_mesh()};
}
const StabilityMethod springs{"msd-fe", [](Scene& s) { s.full.structure = Structure::msd_fe; }};
const StabilityMethod elements{"fe", [](Scene& s) { s.full.structure = Structure::fe; }};

/// From line stretch, straight down: all gores, or one that stands for all.
std::span<const StabilityMethod> layouts() {
    static const std::vector<StabilityMethod> rows{whole, unstructured(), sector};
    return rows;
}
std::span<const StabilityMethod> without_sector() {
    static const std::vector<StabilityMethod> rows{whole, unstructured()};
    return rows;
}
/// A sector has a layout of its own and none besides.
std::span<const StabilityMethod> sector_alone() {
    static const std::vector<StabilityMethod> rows{sector};
    return rows;
}
/// From the pack, which is chaotic: forces of two layouts are as far apart as those of two seeds.
std::span<const StabilityMethod> structures() {
    static const std::vector<StabilityMethod> rows{springs,
                                                   {"msd-fe, unstructured", springs.choose, true},
                                                   elements,
                                                   {"fe, unstructured", elements.choose, true}};
    return rows;
}

struct Row {
    std::string name, why;
    Scene (*base)();
    std::function<void(Scene&)> change;
    std::span<const StabilityMethod> methods;
    Check check = {};
    std::vector<StatusCode> causes = {};
    bool quick = true;
    std::function<std::optional<std::int64_t>(const Trial&)> latency = {};
};

/// Checks of every opening: energy, and forces that do not hang on the step.
Check sound_opening() {
    return all_of({energy_closes(), same_in_half_the_step()});
}
/// Checks of every opening and the payload's own balance, where all of it is vertical.
Check sound_drop() {
    return all_of({energy_closes(), same_in_half_the_step(), payload_momentum()});
}

std::vector<Row> structure_rows() {
    std::vector<Row> rows;
    rows.push_back({"as shipped, few elements",
                    "nothing: the scale of the others",
                    c9_coarse,
                    {},
                    layouts(),
                    sound_drop(),
                    {},
                    false});
    for (const double modulus : {9.7e8, 9.7e9, 9.7e10, 9.7e11, 9.7e12})
        rows.push_back(
            {fmt::format("line modulus {:.1e} Pa", modulus),
             "the critical time step goes with its root; slack lines chatter between slack and taut",
             c9_coarse,
             [modulus](Scene& s) {
                 s.parachutes.front().line.youngs_modulus = modulus;
                 stop_after(s, 2.0);  // the peak comes at 1.5 s
             },
             layouts(),
             sound_drop(),
             {},
             modulus < 1e9});
    rows.push_back({"168 triangles", "one triangle from seam to seam, three rows", c9_coarse,
                    [](Scene& s) {
                        s.full.mesh = {1, 3, 1, 1};
                        s.full.line_substeps = 1;
                    },
                    layouts(), sound_drop()});
    rows.push_back({"35 644 triangles",
                    "small elements, short steps",
                    c9_coarse,
                    [](Scene& s) {
                        s.full.mesh = {8, 80, 6, 2};
                        stop_after(s, 0.02);
                    },
                    without_sector(),
                    energy_closes(),
                    {},
                    false});
    rows.push_back({"slivers at the vent",
                    "equal rows: at the vent triangles 40 times as long as wide",
                    c9_coarse,
                    [](Scene& s) {
                        s.full.mesh = {4, 4, 6, 2, Grading::uniform};
                        stop_after(s, 0.3);
                    },
                    layouts(),
                    sound_drop(),
                    {},
                    false});
    return rows;
}

std::vector<Row> load_rows() {
    std::vector<Row> rows;
    for (const double mass : {1.0, 0.01})
        rows.push_back({fmt::format("payload of {:g} kg", mass),
                        "lighter than its parachute, and than the air that moves with it",
                        c9_coarse,
                        [mass](Scene& s) {
                            s.payload.mass = mass;
                            stop_after(s, 1.0);
                        },
                        layouts(),
                        mass < 0.1 ? all_of({energy_closes(), same_within_its_scatter()}) : sound_opening(),
                        {},
                        false});
    rows.push_back({"release at 210 m/s",
                    "a hundred times the dynamic pressure: nylon would break",
                    c9_coarse,
                    [](Scene& s) {
                        s.release = {3000.0, 210.0, 0.5 * pi, 0.5 * pi};
                        stop_after(s, 0.4);
                    },
                    layouts(),
                    sound_drop(),
                    {StatusCode::strain_limit}});
    rows.push_back({"30 km",
                    "1/67 of the density: next to no damping by the air",
                    c9_coarse,
                    [](Scene& s) {
                        s.environment.atmosphere = {find_atmosphere("us76")};
                        s.release = {30000.0, 100.0, 0.5 * pi, 0.5 * pi};
                        stop_after(s, 1.0);
                    },
                    layouts(),
                    sound_drop(),
                    {},
                    false});
    rows.push_back({"line stretch at rest",
                    "no air that would hold lines and canopy out",
                    c9_coarse,
                    [](Scene& s) { s.release.speed = 0.0; },
                    layouts(),
                    {},
                    {StatusCode::refused}});
    rows.push_back({"open canopy at rest", "no dynamic pressure, no direction of the air", c9_coarse,
                    [](Scene& s) {
                        s.release.speed = 0.0;
                        s.parachutes.front().deploy.by = DeployBy::inflated;
                        s.aerodynamics.line_drag.reset();
                        s.aerodynamics.added_mass.reset();
                        stop_after(s, 1.0);
                    },
                    layouts(), all_of({energy_closes(), payload_momentum(), fall_of_the_mesh()})});
    rows.push_back({"descent to the terminal speed",
                    "a closed form for what the balance of forces must be",
                    c9_coarse,
                    [](Scene& s) {
                        s.aerodynamics.line_drag.reset();
                        stop_after(s, 6.0);
                    },
                    layouts(),
                    all_of({energy_closes(), terminal_speed_of_the_mesh()}),
                    {},
                    false});
    for (const double degrees : {30.0, 60.0}) {
        const auto change = [degrees](Scene& s) {
            s.release.path_angle = degrees * pi / 180.0;
            s.aerodynamics.line_drag.reset();
            stop_after(s, 15.0);
        };
        rows.push_back({fmt::format("oblique, {:g} deg below the horizon", degrees),
                        "a pendulum below the canopy: with the wrong reference velocity it swings up in 13 s",
                        c9_coarse,
                        change,
                        without_sector(),
                        all_of({sound_opening(), terminal_speed_of_the_mesh()}),
                        {},
                        false});
        rows.push_back({fmt::format("oblique, {:g} deg, one sector", degrees),
                        "no sector stands for a canopy that meets the air from one side",
                        c9_coarse,
                        change,
                        sector_alone(),
                        {},
                        {StatusCode::refused}});
    }
    return rows;
}

std::vector<Row> pack_rows() {
    std::vector<Row> rows;
    for (const double ratio : {1e-2, 1e-4})
        rows.push_back(
            {fmt::format("packed to {:g}", ratio),
             fmt::format("lines and canopy within {:.2g} m; they come taut in an impact when drawn out",
                         12.8 * ratio),
             c9_packed,
             [ratio](Scene& s) { s.parachutes.front().deploy.pack_ratio = ratio; },
             structures(),
             all_of({energy_closes(), snatch_speed_of_a_drop()}),
             {},
             false});
    rows.push_back({"packed, printed line modulus",
                    "the snatch on lines a hundred times as stiff",
                    c9_packed,
                    [](Scene& s) {
                        s.parachutes.front().line.youngs_modulus = 9.7e10;
                        s.full.time_step_factor = 0.5;
                        stop_after(s, 2.8);
                    },
                    structures(),
                    all_of({energy_closes(), snatch_speed_of_a_drop()}),
                    {StatusCode::energy_grew},
                    false});
    return rows;
}

/// A filling that is predicted: its balance of the air is stiff where little air moves much fabric.
std::vector<Row> filling_rows() {
    // Forces of two layouts grow apart.
    static const std::vector<StabilityMethod> chaotic{whole, {"unstructured", whole.choose, true}, sector};
    const auto mouth = [](Scene& s) {
        Filling& filling = s.parachutes.front().filling;
        filling.initial_mouth = filling.lowest_mouth = 0.002;
    };
    const auto fabric = [](double speed) {
        return [speed](Scene& s) {
            s.parachutes.front().fabric.permeability = permeability_at_half_inch(speed);
        };
    };
    const auto fast = [](Scene& s) {
        s.release = {3000.0, 150.0, 0.5 * pi, 0.5 * pi};
        stop_after(s, 0.5);
    };
    const auto light = [](Scene& s) { s.payload.mass = 1.0; };
    const auto slow = [](Scene& s) { s.release.speed = 3.0; };
    const Check scattered = all_of({energy_closes(), same_within_its_scatter()});
    constexpr auto base = c9_that_fills_itself;
    std::vector<Row> rows{
        {"predicted filling", "nothing: the scale of the others", base, {}, layouts(), sound_drop()},
        {"predicted, mouth of 0.002", "air that moves the fabric at once: explicit, it would ring", base,
         mouth, chaotic, scattered},
        {"predicted, fabric of 3 m/s", "the leak answers the pressure that it makes", base, fabric(3.0),
         layouts(), sound_drop()},
        {"predicted, tight fabric", "no leak that would damp", base, fabric(0.0), layouts(), sound_drop()},
        {"predicted, payload of 1 kg", "it stops before its canopy is full", base, light, layouts(),
         sound_opening()},
        {"predicted, 150 m/s", "fifty times the dynamic pressure", base, fast, layouts(), sound_drop()},
        {"predicted, slack lines", "at 3 m/s the air hardly holds the canopy out", base, slow, chaotic,
         scattered},
    };
    for (std::size_t i = 1; i < rows.size(); ++i)
        rows[i].quick = false;
    return rows;
}

/// The bound is 0.5 to 1 of the true limit. Up to it a run has to be right; above it, right or named.
std::vector<Row> step_rows() {
    std::vector<Row> rows;
    for (const double factor : {0.5, 0.95, 1.05, 1.5, 2.0, 3.0, 4.0}) {
        std::vector<StatusCode> causes;
        if (factor > 1.0)
            causes = {StatusCode::energy_grew, StatusCode::solver_failed, StatusCode::not_finite,
                      StatusCode::strain_limit};
        rows.push_back({fmt::format("step of {:g} times its bound", factor),
                        factor > 1.0 ? "above the bound: errors may grow with every step"
                                     : "below the bound: has to be right",
                        c9_coarse,
                        [factor](Scene& s) {
                            s.full.time_step_factor = factor;
                            s.full.output_rate = 2000.0;  // to see the first sign
                        },
                        layouts(),
                        [factor](const Trial& trial) {
                            // Against half of a step that is known to be sound, not half of this one.
                            Scene scene = trial.scene;
                            scene.full.time_step_factor = std::min(factor, 0.95);
                            auto findings = same_in_half_the_step()(
                                {scene, trial.record, trial.fidelity, trial.stop, trial.force_unstructured});
                            for (Finding& f : energy_closes()(trial))
                                findings.push_back(std::move(f));
                            return findings;
                        },
                        std::move(causes), false,
                        [](const Trial& trial) { return steps_since_first_sign(trial, 0.5); }});
    }
    return rows;
}

}  // namespace

std::vector<StabilityCase> full_cases() {
    std::vector<StabilityCase> cases;
    for (auto rows : {structure_rows(), load_rows(), pack_rows(), filling_rows(), step_rows()})
        for (Row& row : rows) {
            StabilityCase c;
            c.name = std::move(row.name);
            c.why = std::move(row.why);
            c.fidelity = "full";
            c.base = row.base;
            c.change = std::move(row.change);
            c.methods = row.methods;
            c.check = std::move(row.check);
            c.causes = std::move(row.causes);
            c.quick = row.quick;
            c.latency = std::move(row.latency);
            cases.push_back(std::move(c));
        }
    return cases;
}

}  // namespace twinchute::compare
