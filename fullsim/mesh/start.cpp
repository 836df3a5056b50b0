#include "fullsim/mesh/start.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <span>

#include "fullsim/canopy/canopy_geometry.hpp"
#include "fullsim/canopy/cross.hpp"
#include "fullsim/mesh/attach_payload.hpp"
#include "fullsim/mesh/cross_mesh.hpp"
#include "fullsim/mesh/gore_mesh.hpp"
#include "fullsim/mesh/line_stretch_configuration.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/scene/needs.hpp"
#include "lib/scene/scene_error.hpp"
#include "lib/solve/opening.hpp"

namespace twinchute::fullsim {
namespace {

/// Opening force [N] at the instant of line stretch: that of payload and parachute as one rigid
/// body, m_l (D + M_a g)/(m + M_a) along the lines: gravity pulls the payload out of the air, too.
double load_at_start(const Scene& scene, const Inflation& inflation, Phase phase) {
    const Parachute& chute = scene.parachutes.front();
    const double rho = scene.environment.atmosphere.at(scene.release.altitude).density;
    double drag = 0.5 * rho * release_airspeed(scene).squaredNorm() * inflation.steady_drag_area *
                  inflation.drag_area_ratio(phase, inflation.snatch).value;
    if (const auto& table = chute.drag_area_mach_table)
        drag *= table->factor(release_airspeed(scene).norm() /
                              *scene.environment.atmosphere.speed_of_sound(scene.release.altitude));
    const double added = scene.aerodynamics.added_mass
                             ? inflation
                                   .added_mass(*scene.aerodynamics.added_mass, phase, inflation.snatch, rho,
                                               steady_radius(chute), chute.geometric_porosity)
                                   .value
                             : 0.0;
    const double held_back = added * scene.environment.gravity * trailing_direction(scene).z();
    return std::max(0.0, scene.payload.mass * (drag + held_back) / (scene.payload.mass + chute.mass + added));
}

Mesh drawn_out(const Scene& scene, const Vec3& axis, double mouth_area, double load) {
    const Parachute& chute = scene.parachutes.front();
    if (chute.mesh)
        return line_stretch_configuration(import_mesh(scene), scene, axis, mouth_area, load,
                                          chute.deploy.by == DeployBy::inflated);
    if (cross_arm_ratio(chute) > 0.0) {
        const ImportedMesh cross = make_cross_mesh(chute, scene.full.mesh, scene.payload.mass);
        const auto nodes =
            std::span(cross.mesh.position).first(static_cast<std::size_t>(cross.mesh.canopy_nodes));
        return drawn_out_with(cross, folded_cross(cross_outline(chute), nodes, mouth_area), scene, axis,
                              load);
    }
    try {
        return make_gore_mesh(chute, scene.full.mesh, scene.payload.mass, axis, mouth_area, load);
    } catch (const SceneError& error) {
        throw SceneError({scene.file.string()}, error.key(), error.problem(), error.why(),
                         error.suggestion());
    }
}

/// Static line elements over those of suspension lines, in length: on light vent nodes, and held by many legs
/// at one end, they would set the step of the whole parachute where lines take subcycles. As many times as
/// lines take subcycles then, or this.
constexpr double coarser_than_lines = 4.0;
constexpr double fewest_elements = 4.0;  // of a static line

/// As strong as one of four risers would be: by one leg from each of the vent's seams, together as strong, to
/// the apex, from there to the anchor. `axis`: from payload to apex.
/// vent_radius: of the seams' ends there, as cut [m].
StaticLine rig_static_line(const Mesh& mesh, const Scene& scene, double vent_radius) {
    const Parachute& chute = scene.parachutes.front();
    const auto& vent = mesh.seam_rings.front();
    const double strands = std::max(1.0, 0.25 * static_cast<double>(mesh.seam_rings.back().size()));
    const double length = chute.deploy.static_line_length;
    const auto of_line = std::ranges::find(mesh.cables, CableKind::line, &Cable::kind);
    const double coarser = std::max(coarser_than_lines, 1.0 * scene.full.line_substeps);
    const double element = std::min(coarser * of_line->rest_length, length / fewest_elements);
    const int elements = static_cast<int>(std::lround(length / element));
    const double linear = chute.line.linear_density();
    // Without a vent the line itself is tied to the apex, by its first element.
    const bool has_legs = vent.size() > 1;
    const double l0 = length / (has_legs ? elements : elements + 1);
    const double leg = has_legs ? vent_radius : l0;

    StaticLine line;
    Vec3 apex = Vec3::Zero();
    for (const NodeIndex i : vent)
        apex += mesh.position[i] / static_cast<double>(vent.size());
    const NodeIndex first = mesh.first_static_line_node();
    for (int k = 0; k <= elements; ++k) {
        // Packed like the rest: a line of no length has no direction.
        line.position.push_back(has_legs
                                    ? Vec3(apex + chute.deploy.pack_ratio * length * k / elements * mesh.axis)
                                    : Vec3(apex + chute.deploy.pack_ratio * l0 * (k + 1) * mesh.axis));
        line.mass.push_back(0.0);
    }
    for (const NodeIndex i : vent)
        line.cables.push_back(
            {{i, first}, leg, strands / static_cast<double>(vent.size()), CableKind::static_line});
    line.mass[0] += linear * leg * strands;
    for (int k = 0; k < elements; ++k) {
        line.cables.push_back({{first + k, first + k + 1}, l0, strands, CableKind::static_line});
        line.mass[k] += 0.5 * linear * strands * l0;
        line.mass[k + 1] += 0.5 * linear * strands * l0;
    }
    line.mass.back() = 0.0;
    return line;
}

/// [m] of the vent's seams, as cut.
double cut_vent_radius(const Scene& scene) {
    const Parachute& chute = scene.parachutes.front();
    if (cross_arm_ratio(chute) > 0.0) return 0.0;
    if (!chute.mesh) return canopy_geometry(chute).outline(chute).vent;
    const Mesh mesh = built_mesh(scene);
    double sum = 0.0;
    for (const NodeIndex i : mesh.seam_rings.front())
        sum += mesh.position[i].head<2>().norm();
    return sum / static_cast<double>(mesh.seam_rings.front().size());
}

}  // namespace

Mesh built_mesh(const Scene& scene) {
    const Parachute& chute = scene.parachutes.front();
    if (cross_arm_ratio(chute) > 0.0) return make_cross_mesh(chute, scene.full.mesh, scene.payload.mass).mesh;
    return chute.mesh ? import_mesh(scene).mesh
                      : make_constructed_mesh(chute, scene.full.mesh, scene.payload.mass);
}

Scene weighed(const Scene& scene) {
    Scene meshed = scene;
    for (std::size_t p = 0; p < scene.parachutes.size(); ++p) {
        Scene one = scene;
        one.parachutes = {scene.parachutes[p]};
        meshed.parachutes[p].mass = built_mesh(one).parachute_mass();
    }
    return meshed;
}

Vec3 trailing_direction(const Scene& scene) {
    const Vec3 velocity = release_airspeed(scene);
    return velocity.norm() > 0.0 ? Vec3(-velocity.normalized()) : Vec3::UnitZ();
}

Vec3 start_axis(const Scene& scene) {
    const Vec3 behind = trailing_direction(scene);
    const auto& deploy = scene.parachutes.front().deploy;
    if (!deploy.starts_packed()) return behind;
    const Vec3 across = Vec3::UnitZ().cross(heading_direction(scene.release));
    return Eigen::AngleAxisd(deploy.pitch, across) * behind;
}

Mesh unloaded_mesh(const Scene& scene) {
    return drawn_out(scene, start_axis(scene), mouth_area_at_line_stretch(scene.parachutes.front()), 0.0);
}

void pack(Mesh& mesh, double ratio) {
    for (Vec3& position : mesh.position)
        position *= ratio;
}

Mesh start_mesh(const Scene& scene, const Inflation& inflation, Phase phase) {
    const Parachute& chute = scene.parachutes.front();
    if (chute.deploy.starts_packed()) {
        Mesh mesh = unloaded_mesh(scene);
        pack(mesh, chute.deploy.pack_ratio);
        if (scene.payload.body) attach_payload(scene, mesh, Hang::packed);
        if (chute.deploy.by == DeployBy::static_line)
            mesh.static_line = rig_static_line(mesh, scene, cut_vent_radius(scene));
        return mesh;
    }
    const double open = 0.25 * pi * std::pow(2.0 * steady_radius(chute), 2);
    Mesh mesh = drawn_out(scene, trailing_direction(scene),
                          chute.deploy.by == DeployBy::inflated ? open : mouth_area_at_line_stretch(chute),
                          load_at_start(scene, inflation, phase));
    if (scene.payload.body) attach_payload(scene, mesh, Hang::drawn_out);
    return mesh;
}

}  // namespace twinchute::fullsim
