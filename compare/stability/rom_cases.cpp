// Stiff and extreme cases of the reduced-order model.
#include <fmt/format.h>

#include <cmath>

#include "compare/stability/base_scenes.hpp"
#include "compare/stability/cases.hpp"
#include "compare/stability/checks.hpp"
#include "lib/math/vec.hpp"
#include "lib/scene/keys.hpp"
#include "lib/scene/line_stretch.hpp"

namespace twinchute::compare {
namespace {

/// Every word of rom.method.
std::span<const StabilityMethod> methods() {
    static const std::vector<StabilityMethod> rows = [] {
        std::vector<StabilityMethod> list;
        for (const std::string_view word : find_key(scene_keys(), "rom.method")->choices()) {
            const std::string name(word);
            list.push_back({name, [name](Scene& scene) { scene.rom.method = name; }});
        }
        return list;
    }();
    return rows;
}

StabilityCase row(std::string name, std::string why, Scene (*base)(), std::function<void(Scene&)> change,
                  Check check, std::vector<StatusCode> causes = {}) {
    StabilityCase c;
    c.name = std::move(name);
    c.why = std::move(why);
    c.fidelity = "rom";
    c.base = base;
    c.change = std::move(change);
    c.methods = methods();
    c.check = std::move(check);
    c.causes = std::move(causes);
    return c;
}

void in_empty_space(Scene& scene) {
    scene.environment.atmosphere.constant_density = 1e-15;
}
void without_weight(Scene& scene) {
    scene.environment.gravity = 1e-12;
    scene.release.path_angle = 0.0;
}
void fills_in(Scene& scene, double seconds) {
    FillTime& fill = scene.parachutes.front().fill_time;
    fill.model = find_fill_time("given");
    fill.given = seconds;
}
void us76(Scene& scene, double altitude) {
    scene.environment.atmosphere = {find_atmosphere("us76")};
    scene.release.altitude = altitude;
}
/// [s] of a fall to where the scene stops, in a vacuum.
double time_to_stop(const Scene& scene) {
    const double floor =
        scene.stop.kind == Trigger::Kind::altitude ? scene.stop.value : scene.environment.ground;
    const double height = scene.release.altitude - floor;
    const double down = scene.release.speed * std::sin(scene.release.path_angle);
    return 2.0 * height / (down + std::sqrt(down * down + 2.0 * scene.environment.gravity * height));
}

void add_snatches(std::vector<StabilityCase>& rows) {
    for (int power = 0; power <= 6; ++power)
        rows.push_back(row(
            fmt::format("line stiffness x 1e{}", power),
            "elastic snatch: taut lines swing in milliseconds to microseconds", c9_snatch_in_empty_space,
            [power](Scene& s) { s.parachutes.front().line.youngs_modulus *= std::pow(10.0, power); },
            elastic_snatch()));
}

void add_openings(std::vector<StabilityCase>& rows) {
    for (const double seconds : {1.0, 1e-2, 1e-4, 1e-6, 1e-9, 1e-12})
        rows.push_back(row(
            fmt::format("fill time {:g} s", seconds),
            "drag area that rises like a step, with a sixth power near its end", c9_of_closed_forms,
            [seconds](Scene& s) {
                without_weight(s);
                fills_in(s, seconds);
            },
            ludtke_closed_form()));
    for (const double seconds : {1e-100, 1e-300})
        rows.push_back(row(fmt::format("fill time {:g} s", seconds),
                           "near the smallest numbers there are: integrator or interpolation has to give up",
                           c9_at_line_stretch,
                           [seconds](Scene& s) {
                               s.parachutes.front().initial_phase = {false, 0.0};
                               fills_in(s, seconds);
                           },
                           same_by_another_method(),
                           {StatusCode::solver_failed, StatusCode::not_finite, StatusCode::step_limit}));
    rows.push_back(row("fill constant 0.4", "a filling that is over before its initial phase is",
                       c9_at_line_stretch, [](Scene& s) { s.parachutes.front().fill_time.n = 0.4; }, {},
                       {StatusCode::refused}));
    rows.push_back(row("initial phase of 5 s, known at snatch",
                       "the filling time comes out of the deployment, shorter than the initial phase",
                       c9_snatch_in_empty_space,
                       [](Scene& s) {
                           s.parachutes.front().initial_phase = {false, 5.0};
                       },
                       {}, {StatusCode::refused}));
    rows.push_back(row(
        "release at 300 m/s, closed form", "204 times the dynamic pressure of a snatch", c9_of_closed_forms,
        [](Scene& s) {
            without_weight(s);
            s.release.speed = 300.0;
        },
        ludtke_closed_form()));
    rows.push_back(row(
        "release at 300 m/s, oblique", "the same from level flight, with weight and added mass",
        c9_at_line_stretch,
        [](Scene& s) {
            s.release = {3000.0, 300.0, 0.0, 0.5 * pi};
        },
        same_by_another_method()));
    rows.push_back(row("free pack without drag area", "nothing would ever draw it out", c9_at_line_stretch,
                       [](Scene& s) { s.parachutes.front().deploy.by = DeployBy::free; }, {},
                       {StatusCode::refused}));
}

void add_media(std::vector<StabilityCase>& rows) {
    for (const auto momentum : {AddedMassMomentum::inertia_only, AddedMassMomentum::accreting})
        rows.push_back(row(
            fmt::format("added mass 50 times the mass, {}",
                        momentum == AddedMassMomentum::accreting ? "accreting" : "inertia-only"),
            "the air that moves along is nearly all there is to move", c9_at_line_stretch,
            [momentum](Scene& s) {
                // M_a of the open canopy is 75.2 kg.
                s.payload.mass = 1.2;
                s.parachutes.front().mass = 0.3;
                s.aerodynamics.added_mass->momentum = momentum;
                s.release.altitude = 2000.0;
                stop_after(s, 60.0);
            },
            all_of({same_by_another_method(), terminal_speed()})));
    rows.push_back(row(
        "30 km", "1/67 of the density, and 63 m/s of descent that follow it down", c9_at_line_stretch,
        [](Scene& s) {
            us76(s, 30000.0);
            s.release.speed = 100.0;
            stop_after(s, 300.0);
        },
        same_by_another_method()));
    rows.push_back(row(
        "60 km", "1/4000 of the density: a fall that speeds up before it slows down", c9_of_closed_forms,
        [](Scene& s) {
            us76(s, 60000.0);
            s.release.speed = 100.0;
            stop_after(s, 300.0);
        },
        all_of({same_by_another_method(), energy_never_grows()})));
    rows.push_back(row(
        "drag area 1e-9 m2", "next to no drag: a fall on a parabola", c9_of_closed_forms,
        [](Scene& s) {
            s.release.path_angle = 0.3;
            s.parachutes.front().drag_area = 1e-9;
            stop_after(s, 5.0);
        },
        fall_in_a_vacuum()));
    StabilityCase nothing =
        row("drag area 0", "no parachute at all", c9_of_closed_forms, {}, {}, {StatusCode::refused});
    nothing.asked = "parachute.drag_area=0";
    rows.push_back(std::move(nothing));
}

void add_events(std::vector<StabilityCase>& rows) {
    const char* why = "two endings at one instant: none may be lost or doubled";
    rows.push_back(row(
        "stop at the instant of full open", why, c9_of_closed_forms,
        [](Scene& s) {
            in_empty_space(s);
            fills_in(s, 2.0);
            stop_after(s, 2.0);
        },
        all_of({fall_in_a_vacuum(), has_event("full-open"),
                ends_at([](const Scene& s) { return s.stop.value; })})));
    rows.push_back(row(
        "ground at the instant of full open", why, c9_of_closed_forms,
        [](Scene& s) {
            in_empty_space(s);
            s.environment.ground = 100.0;
            s.stop = {Trigger::Kind::ground, 0.0, 0.0};
            fills_in(s, time_to_stop(s));
        },
        all_of({fall_in_a_vacuum(), has_event("ground"), ends_at(time_to_stop)})));
    rows.push_back(row(
        "stop altitude on the ground", why, c9_of_closed_forms,
        [](Scene& s) {
            in_empty_space(s);
            s.stop = {Trigger::Kind::altitude, 0.0, 0.0};
        },
        ends_at(time_to_stop)));
    rows.push_back(row(
        "stop altitude and full open at one instant", why, c9_of_closed_forms,
        [](Scene& s) {
            in_empty_space(s);
            s.stop = {Trigger::Kind::altitude, 100.0, 0.0};
            fills_in(s, time_to_stop(s));
        },
        all_of({fall_in_a_vacuum(), ends_at(time_to_stop)})));
}

void add_long_descents(std::vector<StabilityCase>& rows) {
    rows.push_back(row(
        "descent of 10 000 s", "25 000 times the time in which its speed settles", c9_inflated,
        [](Scene& s) {
            s.release.altitude = 80000.0;
            stop_after(s, 10000.0);
        },
        fall_with_constant_drag_area()));
    rows.push_back(row("descent of 10 000 s, 1.5 kg",
                       "260 000 such times: the steps of an explicit method may not be enough", c9_inflated,
                       [](Scene& s) {
                           s.release.altitude = 80000.0;
                           s.payload.mass = 1.2;
                           s.parachutes.front().mass = 0.3;
                           stop_after(s, 10000.0);
                       },
                       fall_with_constant_drag_area(), {StatusCode::step_limit}));
    rows.push_back(row(
        "tolerance 1e-14", "two digits above round-off", c9_at_line_stretch,
        [](Scene& s) { s.rom.rtol = 1e-14; },
        [](const Trial& trial) {
            // Limits of the default tolerance: round-off of the sums stays far below.
            Scene scene = trial.scene;
            scene.rom.rtol = 1e-10;
            return same_by_another_method()({scene, trial.record, trial.fidelity, trial.stop});
        },
        {StatusCode::step_limit}));
}

}  // namespace

std::vector<StabilityCase> rom_cases() {
    std::vector<StabilityCase> rows;
    rows.push_back(row("as shipped", "nothing: the scale of the others", c9_at_line_stretch, {},
                       same_by_another_method()));
    add_snatches(rows);
    add_openings(rows);
    add_media(rows);
    add_events(rows);
    add_long_descents(rows);
    return rows;
}

}  // namespace twinchute::compare
