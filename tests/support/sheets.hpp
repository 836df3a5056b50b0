// Sheets of fabric that meet, for tests of their contact.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "fullsim/forces/blocks.hpp"
#include "fullsim/simulation.hpp"
#include "fullsim/time/energy.hpp"
#include "tests/support/small_parachute.hpp"

namespace twinchute::fullsim {

/// Square sheets of one fabric, one after the other, and a payload far away that belongs to none.
class Sheets {
public:
    explicit Sheets(double friction, double modulus = 4e7) : friction_(friction) {
        mesh.fabric.density = 500.0;
        mesh.fabric.youngs_modulus = modulus;
        mesh.fabric.poisson_ratio = 0.14;
        mesh.fabric.thickness = 1e-4;
        for (Cord& cord : mesh.cords)
            cord = {};
    }
    /// across x along squares of `cell` [m], from `corner`, in the directions u and v.
    void add(int across, int along, double cell, const Vec3& corner, const Vec3& u, const Vec3& v) {
        const auto first = static_cast<NodeIndex>(mesh.position.size());
        for (int j = 0; j <= along; ++j)
            for (int i = 0; i <= across; ++i)
                mesh.position.push_back(corner + cell * i * u + cell * j * v);
        const auto node = [&](int i, int j) { return first + j * (across + 1) + i; };
        const auto triangle = [&](NodeIndex a, NodeIndex b, NodeIndex c) {
            mesh.triangles.push_back(
                laid_flat({a, b, c}, {mesh.position[a], mesh.position[b], mesh.position[c]}));
        };
        for (int j = 0; j < along; ++j)
            for (int i = 0; i < across; ++i) {
                triangle(node(i, j), node(i + 1, j), node(i + 1, j + 1));
                triangle(node(i, j), node(i + 1, j + 1), node(i, j + 1));
            }
        firsts.push_back(first);
    }
    /// others: nodes that belong to no sheet.
    void finish(std::span<const Vec3> others = {}) {
        mesh.canopy_nodes = static_cast<int>(mesh.position.size());
        mesh.position.insert(mesh.position.end(), others.begin(), others.end());
        mesh.position.emplace_back(0.0, 0.0, -50.0);
        firsts.push_back(mesh.canopy_nodes);
        mesh.tributary_area.assign(mesh.canopy_nodes, 0.0);
        for (const Triangle& t : mesh.triangles)
            for (const NodeIndex i : t.node)
                mesh.tributary_area[i] += t.area() / 3.0;
        lump_masses(mesh, 1.0);
        state = test::state_of(mesh);
        state.added_mass = 0.0;
        constants = node_constants(mesh, 0.0);
        update_sums(state, constants);
        structure.push_back(make_membrane(mesh, 0.0));
        structure.push_back(make_self_contact(mesh, friction_));
        state.energy.kinetic_start = kinetic_energy(state, constants);
    }
    void launch(std::size_t sheet, const std::function<Vec3(const Vec3&)>& velocity) {
        for (NodeIndex i = firsts[sheet]; i < firsts[sheet + 1]; ++i) {
            state.node[i].v = to_lanes(velocity(mesh.position[i]));
            state.v_half[i].value = state.node[i].v;
        }
        update_sums(state, constants);
        state.energy.kinetic_start = kinetic_energy(state, constants);
    }
    /// Makes a sheet as heavy as a table.
    void hold(std::size_t sheet) {
        constexpr double heavy = 1e6;  // [kg] a node
        for (NodeIndex i = firsts[sheet]; i < firsts[sheet + 1]; ++i) {
            constants.canopy_mass += heavy - constants.mass[i];
            constants.system_mass += heavy - constants.mass[i];
            constants.mass[i] = heavy;
        }
        update_sums(state, constants);
    }
    /// Steps of half the bound, which is renewed as in a run, up to `time`.
    void run(double time, const std::function<void(State&)>& others = {}) {
        while (state.time < time) {
            if (state.step % 20 == 0) dt_ = 0.5 * critical();
            step(dt_, others);
        }
    }
    /// One step with other forces beside those of the blocks.
    void step(double dt, const std::function<void(State&)>& others = {}) {
        for (const auto& block : structure)
            block->add_forces(state);
        if (others) others(state);
        advance(state, constants, dt, 0.0);
        state.time += dt;
    }
    double mass(std::size_t sheet) const {
        double sum = 0.0;
        for (NodeIndex i = firsts[sheet]; i < firsts[sheet + 1]; ++i)
            sum += mesh.mass[i];
        return sum;
    }
    Vec3 mean(std::size_t sheet, bool velocity = false) const {
        Vec3 sum = Vec3::Zero();
        for (NodeIndex i = firsts[sheet]; i < firsts[sheet + 1]; ++i)
            sum += mesh.mass[i] * to_vec3(velocity ? state.v_half[i].value : state.node[i].x);
        return sum / mass(sheet);
    }
    Vec3 momentum() const {
        Vec3 sum = Vec3::Zero();
        for (NodeIndex i = 0; i < mesh.node_count(); ++i)
            sum += mesh.mass[i] * to_vec3(state.v_half[i].value);
        return sum;
    }
    /// As the scheme conserves it: with velocities of half steps.
    Vec3 angular_momentum() const {
        Vec3 sum = Vec3::Zero();
        for (NodeIndex i = 0; i < mesh.node_count(); ++i)
            sum += mesh.mass[i] * to_vec3(state.node[i].x).cross(to_vec3(state.v_half[i].value));
        return sum;
    }
    /// Puts a node there, at that velocity.
    void put(NodeIndex i, const Vec3& x, const Vec3& v) {
        state.node[i] = {to_lanes(x), to_lanes(v)};
        state.v_half[i].value = state.node[i].v;
    }
    /// Contact after each of `steps` in which all nodes go on evenly at the velocity [m/s] of a node and of
    /// the place where it began.
    void glide(int steps, double dt, const std::function<Vec3(NodeIndex, const Vec3&)>& velocity,
               const std::function<void()>& each = {}) {
        for (int k = 1; k <= steps; ++k) {
            for (NodeIndex i = 0; i < mesh.payload(); ++i) {
                const Vec3 v = velocity(i, mesh.position[i]);
                put(i, mesh.position[i] + k * dt * v, v);
            }
            see_to_contact(dt);
            if (each) each();
        }
    }
    /// Contact of nodes that were put somewhere `dt` [s] later.
    void see_to_contact(double dt) {
        state.time += dt;
        update_sums(state, constants);
        structure.back()->add_forces(state);
    }
    double critical() const { return fullsim::critical_step(state, constants, structure, {}, {}).dt; }

    Mesh mesh;
    std::vector<NodeIndex> firsts;
    State state;
    NodeConstants constants;
    ForceModels structure;

private:
    double friction_, dt_ = 0.0;
};

}  // namespace twinchute::fullsim
