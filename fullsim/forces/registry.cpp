#include "fullsim/forces/registry.hpp"

#include "fullsim/mesh/gore_mesh.hpp"

namespace twinchute::fullsim {

ForceModels make_structure(const Scene& scene, const Mesh& mesh) {
    ForceModels models;
    models.push_back(make_membrane(mesh, scene.full.bulk_viscosity));
    models.push_back(make_cable(mesh, scene.full.bulk_viscosity));
    return models;
}

ForceModels make_loads(const Scene& scene, const Mesh& mesh) {
    const Aerodynamics& aero = scene.aerodynamics;
    ForceModels models;
    models.push_back(make_canopy_pressure(mesh, smallest_projected_area(scene.parachutes.front())));
    if (aero.line_drag) models.push_back(make_line_drag(mesh));
    if (aero.breathing_damping) models.push_back(make_breathing_damping(mesh, *aero.breathing_damping));
    if (scene.payload.drag_area) models.push_back(make_payload_drag(mesh, *scene.payload.drag_area));
    if (scene.full.alpha > 0.0) models.push_back(make_mass_damping(mesh, scene.full.alpha));
    return models;
}

}  // namespace twinchute::fullsim
