#include "tests/bench/work/problems.hpp"

#include <cmath>

#include "lib/math/vec.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/solve/opening.hpp"
#include "rom/deployment.hpp"
#include "rom/rigid_composite.hpp"
#include "rom/two_bodies.hpp"
#include "tests/support/c9_scene.hpp"

namespace twinchute::bench {
namespace {

using Values = std::vector<double>;
using Composite = rom::RigidComposite<1>;
using Bodies = rom::TwoBodies<1>;

constexpr double printed_modulus = 9.7e10;  // [Pa] of the lines, paper, 5.1

/// Models that the right-hand sides refer to; they live as long as their problem.
struct Models {
    Scene scene = test::packed_c9(DeployBy::static_line, false);
    Composite composite;
    Bodies bodies;
};

Composite composite_of(const Scene& scene) {
    Composite model;
    model.atmosphere = scene.environment.atmosphere;
    model.gravity = scene.environment.gravity;
    model.payload_mass = scene.payload.mass;
    model.added_mass = &*scene.aerodynamics.added_mass;
    return model;
}

Bodies bodies_of(const Scene& scene) {
    const Parachute& chute = scene.parachutes.front();
    Bodies model;
    model.atmosphere = scene.environment.atmosphere;
    model.gravity = scene.environment.gravity;
    model.payload_mass = scene.payload.mass;
    model.parachute_mass = chute.mass;
    model.stiffness = line_stiffness(chute);
    model.taut_distance = rom::taut_distance(chute);
    model.behind = rom::Vec<1>::Unit(0);
    static const OpeningSequence none;
    model.canopies = &none;
    return model;
}

/// y: altitude and its rate.
Stage flight(const Problem& problem, Composite model, const Scene& scene, const Inflation& inflation,
             Phase phase, double end) {
    const auto canopies = std::make_shared<OpeningSequence>(scene.parachutes.front(), inflation, phase);
    model.canopies = canopies.get();
    return {end, [&problem, model, canopies](double t, const double* y, double* dydt) {
                ++problem.calls;
                dydt[0] = y[1];
                dydt[1] = model.acceleration(t, rom::motion_of<1>({y, 2}))[0];
            }};
}

/// y: the payload's altitude and rate, then how far up and how fast away from it the parachute is.
Stage apart(const Problem& problem, Bodies model, rom::DeploymentPhase phase, double end) {
    model.phase = phase;
    return {end, [&problem, model](double t, const double* y, double* dydt) {
                ++problem.calls;
                const auto motion = rom::motion_of<1>({y, 4});
                const auto separation = Bodies::separation_of({y, 4});
                dydt[0] = y[1];
                dydt[1] = model.payload_acceleration(t, motion, separation)[0];
                dydt[2] = y[3];
                dydt[3] = model.parachute_acceleration(t, motion, separation)[0] - dydt[1];
            }};
}

/// [s] that taut lines take to bring both bodies to one speed: a quarter of a period of their spring.
double quarter_period(const Bodies& model) {
    const double reduced =
        model.payload_mass * model.parachute_mass / (model.payload_mass + model.parachute_mass);
    return 0.5 * pi * std::sqrt(reduced / model.stiffness);
}

/// The paper's crane drop: held by its static line, taut lines, initial phase, filling, open. Stages end
/// where they would by the equations of free fall; what is compared is integration, so that any fixed times
/// will do.
std::unique_ptr<Problem> crane_drop() {
    auto problem = std::make_unique<Problem>();
    problem->name = "crane-drop";
    problem->title = "Work and precision: crane drop";
    problem->subtitle = "free fall, snatch, initial phase, filling and descent of the C-9, 8 s";
    problem->error = "altitude and speed";
    const auto models = std::make_shared<Models>();
    const Scene& scene = models->scene;
    Bodies bodies = bodies_of(scene);
    const double taut = std::sqrt(2.0 * bodies.taut_distance / bodies.gravity);
    const double snatch = taut + quarter_period(bodies);
    const Composite composite = composite_of(scene);
    const Inflation inflation =
        make_inflation(scene, scene.parachutes.front(), snatch, bodies.gravity * taut, 1.225);
    problem->start = {85.0, 0.0, 0.0, 0.0};
    problem->scale = {85.0, 8.0};
    problem->stages.push_back(apart(*problem, bodies, rom::DeploymentPhase::static_line, taut));
    problem->stages.push_back(apart(*problem, bodies, rom::DeploymentPhase::taut_lines, snatch));
    for (const Phase phase : {Phase::initial, Phase::filling, Phase::open})
        problem->stages.push_back(flight(*problem, composite, scene, inflation, phase,
                                         phase == Phase::open ? snatch + 8.0 : inflation.end_of(phase)));
    problem->stages[2].enter = [bodies, models](const Values& y) {
        const auto locked =
            bodies.locked_velocity(rom::motion_of<1>({y.data(), 4}), Bodies::separation_of({y.data(), 4}));
        return Values{y[0], locked[0]};
    };
    return problem;
}

std::unique_ptr<Problem> descent() {
    auto problem = std::make_unique<Problem>();
    problem->name = "descent-100s";
    problem->title = "Work and precision: 100 s of descent";
    problem->subtitle = "the open C-9 from 1500 m and 21 m/s in the standard atmosphere";
    problem->error = "altitude and speed";
    const auto models = std::make_shared<Models>();
    models->scene.environment.atmosphere = {find_atmosphere("us76"), 1.225};
    const Scene& scene = models->scene;
    problem->start = {1500.0, -21.0};
    problem->scale = {800.0, 8.0};
    problem->stages.push_back(
        flight(*problem, composite_of(scene), scene, inflated(scene.parachutes.front()), Phase::open, 100.0));
    problem->stages[0].enter = [models](const Values& y) { return y; };  // keeps them
    return problem;
}

/// Until the lines have brought both bodies to one speed, but for the little that weight and air do
/// meanwhile.
std::unique_ptr<Problem> snatch() {
    auto problem = std::make_unique<Problem>();
    problem->name = "elastic-snatch";
    problem->title = "Work and precision: elastic snatch";
    problem->subtitle = "lines of 9.7e10 Pa come taut at 20.5 m/s, until both bodies have one speed";
    problem->error = "altitude, speed, separation and parting speed";
    const auto models = std::make_shared<Models>();
    models->scene.parachutes.front().line.youngs_modulus = printed_modulus;
    const Bodies bodies = bodies_of(models->scene);
    constexpr double parting = 20.5;  // [m/s]
    const double end = quarter_period(bodies);
    problem->start = {64.0, -parting, bodies.taut_distance, parting};
    problem->scale = {parting * end, parting, parting * end, parting};
    problem->stages.push_back(apart(*problem, bodies, rom::DeploymentPhase::taut_lines, end));
    return problem;
}

/// Drag area over the steady one, prescribed here: filling to 0.3 in 0.8 s, reefed until 3 s, then to 1
/// in 1.2 s. Both fillings by a cubic with level ends.
double two_stages(double t) {
    const auto rise = [](double x) { return x * x * (3.0 - 2.0 * x); };
    if (t < 0.8) return 0.02 + 0.28 * rise(t / 0.8);
    if (t < 3.0) return 0.3;
    if (t < 4.2) return 0.3 + 0.7 * rise((t - 3.0) / 1.2);
    return 1.0;
}

std::unique_ptr<Problem> two_stage_opening() {
    auto problem = std::make_unique<Problem>();
    problem->name = "two-stage-opening";
    problem->title = "Work and precision: opening in two stages";
    problem->subtitle = "drag area prescribed: 30 % in 0.8 s, reefed until 3 s, open at 4.2 s; 60 m/s, 8 s";
    problem->error = "altitude and speed";
    problem->start = {2000.0, -60.0};
    problem->scale = {200.0, 8.0};
    constexpr double mass = 157.6, drag_area = 42.56, density = 1.225;  // [kg], [m^2], [kg/m^3]: the C-9
    for (const double end : {0.8, 3.0, 4.2, 8.0})
        problem->stages.push_back({end, [&p = *problem](double t, const double* y, double* dydt) {
                                       ++p.calls;
                                       dydt[0] = y[1];
                                       dydt[1] = -0.5 * density * drag_area * two_stages(t) * y[1] *
                                                     std::abs(y[1]) / mass -
                                                 standard_gravity;
                                   }});
    return problem;
}

}  // namespace

std::vector<std::unique_ptr<Problem>> work_problems() {
    std::vector<std::unique_ptr<Problem>> all;
    all.push_back(crane_drop());
    all.push_back(descent());
    all.push_back(snatch());
    all.push_back(two_stage_opening());
    return all;
}

}  // namespace twinchute::bench
