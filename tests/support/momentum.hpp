// Momentum of a run, for tests of its conservation.
#pragma once

#include <Eigen/Geometry>

#include "fullsim/simulation.hpp"

namespace twinchute::test {

/// Linear and angular momentum of mesh nodes, at the half step before state().time: x^{n} x v^{n-1/2} and
/// x^{n-1} x v^{n-1/2} are the same, since x moves along v.
struct Momentum {
    Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
    double size = 0.0, turning = 0.0;  // sums of magnitudes
};

inline Momentum momentum_of(const fullsim::Simulation& simulation) {
    using fullsim::to_vec3;
    Momentum sum;
    const fullsim::State& s = simulation.synchronised_state();
    const Vec3 centre = to_vec3(s.node[simulation.mesh().payload()].x);
    for (int i = 0; i < simulation.mesh().node_count(); ++i) {
        const Vec3 p = simulation.mesh().mass[i] * to_vec3(s.v_half[i].value);
        const Vec3 l = to_vec3(s.node[i].x).cross(p);
        sum.linear += p;
        sum.angular += l;
        sum.size += p.norm();
        sum.turning += (to_vec3(s.node[i].x) - centre).cross(p).norm();
    }
    return sum;
}

}  // namespace twinchute::test
