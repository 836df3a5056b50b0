// A small driver around the structural blocks, for tests with answers of their own: meshes by hand,
// held nodes, follower pressure, dynamic relaxation, and plain time steps. The blocks and the node
// update are those of every full run; only what holds and loads the structure is of the tests.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "fullsim/forces/registry.hpp"
#include "fullsim/time/central_difference.hpp"
#include "tests/support/small_parachute.hpp"

namespace twinchute::test {

/// Prints a result into the test's output: docs/verification.md quotes it.
inline void report(const char* what, auto... values) {
    std::string line = what;
    ((line += fmt::format("  {:.6g}", static_cast<double>(values))), ...);
    fmt::print("{}\n", line);
}

/// Adds a triangle that is unstrained where its corners are given [m].
inline void add_triangle(fullsim::Mesh& mesh, std::array<fullsim::NodeIndex, 3> node,
                         const std::array<Vec3, 3>& unstrained) {
    const Vec3 e1 = unstrained[1] - unstrained[0], e2 = unstrained[2] - unstrained[0];
    const double a = e1.norm();
    mesh.triangles.push_back({node, 0, a, e1.dot(e2) / a, e1.cross(e2).norm() / a});
}

/// Adds a triangle that is unstrained in the mesh's own positions.
inline void add_triangle(fullsim::Mesh& mesh, std::array<fullsim::NodeIndex, 3> node) {
    add_triangle(mesh, node, {mesh.position[node[0]], mesh.position[node[1]], mesh.position[node[2]]});
}

/// A cord by what matters: axial stiffness EA [N] and mass per length [kg/m]. Its section is 1 m^2, so
/// that modulus and density are the two numbers themselves.
inline Cord cord_of(double axial_stiffness, double linear_density) {
    return {"cord", linear_density, axial_stiffness, 2.0 / std::sqrt(pi)};
}

/// Pressure [Pa] normal to every triangle where it is now: p A to its corners, a third each.
class FollowerPressure final : public fullsim::ForceModel {
public:
    FollowerPressure(const fullsim::Mesh& mesh, double pressure)
        : triangles_(mesh.triangles), pressure_(pressure) {}

    fullsim::Block block() const override { return fullsim::Block::canopy_pressure; }

    void add_forces(fullsim::State& state) const override {
        for (const fullsim::Triangle& t : triangles_) {
            const Vec3 x0 = fullsim::to_vec3(state.node[t.node[0]].x);
            const Vec3 e1 = fullsim::to_vec3(state.node[t.node[1]].x) - x0;
            const Vec3 e2 = fullsim::to_vec3(state.node[t.node[2]].x) - x0;
            const Lanes third = fullsim::to_lanes(pressure_ / 6.0 * e1.cross(e2));
            for (const auto i : t.node)
                state.aero[i].value += third;
        }
    }

private:
    const std::vector<fullsim::Triangle>& triangles_;
    double pressure_;
};

class Structure {
public:
    /// Masses are lumped unless the mesh brings its own.
    explicit Structure(fullsim::Mesh mesh, double bulk_viscosity = 0.0, double gravity = 0.0)
        : mesh_(std::move(mesh)) {
        if (mesh_.mass.empty()) fullsim::lump_masses(mesh_, 0.0);
        mesh_.tributary_area.resize(mesh_.position.size(), 0.0);
        constants_.mass = mesh_.mass;
        constants_.share.assign(mesh_.mass.size(), 0.0);
        constants_.canopy_nodes = mesh_.canopy_nodes;
        constants_.canopy_mass = constants_.system_mass = 1.0;  // only sums that nothing here reads
        constants_.gravity = gravity;
        if (!mesh_.triangles.empty()) blocks.push_back(fullsim::make_membrane(mesh_, bulk_viscosity));
        if (!mesh_.cables.empty()) blocks.push_back(fullsim::make_cable(mesh_, bulk_viscosity));
        state.node.assign(mesh_.position.size() + 1, {splat(0.0), splat(0.0)});
        state.v_half.assign(state.node.size(), {splat(0.0)});
        clear_forces(state);
        for (std::size_t i = 0; i < mesh_.position.size(); ++i)
            state.node[i].x = fullsim::to_lanes(mesh_.position[i]);
        free_.assign(state.node.size(), {splat(1.0)});
        reaction_.assign(state.node.size(), {splat(0.0)});
    }
    Structure(const Structure&) = delete;  // blocks refer to the mesh
    Structure& operator=(const Structure&) = delete;

    fullsim::State state;
    fullsim::ForceModels blocks;  ///< structure first; tests add loads

    const fullsim::Mesh& mesh() const { return mesh_; }
    const fullsim::NodeConstants& constants() const { return constants_; }
    void add_pressure(double pressure) {
        blocks.push_back(std::make_unique<FollowerPressure>(mesh_, pressure));
    }

    /// Components that do not accelerate; whatever velocity they have, they keep.
    void hold(fullsim::NodeIndex i, bool x = true, bool y = true, bool z = true) {
        free_[i].value *= Lanes{x ? 0.0 : 1.0, y ? 0.0 : 1.0, z ? 0.0 : 1.0, 0.0};
    }
    void release(fullsim::NodeIndex i) { free_[i].value = splat(1.0); }
    void set_velocity(fullsim::NodeIndex i, const Vec3& v) {
        state.node[i].v = state.v_half[i].value = fullsim::to_lanes(v);
    }

    Vec3 position(fullsim::NodeIndex i) const { return fullsim::to_vec3(state.node[i].x); }
    Vec3 velocity(fullsim::NodeIndex i) const { return fullsim::to_vec3(state.node[i].v); }
    /// [N] that holds a node in the last step, its own weight included.
    Vec3 reaction(fullsim::NodeIndex i) const { return fullsim::to_vec3(reaction_[i].value); }

    void evaluate() {
        clear_forces(state);
        for (const auto& block : blocks)
            block->add_forces(state);
    }

    /// One step of the central difference scheme from the forces at state.time.
    void step(double dt) {
        evaluate();
        hold_nodes(constants_);
        fullsim::advance(state, constants_, dt, 0.0);
        state.time += dt;
    }

    struct Relaxed {
        int steps = 0;
        double residual = 0.0;  ///< [N] largest force on a free node
    };

    /// To static equilibrium under the weight of the real masses and all loads, by the same node
    /// update with masses that make every node equally slow (m_i ~ K_i, time step 1) and the
    /// velocities set to zero whenever the kinetic energy has passed a maximum.
    Relaxed relax(double tolerance, int max_steps) {
        fullsim::NodeConstants slow = constants_;
        slow.gravity = 0.0;
        stop();
        double kinetic = 0.0, residual = 0.0;
        std::vector<fullsim::NodeVector> before;  // velocities half a step before the last
        for (int n = 0; n < max_steps; ++n) {
            if (n % 200 == 0) weigh_by_stiffness(slow);
            evaluate();
            for (std::size_t i = 0; i < mesh_.mass.size(); ++i)
                state.force[i].value[2] -= mesh_.mass[i] * constants_.gravity;
            residual = hold_nodes(slow);
            if (residual < tolerance || !std::isfinite(residual)) return {n, residual};
            before = state.v_half;
            fullsim::advance(state, slow, 1.0, 0.0);
            double now = 0.0;
            for (std::size_t i = 0; i < mesh_.mass.size(); ++i)
                now += slow.mass[i] * sum3(state.v_half[i].value * state.v_half[i].value);
            if (now < kinetic) {
                // Back to where the maximum was, half a step before the last one began.
                for (std::size_t i = 0; i < mesh_.mass.size(); ++i)
                    state.node[i].x -= state.v_half[i].value + 0.5 * before[i].value;
                stop();
            }
            kinetic = now < kinetic ? 0.0 : now;
        }
        return {max_steps, residual};
    }

    void stop() {
        for (std::size_t i = 0; i < state.node.size(); ++i)
            state.node[i].v = state.v_half[i].value = splat(0.0);
        state.dt = 0.0;
    }

    fullsim::GershgorinSums row_sums() const {
        fullsim::GershgorinSums sums;
        sums.stiffness.assign(mesh_.mass.size(), 0.0);
        sums.damping = sums.stiffness;
        for (const auto& block : blocks)
            block->add_row_sums(state, sums);
        return sums;
    }

private:
    /// Books reactions and takes the acceleration from what is held; the largest force elsewhere.
    double hold_nodes(const fullsim::NodeConstants& c) {
        double largest = 0.0;
        for (std::size_t i = 0; i < mesh_.mass.size(); ++i) {
            const Lanes weight{0.0, 0.0, -c.mass[i] * c.gravity, 0.0}, held = splat(1.0) - free_[i].value;
            const Lanes all = state.force[i].value + state.aero[i].value + weight;
            reaction_[i].value = -held * all;
            const Lanes loose = free_[i].value * all;
            largest = std::max(largest, std::sqrt(sum3(loose * loose)));
            state.force[i].value = free_[i].value * state.force[i].value - held * weight;
            state.aero[i].value *= free_[i].value;
        }
        return largest;
    }

    void weigh_by_stiffness(fullsim::NodeConstants& slow) const {
        const fullsim::GershgorinSums sums = row_sums();
        for (std::size_t i = 0; i < slow.mass.size(); ++i)
            slow.mass[i] = 0.3 * sums.stiffness[i] + 1e-300;  // 0.25 is the limit of stability
    }

    fullsim::Mesh mesh_;
    fullsim::NodeConstants constants_;
    std::vector<fullsim::NodeVector> free_, reaction_;
};

}  // namespace twinchute::test
