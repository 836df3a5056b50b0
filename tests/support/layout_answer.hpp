// Answers of a layout for a state, and how near two of them are.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "fullsim/storage/layout.hpp"

namespace twinchute::test {

using fullsim::BlockClock, fullsim::EnergyTotals, fullsim::ForceModels, fullsim::Layout,
    fullsim::EnergiesAndStrains, fullsim::NodeConstants, fullsim::CriticalSteps, fullsim::State,
    fullsim::to_vec3;

inline constexpr double step_of_answers = 1e-5;  // [s]

/// Answer of a layout for one state: sums, the state after a step, and the forces that follow from it.
struct Answer {
    State state;
    EnergiesAndStrains levels;  ///< before the step
    CriticalSteps stable;
    std::vector<Vec3> force;               ///< [N], gravity included
    double membrane_energy = 0.0;          ///< [J] where there are membranes
    State in_subcycles;                    ///< after a step in which lines took three
    std::vector<Vec3> force_in_subcycles;  ///< [N] mean, likewise
};

inline Answer answer_of(Layout& layout, const State& state, const NodeConstants& c,
                        const ForceModels& structure, const ForceModels& loads,
                        const fullsim::Body* body = nullptr) {
    Answer a{state, {}, {}, {}, 0.0, state, {}};
    BlockClock clock;
    clock.begin(std::vector<std::string>(structure.size() + loads.size(), "any"));
    const auto step = [&](State& s, int count) {
        s.largest = {};
        s.in_subcycles = {};
        layout.begin(s, structure, loads, body);
        if (count == 1) a.levels = layout.levels(s);
        clock.begin_step(false);
        layout.evaluate(s, clock);
        if (count == 1) a.stable = layout.critical_steps(s);
        if (std::ranges::find(structure, "membrane", &fullsim::ForceModel::name) != structure.end())
            a.membrane_energy = layout.membrane_energy(s);
        s.energy.weighs = true;
        layout.advance(s, step_of_answers, count, s.added_mass + 1e-4);
        layout.store(s);
        std::vector<Vec3> force;
        for (std::size_t i = 0; i < c.mass.size(); ++i)
            force.push_back((c.mass[i] + c.share[i] * state.added_mass) /
                            (0.5 * (step_of_answers + state.dt)) *
                            to_vec3(s.v_half[i].value - state.v_half[i].value));
        return force;
    };
    a.force = step(a.state, 1);
    a.force_in_subcycles = step(a.in_subcycles, 3);
    return a;
}

/// stiffest: EA [N] of the stiffest cable; rounding: of numbers near 1.
inline void expect_same(const Answer& reference, const Answer& other, double stiffest,
                        double rounding = 1e-12) {
    double largest = reference.state.riser_force.norm(), difference = 0.0, in_subcycles = 0.0;
    for (std::size_t i = 0; i + 1 < reference.force.size(); ++i) {  // the payload's tells its weight
        largest = std::max(largest, reference.force[i].norm());
        difference = std::max(difference, (reference.force[i] - other.force[i]).norm());
        in_subcycles =
            std::max(in_subcycles, (reference.force_in_subcycles[i] - other.force_in_subcycles[i]).norm());
    }
    // A strain is a ratio near 1 less 1, good to 2e-16: in free fall, when hardly a force acts, that is what
    // is left of it times the stiffest cable's EA, in each of ten elements on a node.
    const double of_strains = 2e-3 * stiffest;
    EXPECT_LE(difference, rounding * (largest + of_strains));
    // A first subcycle leaves places good to 1e-14 m, on elements of a few centimetres.
    EXPECT_LE(in_subcycles, rounding * (largest + 0.4 * stiffest));
    const auto close = [&](double a, double b, double scale, const char* what) {
        EXPECT_NEAR(a, b, rounding * scale) << what;
    };
    const State &r = reference.state, &o = other.state;
    const double power = std::abs(r.energy.drag_power) + std::abs(r.energy.damping_power) +
                         std::abs(r.energy.gravity_power) + 1e-3;
    close(reference.stable.all, other.stable.all, reference.stable.all, "critical time step");
    close(reference.stable.canopy, other.stable.canopy, reference.stable.canopy, "of the canopy");
    close(reference.stable.lines, other.stable.lines, reference.stable.lines, "of lines");
    const EnergyTotals &rb = reference.in_subcycles.energy, &ob = other.in_subcycles.energy;
    const double booked = std::abs(rb.damping) + 0.01 * step_of_answers * (largest + of_strains);
    close(rb.damping, ob.damping, 1e2 * booked, "damping in subcycles");
    close(rb.gravity_work, ob.gravity_work, 10.0 * std::abs(rb.gravity_work), "gravity work in subcycles");
    close(rb.drag_work, ob.drag_work, 10.0 * std::abs(rb.drag_work) + booked, "drag work in subcycles");
    EXPECT_LT((reference.in_subcycles.sums.system_velocity - other.in_subcycles.sums.system_velocity).norm(),
              rounding * 100.0);
    EXPECT_LT((reference.in_subcycles.sums.system_position - other.in_subcycles.sums.system_position).norm(),
              rounding * 1000.0);
    close(r.energy.drag_power, o.energy.drag_power, 10.0 * power, "drag power");
    close(r.energy.gravity_power, o.energy.gravity_power, power, "gravity power");
    // A small sum of large terms of both signs.
    close(r.energy.damping_power, o.energy.damping_power, 100.0 * power, "damping power");
    close(r.energy.external_power, o.energy.external_power, power, "external power");
    close(r.energy.added_mass, o.energy.added_mass, std::abs(r.energy.added_mass) + 1e-3, "added-mass work");
    close(r.air.projected_area, o.air.projected_area, 60.0, "projected area");
    close(r.air.signed_area, o.air.signed_area, 60.0, "signed area");
    close(r.air.pressure, o.air.pressure, 10.0 * (r.air.pressure + 1e-3), "pressure");
    close(r.riser_force.norm(), o.riser_force.norm(), 10.0 * (r.riser_force.norm() + 1.0) + of_strains,
          "riser force");
    close(r.energy.kinetic, o.energy.kinetic, r.energy.kinetic + 1e2 * power * step_of_answers,
          "kinetic energy of the rule");
    close(rb.kinetic, ob.kinetic, rb.kinetic + 1e2 * (power * step_of_answers + booked),
          "the same with subcycles");
    const EnergiesAndStrains &rl = reference.levels, &ol = other.levels;
    close(rl.kinetic, ol.kinetic, rl.kinetic, "kinetic energy");
    // Strains are good to 2e-16; their squares, times the stiffest cable's EA and some metres of it, too.
    close(rl.elastic, ol.elastic, 10.0 * rl.elastic + 1e-3 * stiffest, "elastic energy");
    close(reference.membrane_energy, other.membrane_energy,
          10.0 * reference.membrane_energy + 1e-3 * stiffest, "membrane energy");
    ASSERT_EQ(rl.strain.size(), ol.strain.size());
    for (std::size_t i = 0; i < rl.strain.size(); ++i)
        // Kernels have 1e-18 m^2 more under the root of a length, which folded is as little as 0.3 mm.
        close(rl.strain[i], ol.strain[i], rl.strain[i] < 0.0 ? 1.0 : 1e-2, "largest strain");
    // Made of strains as forces are, see above.
    close(r.largest.line_tension, o.largest.line_tension, r.largest.line_tension + 4e-4 * stiffest,
          "largest tension");
    close(r.largest.fabric_stress, o.largest.fabric_stress, r.largest.fabric_stress + 4e-4 * stiffest,
          "largest stress");
    close(reference.in_subcycles.largest.line_tension, other.in_subcycles.largest.line_tension,
          reference.in_subcycles.largest.line_tension + 0.4 * stiffest, "largest tension in subcycles");
    const auto &rp = reference.in_subcycles.in_subcycles, &op = other.in_subcycles.in_subcycles;
    EXPECT_EQ(rp.count, 2);
    EXPECT_EQ(op.count, 2);
    EXPECT_LT((rp.sum - op.sum).norm(), rounding * (largest + 4.0 * stiffest)) << "risers in subcycles";
    EXPECT_LT((r.sums.canopy_velocity - o.sums.canopy_velocity).norm(), rounding * 100.0);
    EXPECT_LT((r.sums.system_position - o.sums.system_position).norm(), rounding * 1000.0);
    EXPECT_LT((r.sums.canopy_area_velocity - o.sums.canopy_area_velocity).norm(), rounding * 100.0);
}

/// Nodes from `first` on, and how they have turned on the whole.
inline void expect_same_body(const State& reference, const State& other, std::size_t first,
                             double rounding = 1e-12) {
    const fullsim::BodyState &r = *reference.body, &o = *other.body;
    EXPECT_LT((r.momentum - o.momentum).norm(), rounding * 1e3) << "angular momentum";
    EXPECT_LT((r.half_momentum - o.half_momentum).norm(), rounding * 1e3) << "in the middle of a step";
    for (int k = 0; k < 4; ++k)
        EXPECT_NEAR(r.attitude[k], o.attitude[k], rounding);
    ASSERT_EQ(reference.node.size(), other.node.size());
    for (std::size_t i = first; i < reference.node.size(); ++i) {
        EXPECT_LT((to_vec3(reference.node[i].x) - to_vec3(other.node[i].x)).norm(), rounding * 1e3) << i;
        EXPECT_LT((to_vec3(reference.node[i].v) - to_vec3(other.node[i].v)).norm(), rounding * 1e3) << i;
    }
}

/// EA [N] of a riser, which is as strong as its lines.
inline double stiffest_cable(const Scene& scene) {
    const Parachute& chute = scene.parachutes.front();
    return chute.line.axial_stiffness() * chute.gores / chute.risers;
}

}  // namespace twinchute::test
