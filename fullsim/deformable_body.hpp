// A payload that gives way: the nodes of its tetrahedra, each with its own mass.
#pragma once

#include <vector>

#include "fullsim/body.hpp"
#include "fullsim/forces/tetrahedra.hpp"

namespace twinchute::fullsim {

class DeformableBody final : public Body {
public:
    /// masses: [kg] of its nodes, which share that of the payload's node (node_masses).
    DeformableBody(std::vector<double> masses, const BodyMesh& body, const SolidLaw& law, double gravity);

    void start(State& state, const Vec3& axis) const override;
    /// The forces stay on the attachments, with their share of the air's on the payload's node, for
    /// `advance`.
    void gather(State& state, NodeIndex payload, NodeIndex first_attachment) const override;
    /// The central difference scheme, as for all other nodes: what its nodes do together is what the
    /// payload's node does, but for rounding. state.body says how they have turned on the whole: the rotation
    /// in sum m x X^T.
    void advance(State& state, NodeIndex payload, NodeIndex first_attachment, double kick,
                 double dt) const override;
    /// [J] of the nodes, about their centre of mass.
    double inner_energy(const State& state, NodeIndex payload, NodeIndex first_attachment) const override;
    /// From row sums of tetrahedra and risers, with weights as PerronScaling has them, of the unstrained
    /// body.
    double critical_step(const State& state, const ForceModels& structure, NodeIndex first_attachment,
                         double riser) const override;

private:
    void turn(State& state, NodeIndex payload, NodeIndex first_attachment) const;
    void weigh_rows(const BodyMesh& body, const SolidLaw& law);

    std::vector<double> node_mass_;  // [kg]
    double mass_;                    // [kg] of all
    std::vector<Vec3> rest_;         // [m] from the centre of mass
    std::vector<int> end_;           // nodes that risers end at
    Eigen::Matrix3d principal_;
    double gravity_;              // [m/s^2]
    std::vector<double> weight_;  // of rows and columns, by node
};

}  // namespace twinchute::fullsim
