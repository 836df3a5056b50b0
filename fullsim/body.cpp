#include "fullsim/body.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>

#include "fullsim/attitude.hpp"
#include "fullsim/deformable_body.hpp"
#include "fullsim/forces/tetrahedra.hpp"
#include "fullsim/rigid_body.hpp"
#include "fullsim/solid.hpp"
#include "lib/scene/scene_error.hpp"

namespace twinchute::fullsim {
namespace {

constexpr double of_rounding = 1e-12;  // off the diagonal, over the trace

}  // namespace

std::unique_ptr<const Body> make_body(const Scene& scene, const Mesh& mesh) {
    if (!mesh.body) return nullptr;
    const BodyNodes nodes{mesh.payload(), mesh.first_attachment()};
    if (!mesh.body->deformable) return std::make_unique<RigidBody>(nodes, scene.payload.mass, *mesh.body);
    const double mass = mesh.mass[static_cast<std::size_t>(mesh.payload())];
    std::vector<double> masses = node_masses(mesh.body->solid, mass, mesh.body->lumped);
    if (masses.empty())
        throw SceneError({scene.file.string(), 0, 0}, "payload.body.elasticity",
                         fmt::format("{} tetrahedra cannot give way", mesh.body->solid.tetrahedron.size()),
                         "no masses at their nodes have the inertia of the body",
                         "mesh the payload finer, with nodes inside");
    return std::make_unique<DeformableBody>(nodes, std::move(masses), *mesh.body,
                                            solid_law(scene, *mesh.body), scene.environment.gravity);
}

Eigen::Matrix3d principal_axes(const Lumped& body) {
    const Eigen::Matrix3d& inertia = body.inertia;
    const Eigen::Matrix3d diagonal = inertia.diagonal().asDiagonal();
    // A box or a cylinder has those that it is drawn along, whichever moments are the same.
    if ((inertia - diagonal).norm() <= of_rounding * inertia.trace()) return Eigen::Matrix3d::Identity();
    Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(inertia).eigenvectors();
    if (axes.determinant() < 0.0) axes.col(2) *= -1.0;
    return axes;
}

Vec3 body_axis(const BodyState& state, const Eigen::Matrix3d& principal_axes) {
    return turn_of(state.attitude) * Vec3(principal_axes.row(2).transpose());
}

double tilt(const Vec3& axis) {
    return std::atan2(std::hypot(axis.x(), axis.y()), axis.z());
}

double attitude_in_air(const Vec3& axis, const Vec3& airspeed) {
    // The air goes past it the other way; from both products the angle is right near 0 and pi, too.
    return std::atan2(axis.cross(airspeed).norm(), -axis.dot(airspeed));
}

std::optional<Vec3> moments_of_payload(const Scene& scene) {
    const auto& body = scene.payload.body;
    if (!body || body->elasticity || body->shape == PayloadBody::Shape::mesh) return std::nullopt;
    return Vec3(lump(solid_of(make_solid(*body, 1)), scene.payload.mass).inertia.diagonal());
}

}  // namespace twinchute::fullsim
