// Endings of a run that are no answer: each says what to do about it, in keys of the scene.
#include <algorithm>
#include <functional>
#include <set>

#include "lib/scene/keys.hpp"
#include "lib/solve/sundials.hpp"
#include "rom/run_context.hpp"
#include "tests/support/c9_scene.hpp"
#include "tests/support/hard_extractions.hpp"
#include "tests/support/runs.hpp"

#include <gtest/gtest.h>

namespace twinchute::test {
namespace {

/// Whether a text names a key of the scene, or a table of keys below another one: "full.mesh".
bool names_a_key(std::string_view text) {
    return std::ranges::any_of(scene_keys(), [&](const Key& key) {
        const std::string_view table = key.path.substr(0, key.path.rfind('.'));
        const auto found = [&](std::string_view path) {
            return path.find('.') != path.npos && text.find(path) != text.npos;
        };
        return found(key.path) || found(table);
    });
}

struct Trouble {
    const char* what;
    StatusCode ending;
    RunRecord (*run)(const Scene&);
    std::function<void(Scene&)> make;
};

RunRecord by_rom(const Scene& scene) {
    return run_rom(scene);
}
RunRecord by_full(const Scene& scene) {
    return run_full(scene);
}

Atmosphere almost_nothing() {
    Atmosphere air;
    air.model = find_atmosphere("constant");
    air.constant_density = 1e-12;
    return air;
}

/// Payload and pack fall alike in next to no air: the lines never come taut.
void falls_beside_its_pack(Scene& scene) {
    scene = packed_c9(DeployBy::free);
    scene.release.altitude = 40000.0;
    scene.environment.ground = -1e6;
    scene.environment.atmosphere = almost_nothing();
    scene.full.mesh = {1, 4, 2, 1};
    scene.stop = {Trigger::Kind::steady_descent, 0.0, 0.0};
}

void short_full(Scene& scene) {
    scene.full.mesh = {1, 5, 4, 1};
    scene.stop = {Trigger::Kind::time, 2.0, 0.0};
}

const Trouble troubles[] = {
    {"rom: never steady", StatusCode::time_limit, by_rom,
     [](Scene& s) {
         s.release.altitude = 5e4;
         s.environment.ground = -1e12;
         s.environment.atmosphere = almost_nothing();
         s.stop = {Trigger::Kind::steady_descent, 0.0, 0.0};
     }},
    {"rom: lines that never come taut", StatusCode::time_limit, by_rom, falls_beside_its_pack},
    {"rom: initial phase longer than the filling", StatusCode::refused, by_rom,
     [](Scene& s) {
         s = packed_c9(DeployBy::static_line);
         s.parachutes.front().initial_phase = {false, 50.0};
     }},
    {"full: the same", StatusCode::refused, by_full,
     [](Scene& s) {
         s = packed_c9(DeployBy::static_line);
         s.full.mesh = {1, 4, 4, 1};
         s.parachutes.front().initial_phase = {false, 50.0};
     }},
    {"full: weak fabric", StatusCode::strain_limit, by_full,
     [](Scene& s) {
         short_full(s);
         s.full.strain_limit = 0.005;
     }},
    {"full: a step above the limit", StatusCode::not_finite, by_full,
     [](Scene& s) {
         short_full(s);
         s.full.time_step_factor = 4.0;
         s.full.strain_limit = 1e300;
     }},
    {"full: a step too long for impacts", StatusCode::energy_grew, by_full,
     [](Scene& s) {
         s = hard_extraction(
             4, {"full.mesh.gore_columns=1", "full.mesh.gore_rows=4", "full.mesh.line_elements=4",
                 "full.time_step_factor=2", "full.strain_limit=10"});
     }},
    {"full: lines of no mass and much stiffness", StatusCode::step_too_small, by_full,
     [](Scene& s) {
         short_full(s);
         s.parachutes.front().line.youngs_modulus = 1e27;
     }},
};

/// Endings that take a broken integrator: asked for, in place of brought about.
std::vector<RunStatus> endings_of_rom() {
    const Scene scene = c9_scene();
    Run run;
    RunRecord record;
    rom::RunContext context(scene, run, record);
    context.observer.watch([](double time, std::span<const double>) {
        rom::HistoryRow row;
        row.time = time;
        return row;
    });
    const std::vector<double> start{0.0}, tolerance{1e-6};
    context.observer.mark(0.0, start);
    const OdeSolver solver(
        ode_methods().front(), [](double, std::span<const double>, std::span<double> rate) { rate[0] = 0.0; },
        0.0, start, 1e-6, tolerance);
    std::vector<RunStatus> endings;
    for (const auto segment : {rom::IntegrationSegment::failed, rom::IntegrationSegment::not_finite,
                               rom::IntegrationSegment::too_many_steps})
        endings.push_back(context.ending(segment, solver));
    return endings;
}

TEST(Endings, EveryOneThatIsNoAnswerNamesAKeyThatChangesIt) {
    std::set<StatusCode> seen;
    for (const Trouble& trouble : troubles) {
        Scene scene = c9_scene();
        trouble.make(scene);
        const RunStatus status = trouble.run(scene).status;
        EXPECT_EQ(status_name(status.code), status_name(trouble.ending))
            << trouble.what << ": " << status.detail;
        EXPECT_TRUE(names_a_key(status.detail)) << trouble.what << ": " << status.detail;
        seen.insert(status.code);
    }
    for (const RunStatus& status : endings_of_rom()) {
        EXPECT_TRUE(names_a_key(status.detail)) << status_name(status.code) << ": " << status.detail;
        seen.insert(status.code);
    }
    for (int code = 0; status_name(static_cast<StatusCode>(code)) != "unknown"; ++code) {
        const auto ending = static_cast<StatusCode>(code);
        // Solids are rigid or linear elastic: nothing looks for this one.
        if (is_numerical_failure(ending) && ending != StatusCode::element_inverted) {
            EXPECT_TRUE(seen.contains(ending)) << status_name(ending);
        }
    }
}

}  // namespace
}  // namespace twinchute::test
