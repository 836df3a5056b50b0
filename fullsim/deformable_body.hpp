// A payload that gives way: the nodes of its tetrahedra, each with its own mass.
#pragma once

#include <vector>

#include "fullsim/body.hpp"
#include "fullsim/forces/tetrahedra.hpp"

namespace twinchute::fullsim {

class DeformableBody final : public Body {
public:
    /// masses: [kg] of its nodes, which share that of the payload's node (node_masses).
    DeformableBody(BodyNodes nodes, std::vector<double> masses, const BodyMesh& body, const SolidLaw& law,
                   double gravity);

    void start(State& state, const Eigen::Matrix3d& frame) const override;
    void pull(State& state) const override;
    /// The central difference scheme, as for all other nodes. Tetrahedra and gravity act on them as one
    /// impulse, risers in the subcycles; what else acts on the payload's node, air and damping, moves them
    /// all alike: together they do what that node does. state.body says how they have turned on the whole:
    /// the rotation in sum m x X^T.
    void impulse(State& state, double kick) const override;
    void move(State& state, double kick, double dt) const override;
    void finish(State& state, double dt) const override;
    /// [J] of the nodes, about their centre of mass.
    double inner_energy(const State& state) const override;
    /// From row sums of tetrahedra and risers, with weights as PerronScaling has them, of the unstrained
    /// body. Of the whole step with all of them: so its nodes never are half a period of a riser apart from
    /// their last impulse, and cannot ring.
    CriticalSteps critical_steps(const State& state, const ForceModels& structure,
                                 double riser) const override {
        const double step = critical_step(state, structure, riser);
        return {step, step, infinity};
    }
    double critical_step(const State& state, const ForceModels& structure, double riser) const;

private:
    void turn(State& state) const;
    void weigh_rows(const BodyMesh& body, const SolidLaw& law);

    std::vector<double> node_mass_;  // [kg]
    double mass_;                    // [kg] of all
    std::vector<Vec3> rest_;         // [m] from the centre of mass
    std::vector<int> end_;           // nodes that risers end at, one for each riser,
    std::vector<int> pulled_;        // and each node once
    Eigen::Matrix3d principal_;
    double gravity_;              // [m/s^2]
    std::vector<double> weight_;  // of rows and columns, by node
};

}  // namespace twinchute::fullsim
