#include "lib/scene/line_stretch.hpp"

#include <algorithm>
#include <cmath>

#include "lib/math/vec.hpp"

namespace twinchute {

Vec3 velocity_over_ground(const Release& r) {
    return r.speed * Vec3(std::cos(r.path_angle) * std::sin(r.heading),
                          std::cos(r.path_angle) * std::cos(r.heading), -std::sin(r.path_angle));
}

Vec3 release_airspeed(const Scene& scene) {
    const Vec3 velocity = velocity_over_ground(scene.release);
    return scene.environment.wind ? Vec3(velocity - scene.environment.wind->at(scene.release.altitude))
                                  : velocity;
}

double smallest_projected_area(const Parachute& chute) {
    const double scale = chute.nominal_diameter / 8.53;
    return 0.05 * scale * scale;
}

double mouth_area_at_line_stretch(const Parachute& chute) {
    const double steady_diameter = chute.projected_diameter_ratio * chute.nominal_diameter;
    const double share =
        chute.filling.is_predicted() ? chute.filling.initial_mouth : chute.initial_drag_area_ratio;
    const double area =
        std::max(share * 0.25 * pi * steady_diameter * steady_diameter, smallest_projected_area(chute));
    if (!chute.filling.is_predicted() || chute.reefing.empty()) return area;
    const double side = reefing_line_length(chute, 0) / chute.gores;  // of the largest polygon in its line
    return std::min(area, 0.25 * chute.gores * side * side / std::tan(pi / chute.gores));
}

double mouth_radius_at_line_stretch(const Parachute& chute) {
    const double polygon = 0.5 * chute.gores * std::sin(2.0 * pi / chute.gores);
    return std::sqrt(mouth_area_at_line_stretch(chute) / polygon);
}

double line_stiffness(const Parachute& chute) {
    return chute.count * chute.gores * chute.line.axial_stiffness() /
           (chute.line_length + chute.riser_length);
}

FillTimeInputs fill_inputs(const Scene& scene, const Parachute& chute, double speed, double density) {
    FillTimeInputs in;
    in.nominal_diameter = chute.nominal_diameter;
    in.snatch_speed = speed;
    in.density = density;
    in.payload_mass = scene.payload.mass / chute.count;
    in.mass = in.payload_mass + chute.mass;
    in.gravity = scene.environment.gravity;
    in.drag_area = chute.drag_area * chute.cluster_drag_ratio;
    in.steady_radius = 0.5 * chute.projected_diameter_ratio * chute.nominal_diameter;
    in.permeability = chute.permeability.value_or(
        chute.fabric.permeability.value_or(Permeability{}).speed(permeability_pressure));
    in.geometric_porosity = chute.geometric_porosity;
    return in;
}

double reefing_line_length(const Parachute& chute, std::size_t stage) {
    const Reefing& reefing = chute.reefing[stage];
    const double steady_diameter = chute.projected_diameter_ratio * chute.nominal_diameter;
    return reefing.line_length.value_or(pi * steady_diameter * std::sqrt(reefing.drag_area_ratio));
}

}  // namespace twinchute
