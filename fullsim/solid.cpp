#include "fullsim/solid.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace twinchute::fullsim {
namespace {

constexpr int cylinder_sides = 96;

double volume_of(const Tetrahedron& t) {
    return (t[1] - t[0]).cross(t[2] - t[0]).dot(t[3] - t[0]) / 6.0;
}

}  // namespace

Solid make_box(double x, double y, double z) {
    const auto corner = [&](int i, int j, int k) {
        return Vec3((i - 0.5) * x, (j - 0.5) * y, (k - 0.5) * z);
    };
    // Four at every second corner, the fifth between them.
    return {{corner(0, 0, 0), corner(1, 0, 0), corner(0, 1, 0), corner(0, 0, 1)},
            {corner(1, 1, 0), corner(0, 1, 0), corner(1, 0, 0), corner(1, 1, 1)},
            {corner(1, 0, 1), corner(0, 0, 1), corner(1, 1, 1), corner(1, 0, 0)},
            {corner(0, 1, 1), corner(1, 1, 1), corner(0, 0, 1), corner(0, 1, 0)},
            {corner(1, 0, 0), corner(0, 1, 0), corner(0, 0, 1), corner(1, 1, 1)}};
}

Solid make_cylinder(double diameter, double height, int sides) {
    Solid solid;
    const auto rim = [&](int k, double z) {
        const double angle = 2.0 * pi * k / sides;
        return Vec3(0.5 * diameter * std::cos(angle), 0.5 * diameter * std::sin(angle), z);
    };
    const double low = -0.5 * height, high = 0.5 * height;
    const Vec3 foot(0.0, 0.0, low), head(0.0, 0.0, high);
    for (int k = 0; k < sides; ++k) {
        // A wedge between the axis and two edges.
        const Vec3 a = rim(k, low), b = rim(k + 1, low), c = rim(k, high), d = rim(k + 1, high);
        solid.push_back({foot, a, b, head});
        solid.push_back({a, b, head, d});
        solid.push_back({a, d, head, c});
    }
    for (Tetrahedron& t : solid)
        if (volume_of(t) < 0.0) std::swap(t[2], t[3]);
    return solid;
}

Solid make_solid(const PayloadBody& body) {
    if (body.shape == PayloadBody::Shape::box) return make_box(body.size[0], body.size[1], body.size[2]);
    return make_cylinder(body.size[0], body.size[1], cylinder_sides);
}

Lumped lump(const Solid& solid, double mass) {
    Lumped body;
    for (const Tetrahedron& t : solid) {
        const double volume = volume_of(t);
        body.volume += volume;
        body.centre += 0.25 * volume * (t[0] + t[1] + t[2] + t[3]);
    }
    body.centre /= body.volume;
    Eigen::Matrix3d second = Eigen::Matrix3d::Zero();  // integral of x x^T over the volume
    for (const Tetrahedron& t : solid) {
        Eigen::Matrix3d corners = Eigen::Matrix3d::Zero();
        Vec3 sum = Vec3::Zero();
        for (const Vec3& x : t) {
            const Vec3 arm = x - body.centre;
            corners += arm * arm.transpose();
            sum += arm;
        }
        second += volume_of(t) / 20.0 * (corners + sum * sum.transpose());
    }
    body.inertia = mass / body.volume * (second.trace() * Eigen::Matrix3d::Identity() - second);
    return body;
}

}  // namespace twinchute::fullsim
