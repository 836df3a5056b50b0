#include "fullsim/forces/membrane.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include "fullsim/elements/membrane.hpp"
#include "fullsim/forces/lanes_view.hpp"
#include "fullsim/forces/registry.hpp"

namespace twinchute::fullsim {

namespace law = HWY_NAMESPACE;

namespace {

law::SymmetricTensor<double> as_scalar(const PlaneTensor& e) {
    return {e.xx, e.yy, e.xy};
}

/// Four triangles side by side.
struct MembraneLanes {
    std::array<LaneNodes, 3> node;
    Lanes inverse_a, inverse_c, b_over_a;  // of the unstrained triangle [1/m], [1/m], [-]
    Lanes area;                            // [m^2] unstrained
    Lanes viscosity;                       // eta = b1 rho t c l [N s/m]
};

/// Wrapped, since a vector of raw lanes would lose its alignment in std::vector's template argument.
struct alignas(32) TriangleGroup : MembraneLanes {};

class MembraneElements : public TriangleLanes<TriangleGroup> {
public:
    HWY_INLINE MembraneElements(const std::vector<NodeRecord>& node, NodeForces::View on_node,
                                const TriangleGroup& group)
        : TriangleLanes(node, on_node, group) {}

    HWY_INLINE Lanes inverse_a() const { return g_.inverse_a; }
    HWY_INLINE Lanes inverse_c() const { return g_.inverse_c; }
    HWY_INLINE Lanes b_over_a() const { return g_.b_over_a; }
    HWY_INLINE Lanes weighted_area(double weight) const { return weight * g_.area; }
    HWY_INLINE Lanes viscosity() const { return g_.viscosity; }
};

class Membrane final : public ForceModel {
public:
    Membrane(const Mesh& mesh, double bulk_viscosity)
        : sheets_(static_cast<std::size_t>(mesh.sheets())), triangles_(mesh.triangles), dummy_(mesh.dummy()) {
        for (std::size_t i = 0; i < sheets_.size(); ++i)
            sheets_[i].law = membrane_law(mesh.fabric_of(static_cast<int>(i)), bulk_viscosity);
        for (std::size_t i = 0; i < triangles_.size(); ++i)
            sheets_[static_cast<std::size_t>(triangles_[i].sheet)].triangles.push_back(i);
    }

    Block block() const override { return Block::membrane; }
    std::size_t elements() const override { return triangles_.size(); }

    void add_forces(State& state) const override {
        for (const Sheet& sheet : sheets_)
            sweep(state, sheet.law, sheet.groups.get([&] { return make_groups(sheet); }));
    }

    TWINCHUTE_FOR_EACH_CPU void sweep(State& state, const MembraneLaw& of_sheet,
                                      const std::vector<TriangleGroup>& groups) const {
        const ElementSums sums = law::membrane_forces<true, AirOnFabric::none>(
            LanesView<MembraneElements>(state.node, state.force.view(), groups),
            {of_sheet, {}, 0.0, state.fe_weight});
        state.damping_power += sums.dissipated;
        state.largest.add_stress(state.fe_weight * sums.largest_load);
    }

    void add_row_sums(const State& state, GershgorinSums& sums) const override {
        for (const Triangle& t : triangles_) {
            const TriangleRows unstrained = unstrained_rows(law_of(t), t);
            const auto by = law::membrane_stiffening(as_scalar(green_strain(t, state)));
            const double stiffening = state.fe_weight * by.stiffness;
            const double elongation_rate = state.fe_weight * by.damping * unstrained.damping;
            const auto& [n0, n1, n2] = t.node;
            const std::array<double, 3> weight{1.0, sums.over(n1, n0), sums.over(n2, n0)};
            for (int i = 0; i < 3; ++i) {
                const double stiffness = unstrained.stiffness(i, weight);
                sums.stiffness[t.node[i]] += stiffening * stiffness;
                sums.damping[t.node[i]] += elongation_rate * stiffness;
            }
        }
    }

    double energy(const State& state) const override {
        double total = 0.0;
        for (const Triangle& t : triangles_)
            total += t.area() * membrane_energy(law_of(t), green_strain(t, state));
        return state.fe_weight * total;
    }

    StrainExtremum extreme(const State& state) const override {
        StrainExtremum most;
        for (std::size_t i = 0; i < triangles_.size(); ++i) {
            const double first = principal_values(green_strain(triangles_[i], state)).first;
            if (first > most.strain) most = {first, i};
        }
        // Fabric that is held by springs still may look strained to an element: it carries its share only.
        most.strain *= state.fe_weight;
        return most;
    }

    std::string element_name(std::size_t i) const override { return fmt::format("fabric triangle {}", i); }

private:
    /// Triangles of one fabric.
    struct Sheet {
        MembraneLaw law;
        std::vector<std::size_t> triangles;  // indices, rising
        GroupsOnDemand<TriangleGroup> groups;
    };

    const MembraneLaw& law_of(const Triangle& t) const {
        return sheets_[static_cast<std::size_t>(t.sheet)].law;
    }

    std::vector<TriangleGroup> make_groups(const Sheet& sheet) const {
        std::vector<TriangleGroup> groups;
        for (std::size_t first = 0; first < sheet.triangles.size(); first += lane_count) {
            TriangleGroup g{};
            for (int k = 0; k < lane_count; ++k) {
                if (first + k >= sheet.triangles.size()) {  // padding: no area, no force, on the dummy node
                    for (auto& corner : g.node)
                        corner[k] = dummy_;
                    continue;
                }
                const Triangle& t = triangles_[sheet.triangles[first + k]];
                for (int corner = 0; corner < 3; ++corner)
                    g.node[corner][k] = t.node[corner];
                g.inverse_a[k] = 1.0 / t.a;
                g.inverse_c[k] = 1.0 / t.c;
                g.b_over_a[k] = t.b / t.a;
                g.area[k] = t.area();
                g.viscosity[k] = sheet.law.viscosity * element_length(t);
            }
            groups.push_back(g);
        }
        return groups;
    }

    std::vector<Sheet> sheets_;
    const std::vector<Triangle>& triangles_;
    NodeIndex dummy_;
};

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

std::vector<MembraneLaw> membrane_laws(const Mesh& mesh, double bulk_viscosity) {
    std::vector<MembraneLaw> laws;
    for (int sheet = 0; sheet < mesh.sheets(); ++sheet)
        laws.push_back(membrane_law(mesh.fabric_of(sheet), bulk_viscosity));
    return laws;
}

Principal principal_values(const PlaneTensor& tensor) {
    const auto p = law::principal(as_scalar(tensor));
    return {p.first(), p.second()};
}

PlaneTensor membrane_stress(const MembraneLaw& fabric, const PlaneTensor& strain, FabricState* state) {
    const auto e = as_scalar(strain);
    const auto p = law::principal(e);
    if (state)
        *state = p.first() <= 0.0                                ? FabricState::slack
                 : p.second() + fabric.poisson * p.first() > 0.0 ? FabricState::taut
                                                                 : FabricState::wrinkled;
    const auto n = law::turned_back(law::relaxed_stress(fabric, p), p.half_difference * p.inverse_radius,
                                    e.xy * p.inverse_radius);
    return {n.xx, n.yy, n.xy};
}

std::vector<double> first_stresses(std::span<const Triangle> triangles, std::span<const MembraneLaw> laws,
                                   const State& state) {
    std::vector<double> stresses(triangles.size());
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const Triangle& t = triangles[i];
        const auto at = [&](int corner) { return to_vec3(state.node[t.node[corner]].x); };
        const Vec3 origin = at(0), e1 = at(1) - origin, e2 = at(2) - origin;
        const auto strain =
            law::green_strain(law::deformation_gradient(1.0 / t.a, 1.0 / t.c, t.b / t.a, e1, e2));
        stresses[i] =
            law::relaxed_stress(laws[static_cast<std::size_t>(t.sheet)], law::principal(strain)).first;
    }
    return stresses;
}

double membrane_energy(const MembraneLaw& fabric, const PlaneTensor& strain) {
    return law::relaxed_energy(fabric, law::principal(as_scalar(strain)));
}

PlaneTensor green_strain(const Triangle& t, const std::array<Vec3, 3>& corner) {
    const Vec3 e1 = corner[1] - corner[0], e2 = corner[2] - corner[0];
    const auto strain = law::green_strain(law::deformation_gradient(1.0 / t.a, 1.0 / t.c, t.b / t.a, e1, e2));
    return {strain.xx, strain.yy, strain.xy};
}

PlaneTensor green_strain(const Triangle& t, const State& state) {
    return green_strain(t, {to_vec3(state.node[t.node[0]].x), to_vec3(state.node[t.node[1]].x),
                            to_vec3(state.node[t.node[2]].x)});
}

std::unique_ptr<const ForceModel> make_membrane(const Mesh& mesh, double bulk_viscosity) {
    return std::make_unique<Membrane>(mesh, bulk_viscosity);
}

}  // namespace twinchute::fullsim
