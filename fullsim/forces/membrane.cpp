#include "fullsim/forces/membrane.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include "fullsim/forces/membrane_kernel.hpp"
#include "fullsim/forces/registry.hpp"

namespace twinchute::fullsim {

using HWY_NAMESPACE::membrane_pulls, HWY_NAMESPACE::principal, HWY_NAMESPACE::relaxed_energy,
    HWY_NAMESPACE::relaxed_stress, HWY_NAMESPACE::SymmetricTensor, HWY_NAMESPACE::turned_back;

namespace {

/// Four triangles side by side.
struct MembraneLanes {
    std::array<LaneNodes, 3> node;
    Lanes inverse_a, inverse_c, b_over_a;  // of the unstrained triangle [1/m], [1/m], [-]
    Lanes area;                            // [m^2] unstrained
    Lanes viscosity;                       // eta = b1 rho t c l [N s/m]
};

/// Wrapped, since a vector of raw lanes would lose its alignment in std::vector's template argument.
struct alignas(32) Group : MembraneLanes {};

class Membrane final : public ForceModel {
public:
    Membrane(const Mesh& mesh, double bulk_viscosity)
        : law_(membrane_law(mesh.fabric, bulk_viscosity)), triangles_(mesh.triangles), dummy_(mesh.dummy()) {}

    std::string_view name() const override { return "membrane"; }
    std::size_t elements() const override { return triangles_.size(); }

    void add_forces(State& state) const override {
        sweep(state, groups_.get([this] { return make_groups(); }));
    }

    TWINCHUTE_FOR_EACH_CPU void sweep(State& state, const std::vector<Group>& groups) const {
        Lanes dissipated = splat(0.0), most = dissipated;
        const Lanes weight = splat(state.fe_weight);
        const NodeForces::View on_node = state.force.view();
        for (const Group& g : groups) {
            const Lanes3 x0 = gather_position(state.node, g.node[0]);
            const Lanes3 e1 = gather_position(state.node, g.node[1]) - x0;
            const Lanes3 e2 = gather_position(state.node, g.node[2]) - x0;
            const Lanes3 v0 = gather_velocity(state.node, g.node[0]);
            const Lanes3 w1 = gather_velocity(state.node, g.node[1]) - v0;
            const Lanes3 w2 = gather_velocity(state.node, g.node[2]) - v0;
            const auto pulls = membrane_pulls(law_, g.inverse_a, g.inverse_c, g.b_over_a, weight * g.area,
                                              g.viscosity, e1, e2, w1, w2);
            dissipated += pulls.dissipated;
            most = larger(pulls.stress, most);
            const CornerForces c0(pulls.on_first), c1(pulls.on_second), c2(pulls.on_third);
            for (int k = 0; k < lane_count; ++k) {
                on_node[g.node[0][k]].value += c0.row[k];
                on_node[g.node[1][k]].value -= c1.row[k];
                on_node[g.node[2][k]].value -= c2.row[k];
            }
        }
        state.damping_power += sum(dissipated);
        state.largest.add_stress(state.fe_weight * greatest_or_none(most, sum(dissipated)));
    }

    void add_row_sums(const State& state, RowSums& sums) const override {
        for (const Triangle& t : triangles_) {
            const TriangleRows unstrained = unstrained_rows(law_, t);
            const double stretch = std::max(0.0, first_principal(strain_of(state, t)));
            // St. Venant-Kirchhoff stiffens with stretch: lambda^2 and the stress itself, 1 + 3 E_1.
            const double stiffening = state.fe_weight * (1.0 + 3.0 * stretch);
            const double lengthening = state.fe_weight * (1.0 + 2.0 * stretch) * unstrained.damping;
            const auto& [n0, n1, n2] = t.node;
            const std::array<double, 3> weight{1.0, sums.over(n1, n0), sums.over(n2, n0)};
            for (int i = 0; i < 3; ++i) {
                const double stiffness = unstrained.stiffness(i, weight);
                sums.stiffness[t.node[i]] += stiffening * stiffness;
                sums.damping[t.node[i]] += lengthening * stiffness;
            }
        }
    }

    double energy(const State& state) const override {
        double total = 0.0;
        for (const Triangle& t : triangles_)
            total += t.area() * membrane_energy(law_, strain_of(state, t));
        return state.fe_weight * total;
    }

    Extreme extreme(const State& state) const override {
        Extreme most;
        for (std::size_t i = 0; i < triangles_.size(); ++i) {
            const double first = first_principal(strain_of(state, triangles_[i]));
            if (first > most.strain) most = {first, i};
        }
        // Cloth that is held by springs still may look strained to an element: it carries its share only.
        most.strain *= state.fe_weight;
        return most;
    }

    std::string element_name(std::size_t i) const override { return fmt::format("fabric triangle {}", i); }

private:
    std::vector<Group> make_groups() const {
        std::vector<Group> groups;
        for (std::size_t first = 0; first < triangles_.size(); first += lane_count) {
            Group g{};
            for (int k = 0; k < lane_count; ++k) {
                if (first + k >= triangles_.size()) {  // padding: no area, no force, on the dummy node
                    for (auto& corner : g.node)
                        corner[k] = dummy_;
                    continue;
                }
                const Triangle& t = triangles_[first + k];
                for (int corner = 0; corner < 3; ++corner)
                    g.node[corner][k] = t.node[corner];
                g.inverse_a[k] = 1.0 / t.a;
                g.inverse_c[k] = 1.0 / t.c;
                g.b_over_a[k] = t.b / t.a;
                g.area[k] = t.area();
                g.viscosity[k] = law_.viscosity * element_length(t);
            }
            groups.push_back(g);
        }
        return groups;
    }

    static PlaneTensor strain_of(const State& state, const Triangle& t) {
        return green_strain(t, {to_vec3(state.node[t.node[0]].x), to_vec3(state.node[t.node[1]].x),
                                to_vec3(state.node[t.node[2]].x)});
    }

    static double first_principal(const PlaneTensor& e) {
        const double half = 0.5 * (e.xx - e.yy);
        return 0.5 * (e.xx + e.yy) + std::sqrt(half * half + e.xy * e.xy);
    }

    MembraneLaw law_;
    const std::vector<Triangle>& triangles_;
    NodeIndex dummy_;
    GroupsOnDemand<Group> groups_;
};

SymmetricTensor<double> as_scalar(const PlaneTensor& e) {
    return {e.xx, e.yy, e.xy};
}

}  // namespace

double element_length(const Triangle& t) {
    return t.a * t.c / std::max({t.a, std::hypot(t.b, t.c), std::hypot(t.b - t.a, t.c)});
}

TriangleRows unstrained_rows(const MembraneLaw& law, const Triangle& t) {
    const double twice_area = t.a * t.c;
    const double gradient[3] = {std::hypot(t.b - t.a, t.c) / twice_area, std::hypot(t.b, t.c) / twice_area,
                                t.a / twice_area};
    const double root = std::sqrt(law.plane_modulus * t.area());
    return {{root * gradient[0], root * gradient[1], root * gradient[2]},
            law.viscosity * element_length(t) / law.plane_modulus};
}

MembraneLaw membrane_law(const Fabric& fabric, double bulk_viscosity) {
    const double nu = fabric.poisson_ratio;
    const double plane = 1.0 / (1.0 - nu * nu);
    const double wave_speed = std::sqrt(fabric.youngs_modulus * plane / fabric.density);
    const double modulus = fabric.youngs_modulus * fabric.thickness;
    return {modulus, modulus * plane, nu, bulk_viscosity * fabric.density * fabric.thickness * wave_speed};
}

PlaneTensor membrane_stress(const MembraneLaw& law, const PlaneTensor& strain, FabricState* state) {
    const auto e = as_scalar(strain);
    const auto p = principal(e);
    if (state)
        *state = p.first() <= 0.0                             ? FabricState::slack
                 : p.second() + law.poisson * p.first() > 0.0 ? FabricState::taut
                                                              : FabricState::wrinkled;
    const auto n =
        turned_back(relaxed_stress(law, p), p.half_difference * p.inverse_radius, e.xy * p.inverse_radius);
    return {n.xx, n.yy, n.xy};
}

double membrane_energy(const MembraneLaw& law, const PlaneTensor& strain) {
    return relaxed_energy(law, principal(as_scalar(strain)));
}

PlaneTensor green_strain(const Triangle& t, const std::array<Vec3, 3>& corner) {
    const Vec3 e1 = corner[1] - corner[0], e2 = corner[2] - corner[0];
    const Vec3 f1 = e1 / t.a, f2 = (e2 - t.b / t.a * e1) / t.c;
    return {0.5 * (f1.squaredNorm() - 1.0), 0.5 * (f2.squaredNorm() - 1.0), 0.5 * f1.dot(f2)};
}

std::unique_ptr<const ForceModel> make_membrane(const Mesh& mesh, double bulk_viscosity) {
    return std::make_unique<Membrane>(mesh, bulk_viscosity);
}

}  // namespace twinchute::fullsim
