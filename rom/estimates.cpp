#include "rom/estimates.hpp"

#include <cmath>

#include "lib/models/opening_force.hpp"

namespace twinchute::rom {
namespace {

OpeningForceInputs inputs_of(const RunRecord& record, const Scene& scene, const OpeningResult& result) {
    const Parachute& chute = scene.parachutes.front();
    const Inflation inflation =
        make_inflation(scene, chute, result.snatch_time, result.snatch_speed, result.snatch_density);
    OpeningForceInputs in;
    in.speed = result.snatch_speed;
    in.density = result.snatch_density;
    const Event* snatch = record.find_event(chute.deploy.starts_packed() ? "snatch" : "line-stretch");
    in.altitude = snatch != nullptr ? snatch->altitude : scene.release.altitude;
    in.gravity = scene.environment.gravity;
    in.mass = scene.payload.mass + chute.mass;
    in.drag_area = inflation.steady_drag_area;
    in.filling_time = inflation.filling_time;
    in.initial_time = inflation.initial_time;
    in.eta = inflation.eta;
    in.law = inflation.law;
    in.table = inflation.table;
    in.exponent = inflation.exponent;
    in.coefficient = chute.opening_force_coefficient;
    if (scene.aerodynamics.added_mass)
        in.added_mass =
            scene.aerodynamics.added_mass
                ->mass(in.density, {steady_radius(chute), 0.0}, {1.0, 0.0}, chute.geometric_porosity)
                .value;
    return in;
}

}  // namespace

void add_estimates(RunRecord& record, const Scene& scene, const OpeningResult& result) {
    if (!result.snatched || !result.peak_force || !(result.snatch_speed > 0.0)) return;
    if (scene.parachutes.front().filling.is_predicted()) return;  // the forms take a filling time and a law
    const OpeningForceInputs in = inputs_of(record, scene, result);
    const double share = scene.payload.mass / in.mass;
    for (const OpeningForceForm& form : opening_force_forms()) {
        const double force = share * form.force(in);
        if (!std::isfinite(force)) continue;
        const bool by_mach = scene.parachutes.front().drag_area_mach_table.has_value();
        record.estimates.push_back({std::string(form.name), std::string(form.title), "peak_force_N", force,
                                    std::string(form.source),
                                    by_mach ? "its drag area knows no Mach number" : form.outside(in)});
    }
}

}  // namespace twinchute::rom
