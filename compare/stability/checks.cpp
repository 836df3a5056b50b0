#include "compare/stability/checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lib/math/vec.hpp"
#include "lib/models/snatch.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/solve/opening.hpp"

namespace twinchute::compare {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();  // fails every limit

double last(const RunRecord& record, const char* channel) {
    const Channel* found = record.find_channel(channel);
    return found && !found->values.empty() ? found->values.back() : none;
}

double metric(const RunRecord& record, const char* key) {
    return record.metric(key).value_or(none);
}

double share(double found, double expected) {
    if (found == expected) return 0.0;  // both may be zero
    return std::abs(found - expected) / std::abs(expected);
}

double rom_limit(const Scene& scene) {
    return 100.0 * scene.rom.rtol;
}

double mass_of(const Scene& scene) {
    return scene.payload.mass + scene.parachutes.front().mass;
}

double drag_area_of(const Scene& scene) {
    return scene.parachutes.front().drag_area + scene.payload.drag_area.value_or(0.0);
}

double density_of(const Scene& scene) {
    return scene.environment.atmosphere.at(scene.release.altitude).density;
}

/// [m/s] at which drag carries the weight.
double equilibrium(const Scene& scene) {
    return std::sqrt(2.0 * mass_of(scene) * scene.environment.gravity /
                     (density_of(scene) * drag_area_of(scene)));
}

double log_cosh(double x) {
    x = std::abs(x);
    return x + std::log1p(std::exp(-2.0 * x)) - std::log(2.0);
}

std::vector<Finding> of_another_method(const Trial& trial) {
    Scene scene = trial.scene;
    const bool by_pair = trial.scene.rom.method == "dormand-prince" || trial.scene.rom.method == "auto";
    scene.rom.method = by_pair ? "zonneveld" : "dormand-prince";
    scene.rom.rtol = 1e-12;
    const RunRecord truth = trial.run(scene);
    const double limit = rom_limit(trial.scene);
    const std::string by = fmt::format(", {} at 1e-12", scene.rom.method);
    std::vector<Finding> findings;
    if (truth.status.code != trial.record.status.code)
        findings.push_back(
            {fmt::format("ends otherwise ({}){}", status_name(truth.status.code), by), 1.0, 0.0});
    if (truth.metric("peak_force_N"))
        findings.push_back({"peak force" + by,
                            share(metric(trial.record, "peak_force_N"), metric(truth, "peak_force_N")),
                            limit});
    for (const char* channel : {"speed", "altitude"})
        findings.push_back({channel + by, share(last(trial.record, channel), last(truth, channel)), limit});
    return findings;
}

std::vector<Finding> of_ludtke(const Trial& trial) {
    const Scene& scene = trial.scene;
    const Parachute& chute = scene.parachutes.front();
    const double v = scene.release.speed, rho = density_of(scene), mass = mass_of(scene);
    const double eta = std::sqrt(chute.initial_drag_area_ratio);
    const double filling = chute.fill_time.seconds(fill_inputs(scene, chute, v, rho));
    const double m = 2.0 * mass / (rho * v * filling * chute.drag_area);  // mass parameter
    const auto speed = [&](double x) {
        const double integral =
            (1 - eta) * (1 - eta) * std::pow(x, 7) / 7 + (1 - eta) * eta * std::pow(x, 4) / 2 + eta * eta * x;
        return 1.0 / (1.0 + integral / m);
    };
    const auto force = [&](double x) { return std::pow(speed(x) * ((1 - eta) * x * x * x + eta), 2); };
    constexpr int points = 20000;  // a maximum is found to the square of a spacing
    double peak = 0.0;
    for (int i = 0; i <= points; ++i)
        peak = std::max(peak, force(static_cast<double>(i) / points));
    // The riser pulls on the payload what slows it down.
    peak *= 0.5 * rho * v * v * chute.drag_area * scene.payload.mass / mass;
    const Event* open = trial.record.find_event("full-open");
    return {{"peak force, Ludtke's closed form", share(metric(trial.record, "peak_force_N"), peak),
             rom_limit(scene)},
            {"speed at full open, Ludtke's closed form", share(open ? open->speed : none, v * speed(1.0)),
             rom_limit(scene)}};
}

std::vector<Finding> of_elastic_snatch(const Trial& trial) {
    const Scene& scene = trial.scene;
    const Parachute& chute = scene.parachutes.front();
    const double lines = chute.line_length + chute.riser_length;
    const double stiffness = chute.gores * chute.line.axial_stiffness() / lines;
    const double mass = reduced_mass(scene.payload.mass, chute.mass);
    const double force = snatch_force_mass_spring(scene.release.speed, stiffness, mass);
    const double taut = chute.deploy.static_line_length + lines + 0.5 * chute.nominal_diameter;
    const double limit = rom_limit(scene) + scene.rom.rtol * taut * stiffness / force;
    const double duration =
        metric(trial.record, "snatch_time_s") - metric(trial.record, "line_stretch_time_s");
    const double common = scene.release.speed * scene.payload.mass / mass_of(scene);
    return {{"snatch force, dv sqrt(k m_red)", share(metric(trial.record, "snatch_force_N"), force), limit},
            {"duration of the snatch, pi/2 sqrt(m_red/k)",
             share(duration, 0.5 * pi * std::sqrt(mass / stiffness)), limit},
            {"momentum after the snatch", share(metric(trial.record, "snatch_speed_m_s"), common),
             rom_limit(scene)}};
}

std::vector<Finding> of_vacuum(const Trial& trial) {
    const Scene& scene = trial.scene;
    const double t = last(trial.record, "time"), g = scene.environment.gravity;
    const double down = scene.release.speed * std::sin(scene.release.path_angle);
    const double fall = down * t + 0.5 * g * t * t;
    const double speed = std::hypot(scene.release.speed * std::cos(scene.release.path_angle), down + g * t);
    // Drag is largest at the end; what it does from release to then is less than that all the time.
    const double braking = 0.5 * density_of(scene) * speed * speed * drag_area_of(scene) / mass_of(scene);
    return {
        {"altitude, fall in a vacuum", share(last(trial.record, "altitude"), scene.release.altitude - fall),
         rom_limit(scene) + 0.5 * braking * t * t / std::abs(scene.release.altitude - fall)},
        {"speed, fall in a vacuum", share(last(trial.record, "speed"), speed),
         rom_limit(scene) + braking * t / speed}};
}

std::vector<Finding> of_constant_drag_area(const Trial& trial) {
    const Scene& scene = trial.scene;
    const double t = last(trial.record, "time"), g = scene.environment.gravity, v_e = equilibrium(scene);
    const double begin = std::atanh(scene.release.speed / v_e), end = g * t / v_e + begin;
    const double fall = v_e * v_e / g * (log_cosh(end) - log_cosh(begin));
    return {{"altitude, v_e^2/g ln cosh(g t/v_e)",
             share(last(trial.record, "altitude"), scene.release.altitude - fall), rom_limit(scene)},
            {"speed, v_e tanh(g t/v_e)", share(last(trial.record, "speed"), v_e * std::tanh(end)),
             rom_limit(scene)}};
}

/// The approach is exponential with the rate 2 g m/((m + M_a) v_e), from less than a hundred times v_e.
double still_to_go(const Scene& scene, double time) {
    const Parachute& chute = scene.parachutes.front();
    double inertia = mass_of(scene);
    if (scene.aerodynamics.added_mass)
        inertia +=
            scene.aerodynamics.added_mass
                ->mass(density_of(scene), {steady_radius(chute), 0.0}, {1.0, 0.0}, chute.geometric_porosity)
                .value;
    const double rate = 2.0 * scene.environment.gravity * mass_of(scene) / (inertia * equilibrium(scene));
    return 100.0 * std::exp(-rate * time);
}

std::vector<Finding> of_terminal_speed(const Trial& trial) {
    const Event* open = trial.record.find_event("full-open");
    const double time = last(trial.record, "time") - (open ? open->time : 0.0);
    return {{"speed at the end, sqrt(2 W/(rho C_D S))",
             share(last(trial.record, "speed"), equilibrium(trial.scene)),
             rom_limit(trial.scene) + still_to_go(trial.scene, time)}};
}

std::vector<Finding> of_energy(const Trial& trial) {
    const Channel* speed = trial.record.find_channel("speed");
    const Channel* altitude = trial.record.find_channel("altitude");
    const double g = trial.scene.environment.gravity;
    double gained = 0.0, least = 0.0, start = 0.0;
    for (std::size_t i = 0; i < speed->values.size(); ++i) {
        const double v = speed->values[i];
        const double energy = 0.5 * v * v + g * altitude->values[i];
        if (i == 0) start = least = energy;
        gained = std::max(gained, energy - least);
        least = std::min(least, energy);
    }
    return {{"mechanical energy gained", gained / start, rom_limit(trial.scene)}};
}

/// The run's own guard has this limit, over all that changed hands; its scale has the elastic energy of the
/// start besides, which is zero or small.
constexpr double largest_residual = 0.002;

std::vector<Finding> of_energy_ledger(const Trial& trial) {
    const Scene& scene = trial.scene;
    if (!trial.record.energy) return {{"no energy ledger", 1.0, 0.0}};
    const EnergyLedger& e = *trial.record.energy;
    const double residual = e.residual_fraction * std::abs(e.drag_work);
    const double kinetic = 0.5 * mass_of(scene) * scene.release.speed * scene.release.speed;
    const double scale =
        kinetic + std::abs(e.gravity_work) + std::abs(e.drag_work) + std::abs(e.external_work);
    return {{"energy that does not add up", std::abs(residual) / scale, largest_residual}};
}

/// Share of the peak force: a force that is further from the sound one than this is the first sign of a step
/// that is too long.
constexpr double first_sign = 0.01;
/// A run looks for faults every so many steps, and its record ends at the last look that found none.
constexpr std::int64_t steps_between_looks = 50;

/// Limit that tests of the time step hold forces to.
constexpr double same_force = 0.005;

/// Between layouts, whose sums differ in their order: found are 1e-8 and, where lines are all but slack,
/// 4e-6. A single triangle of a thousand that pulled twice would be 1e-3.
constexpr double same_but_for_rounding = 1e-4;

/// Same ending, and the largest forces.
std::vector<Finding> compare_runs(const Trial& trial, const RunRecord& truth, const std::string& by,
                                  double limit) {
    std::vector<Finding> findings;
    if (truth.status.code != trial.record.status.code)
        findings.push_back(
            {fmt::format("ends otherwise ({}){}", status_name(truth.status.code), by), 1.0, 0.0});
    for (const auto& [key, what] :
         {std::pair{"max_force_N", "largest force"}, std::pair{"max_deceleration_g", "largest deceleration"},
          std::pair{"max_line_tension_N", "largest line tension"}})
        findings.push_back({what + by, share(metric(trial.record, key), metric(truth, key)), limit});
    return findings;
}

std::vector<Finding> compare_steps(const Trial& trial, const RunRecord& truth, double limit) {
    return compare_runs(trial, truth,
                        fmt::format(", {} steps for {}", truth.cost.steps, trial.record.cost.steps), limit);
}

RunRecord in_half_the_step(const Trial& trial) {
    Scene scene = trial.scene;
    scene.full.time_step_factor *= 0.5;
    return trial.run(scene);
}

std::vector<Finding> of_half_the_step(const Trial& trial) {
    return compare_steps(trial, in_half_the_step(trial), same_force);
}

std::vector<Finding> of_its_own_layout(const Trial& trial) {
    const Trial usual{trial.scene, trial.record, trial.fidelity, trial.stop};
    const RunRecord truth = usual.run(trial.scene);
    if (is_numerical_failure(truth.status.code)) return {};
    return compare_runs(trial, truth, " in the gore-batched layout", same_but_for_rounding);
}

/// How far the largest force moves when nodes of the canopy start a micrometre elsewhere, as a share of it.
double scatter_of_force(const Trial& trial) {
    double low = metric(trial.record, "max_force_N"), high = low;
    for (const std::uint64_t seed : {1, 2, 3}) {
        Scene scene = trial.scene;
        scene.full.symmetry = Symmetry::none;  // one sector has no noise
        scene.full.noise = Noise{1e-6, seed};
        const double largest = metric(trial.run(scene), "max_force_N");
        low = std::min(low, largest);
        high = std::max(high, largest);
    }
    return (high - low) / low;
}

std::vector<Finding> of_scatter(const Trial& trial) {
    return compare_steps(trial, in_half_the_step(trial), std::max(same_force, scatter_of_force(trial)));
}

double at(const RunRecord& record, const char* channel, double t) {
    const auto &time = record.find_channel("time")->values, &value = record.find_channel(channel)->values;
    const auto right = std::ranges::lower_bound(time, t);
    if (right == time.begin()) return value.front();
    if (right == time.end()) return value.back();
    const auto i = static_cast<std::size_t>(right - time.begin());
    const double x = (t - time[i - 1]) / (time[i] - time[i - 1]);
    return value[i - 1] + x * (value[i] - value[i - 1]);
}

std::vector<Finding> of_momentum(const Trial& trial) {
    const Scene& scene = trial.scene;
    const Channel *time = trial.record.find_channel("time"), *force = trial.record.find_channel("force_raw"),
                  *speed = trial.record.find_channel("vertical_speed");
    if (!time || !force || !speed) return {{"no history", 1.0, 0.0}};
    double impulse = 0.0, size = 0.0;
    const double m = scene.payload.mass, weight = m * scene.environment.gravity;
    for (std::size_t i = 1; i < time->values.size(); ++i) {
        const double dt = time->values[i] - time->values[i - 1];
        const double mean = 0.5 * (force->values[i] + force->values[i - 1]);
        impulse += dt * (mean - weight);
        size += dt * (mean + weight);
    }
    const double gained = m * (speed->values.back() - speed->values.front());
    // The trapezoidal rule over the rows of the history, which are coarser than the steps.
    return {{"payload's momentum less the impulse on it", std::abs(gained - impulse) / size, 0.01}};
}

std::vector<Finding> of_terminal_speed_of_the_mesh(const Trial& trial) {
    const Scene& scene = trial.scene;
    const double weight = 0.02 * scene.parachutes.front().mass / mass_of(scene);
    return {{"speed at the end, sqrt(2 W/(rho C_D S))",
             share(last(trial.record, "speed"), equilibrium(scene)),
             steady_descent_change + 0.5 * weight + still_to_go(scene, last(trial.record, "time"))}};
}

std::vector<Finding> of_fall_of_the_mesh(const Trial& trial) {
    const Scene& scene = trial.scene;
    const double v_e = equilibrium(scene), t = last(trial.record, "time");
    const double weight = 0.02 * scene.parachutes.front().mass / mass_of(scene);
    return {{"speed, v_e tanh(g t/v_e)",
             share(last(trial.record, "speed"), v_e * std::tanh(scene.environment.gravity * t / v_e)),
             steady_descent_change + 0.5 * weight}};
}

std::vector<Finding> of_snatch_speed(const Trial& trial) {
    const Scene& scene = trial.scene;
    const Parachute& chute = scene.parachutes.front();
    const double fall = chute.deploy.static_line_length + chute.line_length + chute.riser_length +
                        0.5 * chute.nominal_diameter;
    const double common =
        std::sqrt(2.0 * scene.environment.gravity * fall) * scene.payload.mass / mass_of(scene);
    return {{"snatch speed, sqrt(2 g L) shared", share(metric(trial.record, "snatch_speed_m_s"), common),
             1.0 / common}};
}

}  // namespace

Check all_of(std::vector<Check> checks) {
    return [checks = std::move(checks)](const Trial& trial) {
        std::vector<Finding> all;
        for (const Check& check : checks)
            for (Finding& finding : check(trial))
                all.push_back(std::move(finding));
        return all;
    };
}

Check same_by_another_method() {
    return of_another_method;
}
Check ludtke_closed_form() {
    return of_ludtke;
}
Check elastic_snatch() {
    return of_elastic_snatch;
}
Check fall_in_a_vacuum() {
    return of_vacuum;
}
Check fall_with_constant_drag_area() {
    return of_constant_drag_area;
}
Check terminal_speed() {
    return of_terminal_speed;
}
Check energy_never_grows() {
    return of_energy;
}

Check ends_at(std::function<double(const Scene&)> time) {
    return [time = std::move(time)](const Trial& trial) -> std::vector<Finding> {
        return {{"instant of the end", share(last(trial.record, "time"), time(trial.scene)),
                 rom_limit(trial.scene)}};
    };
}

Check has_event(std::string name) {
    return [name = std::move(name)](const Trial& trial) -> std::vector<Finding> {
        return {{name + " is in the record", trial.record.find_event(name) ? 0.0 : 1.0, 0.5}};
    };
}

Check energy_closes() {
    return of_energy_ledger;
}
Check same_in_half_the_step() {
    return of_half_the_step;
}
Check same_in_the_layout_of_its_mesh() {
    return of_its_own_layout;
}
Check same_within_its_scatter() {
    return of_scatter;
}

std::optional<std::int64_t> steps_since_first_sign(const Trial& trial, double sound_factor) {
    Scene scene = trial.scene;
    scene.full.time_step_factor = sound_factor;
    const RunRecord truth = trial.run(scene);
    const auto largest = truth.metric("max_force_N");
    const Channel *time = trial.record.find_channel("time"), *force = trial.record.find_channel("force_raw");
    if (!largest || !time || !force || time->values.back() <= 0.0) return std::nullopt;
    const auto& t = time->values;
    double sign = t.back();
    for (std::size_t i = 0; i < t.size(); ++i)
        if (std::abs(force->values[i] - at(truth, "force_raw", t[i])) > first_sign * *largest) {
            sign = t[i];
            break;
        }
    const double step = t.back() / static_cast<double>(trial.record.cost.steps);
    return std::min(std::llround((t.back() - sign) / step) + steps_between_looks,
                    static_cast<long long>(trial.record.cost.steps));
}

Check payload_momentum() {
    return of_momentum;
}
Check terminal_speed_of_the_mesh() {
    return of_terminal_speed_of_the_mesh;
}
Check fall_of_the_mesh() {
    return of_fall_of_the_mesh;
}
Check snatch_speed_of_a_drop() {
    return of_snatch_speed;
}

}  // namespace twinchute::compare
