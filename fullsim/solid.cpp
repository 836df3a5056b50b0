#include "fullsim/solid.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

namespace twinchute::fullsim {
namespace {

constexpr int cylinder_sides = 96;

double volume_of(const Tetrahedron& t) {
    return (t[1] - t[0]).cross(t[2] - t[0]).dot(t[3] - t[0]) / 6.0;
}

void turn_outward(SolidMesh& mesh) {
    const Solid solid = solid_of(mesh);
    for (std::size_t i = 0; i < solid.size(); ++i)
        if (volume_of(solid[i]) < 0.0) std::swap(mesh.tetrahedron[i][2], mesh.tetrahedron[i][3]);
}

/// 1, the coordinates, and their products, over a length and its square.
using Moments = Eigen::Matrix<double, 10, 1>;
Moments moments_at(const Vec3& x) {
    Moments m;
    m << 1.0, x, x.cwiseProduct(x), x.x() * x.y(), x.y() * x.z(), x.z() * x.x();
    return m;
}

}  // namespace

Solid solid_of(const SolidMesh& mesh) {
    Solid solid;
    for (const auto& corner : mesh.tetrahedron) {
        Tetrahedron& t = solid.emplace_back();
        for (std::size_t c = 0; c < 4; ++c)
            t[c] = mesh.node[static_cast<std::size_t>(corner[c])];
    }
    return solid;
}

SolidMesh make_box(const Vec3& edges, const std::array<int, 3>& cells) {
    SolidMesh mesh;
    const auto number = [&](const std::array<int, 3>& at) {
        return (at[2] * (cells[1] + 1) + at[1]) * (cells[0] + 1) + at[0];
    };
    for (int k = 0; k <= cells[2]; ++k)
        for (int j = 0; j <= cells[1]; ++j)
            for (int i = 0; i <= cells[0]; ++i)
                mesh.node.push_back(edges.cwiseProduct(Vec3(static_cast<double>(i) / cells[0] - 0.5,
                                                            static_cast<double>(j) / cells[1] - 0.5,
                                                            static_cast<double>(k) / cells[2] - 0.5)));
    // Kuhn's: along the axes in any order from one corner of a cell to the opposite one. Cells that are all
    // alike fit together.
    constexpr std::array<std::array<int, 3>, 6> orders{
        {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
    for (int k = 0; k < cells[2]; ++k)
        for (int j = 0; j < cells[1]; ++j)
            for (int i = 0; i < cells[0]; ++i)
                for (const auto& order : orders) {
                    std::array<int, 3> at{i, j, k};
                    std::array<int, 4>& t = mesh.tetrahedron.emplace_back();
                    t[0] = number(at);
                    for (std::size_t c = 0; c < 3; ++c) {
                        ++at[static_cast<std::size_t>(order[c])];
                        t[c + 1] = number(at);
                    }
                }
    turn_outward(mesh);
    return mesh;
}

SolidMesh make_cylinder(double diameter, double height, int sides, int layers) {
    SolidMesh mesh;
    for (int layer = 0; layer <= layers; ++layer) {
        const double z = height * (static_cast<double>(layer) / layers - 0.5);
        mesh.node.emplace_back(0.0, 0.0, z);
        for (int k = 0; k < sides; ++k) {
            const double angle = 2.0 * pi * k / sides;
            mesh.node.emplace_back(0.5 * diameter * std::cos(angle), 0.5 * diameter * std::sin(angle), z);
        }
    }
    for (int layer = 0; layer < layers; ++layer)
        for (int k = 0; k < sides; ++k) {
            // A wedge between the axis and two edges; faces to its neighbours are cut from rim to head.
            const int foot = layer * (sides + 1), head = foot + sides + 1;
            const int a = foot + 1 + k, b = foot + 1 + (k + 1) % sides, c = a + sides + 1, d = b + sides + 1;
            mesh.tetrahedron.push_back({foot, a, b, head});
            mesh.tetrahedron.push_back({a, b, head, d});
            mesh.tetrahedron.push_back({a, d, head, c});
        }
    turn_outward(mesh);
    return mesh;
}

namespace {

/// Risers are tied half-way between multiples of a turn over their number: at every second of so many sides.
int sides_near(int wanted, int risers) {
    const int each = 2 * risers;
    return each * std::max(wanted > each ? 1 : 2, static_cast<int>(std::lround(1.0 * wanted / each)));
}

/// Even, so that the middle of a face is a node.
std::array<int, 3> cells_of(const Vec3& edges) {
    std::array<int, 3> cells{};
    for (std::size_t i = 0; i < 3; ++i)
        cells[i] = 2 * static_cast<int>(std::clamp(
                           std::lround(edges[static_cast<Eigen::Index>(i)] / edges.minCoeff()), 1L, 4L));
    return cells;
}

}  // namespace

SolidMesh make_solid(const PayloadBody& body, int risers) {
    if (body.shape == PayloadBody::Shape::cylinder)
        return make_cylinder(body.size[0], body.size[1], sides_near(cylinder_sides, risers));
    const Vec3 edges(body.size[0], body.size[1], body.size[2]);
    return make_box(edges, cells_of(edges));
}

SolidMesh make_coarse_solid(const PayloadBody& body, int risers) {
    if (body.shape == PayloadBody::Shape::box) return make_solid(body, risers);
    const long layers = std::clamp(std::lround(2.0 * body.size[1] / body.size[0]), 2L, 8L);
    return make_cylinder(body.size[0], body.size[1], sides_near(8, risers), static_cast<int>(layers));
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

std::vector<double> node_masses(const SolidMesh& solid, double mass, const Lumped& body) {
    const std::size_t count = solid.node.size();
    std::vector<double> share(count, 0.0);  // of the mass
    const Solid tetrahedra = solid_of(solid);
    double volume = 0.0;
    for (const Tetrahedron& t : tetrahedra)
        volume += volume_of(t);
    for (std::size_t i = 0; i < tetrahedra.size(); ++i)
        for (const int c : solid.tetrahedron[i])
            share[static_cast<std::size_t>(c)] += 0.25 * volume_of(tetrahedra[i]) / volume;
    // Second moments from the inertia, J = tr(S) 1 - S.
    const Eigen::Matrix3d second =
        (0.5 * body.inertia.trace() * Eigen::Matrix3d::Identity() - body.inertia) / mass;
    const double length = std::sqrt(second.trace());
    Moments wanted;
    wanted << 1.0, Vec3::Zero(), second.diagonal(), second(0, 1), second(1, 2), second(2, 0);
    wanted.tail<6>() /= length * length;
    std::vector<Moments> at;
    for (const Vec3& x : solid.node)
        at.push_back(moments_at(x / length));
    // Newton's method for what makes the convex sum of share exp(u . moments) - u . wanted smallest.
    Moments u = Moments::Zero();
    const auto level = [&](const Moments& at_u) {
        double sum = -at_u.dot(wanted);
        for (std::size_t i = 0; i < count; ++i)
            sum += share[i] * std::exp(at_u.dot(at[i]));
        return sum;
    };
    for (int k = 0; k < 100; ++k) {
        Moments missing = wanted;
        Eigen::Matrix<double, 10, 10> slope = Eigen::Matrix<double, 10, 10>::Zero();
        for (std::size_t i = 0; i < count; ++i) {
            const double m = share[i] * std::exp(u.dot(at[i]));
            missing -= m * at[i];
            slope += m * at[i] * at[i].transpose();
        }
        if (missing.norm() < 1e-14) break;
        const Moments step = slope.ldlt().solve(missing);
        double length_of_step = 1.0;
        while (length_of_step > 1e-6 && !(level(u + length_of_step * step) < level(u) + 1e-15))
            length_of_step *= 0.5;
        u += length_of_step * step;
    }
    std::vector<double> masses(count);
    Moments reached = Moments::Zero();
    for (std::size_t i = 0; i < count; ++i) {
        masses[i] = mass * share[i] * std::exp(u.dot(at[i]));
        reached += masses[i] / mass * at[i];
    }
    if (!((reached - wanted).norm() < 1e-11)) return {};
    return masses;
}

}  // namespace twinchute::fullsim
