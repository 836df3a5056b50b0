#include "fullsim/forces/tetrahedra.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace twinchute::fullsim {
namespace {

using Matrix3 = Eigen::Matrix3d;
using Corners = Eigen::Matrix<double, 3, 4>;  // a column each

struct Element {
    std::array<NodeIndex, 4> node;
    Corners gradient;  // of the shape functions, unstrained [1/m]
    double volume;     // [m^3]
    double bulk;       // [Pa s] bulk viscosity
};

/// Largest singular value.
double norm_of(const Matrix3& a) {
    Eigen::SelfAdjointEigenSolver<Matrix3> squares;
    squares.computeDirect(a.transpose() * a, Eigen::EigenvaluesOnly);
    return std::sqrt(std::max(0.0, squares.eigenvalues()[2]));
}

class Tetrahedra final : public ForceModel {
public:
    Tetrahedra(const SolidMesh& solid, const SolidLaw& law, NodeIndex first_node) : law_(law) {
        elements_.reserve(solid.tetrahedron.size());
        for (const auto& corner : solid.tetrahedron) {
            Element e{};
            Matrix3 edges;
            const auto place = [&](std::size_t c) { return solid.node[static_cast<std::size_t>(corner[c])]; };
            for (std::size_t c = 0; c < 4; ++c)
                e.node[c] = first_node + corner[c];
            for (std::size_t c = 1; c < 4; ++c)
                edges.col(static_cast<Eigen::Index>(c) - 1) = place(c) - place(0);
            e.volume = edges.determinant() / 6.0;
            e.gradient.rightCols<3>() = edges.inverse().transpose();
            e.gradient.col(0) = -e.gradient.rightCols<3>().rowwise().sum();
            // The shortest height is one over the largest gradient.
            e.bulk = law.viscosity / std::sqrt(e.gradient.colwise().squaredNorm().maxCoeff());
            elements_.push_back(e);
        }
    }

    Block block() const override { return Block::payload_tetrahedra; }
    std::size_t elements() const override { return elements_.size(); }
    std::size_t bytes() const override { return elements_.capacity() * sizeof(Element); }
    std::string element_name(std::size_t i) const override {
        return fmt::format("payload tetrahedron {}", i);
    }

    void add_forces(State& state) const override {
        double dissipated = 0.0;
        for (const Element& e : elements_) {
            const Matrix3 f = deformation(state, e);
            Matrix3 stress = solid_stress(law_, green_strain(f));
            const Matrix3 rate = strain_rate(state, e, f);
            const Matrix3 viscous = viscous_stress(e, rate);
            stress += viscous;
            dissipated += e.volume * viscous.cwiseProduct(rate).sum();
            const Corners pull = e.volume * (f * stress) * e.gradient;
            for (std::size_t c = 0; c < 4; ++c)
                state.force[e.node[c]].value -= to_lanes(pull.col(static_cast<Eigen::Index>(c)));
        }
        state.damping_power += dissipated;
    }

    /// The blocks of the tangent: V F (lambda g_a g_b^T + mu (g_b g_a^T + g_a.g_b 1)) F^T + V (g_a.S g_b) 1.
    void add_row_sums(const State& state, GershgorinSums& sums) const override {
        for (const Element& e : elements_) {
            const Matrix3 f = deformation(state, e);
            const Matrix3 stress = solid_stress(law_, green_strain(f));
            for (Eigen::Index a = 0; a < 4; ++a)
                for (Eigen::Index b = 0; b <= a; ++b) {
                    const Vec3 ga = e.gradient.col(a), gb = e.gradient.col(b);
                    const Matrix3 outer = ga * gb.transpose();
                    const Matrix3 shear = outer.transpose() + ga.dot(gb) * Matrix3::Identity();
                    const auto block = [&](double lambda, double mu) {
                        return e.volume * norm_of(f * (lambda * outer + mu * shear) * f.transpose());
                    };
                    const double stiff =
                        block(law_.lambda, law_.mu) + e.volume * std::abs(ga.dot(stress * gb));
                    const double damp = block(law_.beta * law_.lambda + e.bulk, law_.beta * law_.mu);
                    add_to_row(sums, e.node[a], e.node[b], stiff, damp);
                    if (a != b) add_to_row(sums, e.node[b], e.node[a], stiff, damp);
                }
        }
    }

    double energy(const State& state) const override {
        double sum = 0.0;
        for (const Element& e : elements_) {
            const Matrix3 strain = green_strain(deformation(state, e));
            sum += 0.5 * e.volume * solid_stress(law_, strain).cwiseProduct(strain).sum();
        }
        return sum;
    }

    /// A tetrahedron that is turned inside out is strained beyond any limit.
    StrainExtremum extreme(const State& state) const override {
        StrainExtremum most;
        for (std::size_t i = 0; i < elements_.size(); ++i) {
            const Matrix3 f = deformation(state, elements_[i]);
            Eigen::SelfAdjointEigenSolver<Matrix3> principal;
            principal.computeDirect(green_strain(f), Eigen::EigenvaluesOnly);
            const double strain =
                f.determinant() > 0.0 ? principal.eigenvalues()[2] : std::numeric_limits<double>::infinity();
            if (strain > most.strain) most = {strain, i};
        }
        return most;
    }

private:
    static void add_to_row(GershgorinSums& sums, NodeIndex row, NodeIndex column, double stiffness,
                           double damping) {
        const double weight = sums.over(column, row);
        sums.stiffness[row] += stiffness * weight;
        sums.damping[row] += damping * weight;
    }
    /// dx/dX
    static Matrix3 deformation(const State& state, const Element& e) {
        Corners x;
        for (Eigen::Index c = 0; c < 4; ++c)
            x.col(c) = to_vec3(state.node[e.node[c]].x - state.node[e.node[0]].x);
        return x * e.gradient.transpose();
    }
    static Matrix3 green_strain(const Matrix3& f) { return 0.5 * (f.transpose() * f - Matrix3::Identity()); }
    /// [1/s] of the Green strain; none where the body turns.
    static Matrix3 strain_rate(const State& state, const Element& e, const Matrix3& f) {
        Corners v;
        for (Eigen::Index c = 0; c < 4; ++c)
            v.col(c) = to_vec3(state.node[e.node[c]].v - state.node[e.node[0]].v);
        const Matrix3 half = f.transpose() * (v * e.gradient.transpose());
        return 0.5 * (half + half.transpose());
    }
    Matrix3 viscous_stress(const Element& e, const Matrix3& rate) const {
        return law_.beta * solid_stress(law_, rate) + e.bulk * rate.trace() * Matrix3::Identity();
    }

    SolidLaw law_;
    std::vector<Element> elements_;
};

}  // namespace

SolidLaw solid_law(const Elasticity& elasticity, double density, double bulk_viscosity, double beta) {
    const double nu = elasticity.poisson_ratio;
    SolidLaw law;
    law.mu = elasticity.youngs_modulus / (2.0 * (1.0 + nu));
    law.lambda = elasticity.youngs_modulus * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
    law.beta = beta;
    law.viscosity = bulk_viscosity * std::sqrt(density * (law.lambda + 2.0 * law.mu));
    return law;
}

SolidLaw solid_law(const Scene& scene, const BodyMesh& body) {
    return solid_law(*scene.payload.body->elasticity, scene.payload.mass / body.lumped.volume,
                     scene.full.bulk_viscosity, scene.full.beta);
}

Eigen::Matrix3d solid_stress(const SolidLaw& law, const Eigen::Matrix3d& strain) {
    return 2.0 * law.mu * strain + law.lambda * strain.trace() * Matrix3::Identity();
}

std::unique_ptr<const ForceModel> make_tetrahedra(const SolidMesh& solid, const SolidLaw& law,
                                                  NodeIndex first_node) {
    return std::make_unique<Tetrahedra>(solid, law, first_node);
}

}  // namespace twinchute::fullsim
