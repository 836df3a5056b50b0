// Drag of the suspension lines as cylinders across the wind (paper, Eq. 10).
#include <algorithm>
#include <cmath>

#include "fullsim/forces/gather.hpp"
#include "fullsim/forces/registry.hpp"
#include "lib/models/cylinder_drag.hpp"

namespace twinchute::fullsim {
namespace {

struct Group {
    std::array<LaneNodes, 2> node;
};

/// 1/2 rho d l C_d(Re) |V_t| V_t on each line element, half to each end; V_t is the air's
/// velocity relative to the element's mean, across its axis, and l its current length.
class LineDragBlock final : public ForceModel {
public:
    explicit LineDragBlock(const Mesh& mesh)
        : mesh_(mesh),
          diameter_(mesh.cord(CableKind::line).diameter),
          elements_(
              static_cast<std::size_t>(std::ranges::count(mesh.cables, CableKind::line, &Cable::kind))) {}

    std::string_view name() const override { return "line drag"; }
    std::size_t elements() const override { return elements_; }

    void add_forces(State& state) const override {
        sweep(state, groups_.get([this] { return make_groups(); }));
    }

    TWINCHUTE_FOR_EACH_CPU void sweep(State& state, const std::vector<Group>& groups) const {
        static const CylinderDragTable drag_coefficient;
        const double reynolds_per_speed = state.air.density * diameter_ / state.air.viscosity;
        // Half of 1/2 rho d to each end.
        const double factor = 0.25 * state.air.density * diameter_;
        const Vec3& w = state.air.wind;
        const Lanes3 wind{splat(w.x()), splat(w.y()), splat(w.z())};
        const NodeForces::View on_node = state.aero.view();
        for (const Group& g : groups) {
            const Lanes3 d = gather_position(state.node, g.node[1]) - gather_position(state.node, g.node[0]);
            const Lanes3 v = wind - splat(0.5) * (gather_velocity(state.node, g.node[0]) +
                                                  gather_velocity(state.node, g.node[1]));
            const Lanes square = dot(d, d) + 1e-18;
            const Lanes3 across = v - dot(v, d) / square * d;
            const Lanes speed = square_root(dot(across, across));
            const Lanes length = square_root(square);
            Lanes coefficient;
            for (int k = 0; k < lane_count; ++k)
                coefficient[k] = drag_coefficient(reynolds_per_speed * speed[k]);
            const CornerForces half(factor * length * coefficient * speed * across);
            for (int k = 0; k < lane_count; ++k) {
                on_node[g.node[0][k]].value += half.row[k];
                on_node[g.node[1][k]].value += half.row[k];
            }
        }
    }

private:
    std::vector<Group> make_groups() const {
        std::vector<const Cable*> lines;
        for (const Cable& c : mesh_.cables)
            if (c.kind == CableKind::line) lines.push_back(&c);
        std::vector<Group> groups;
        for (std::size_t first = 0; first < lines.size(); first += lane_count) {
            Group g{};
            for (int k = 0; k < lane_count; ++k)
                for (int end = 0; end < 2; ++end)
                    g.node[end][k] = first + k < lines.size() ? lines[first + k]->node[end] : mesh_.dummy();
            groups.push_back(g);
        }
        return groups;
    }

    const Mesh& mesh_;
    double diameter_;  // [m]
    std::size_t elements_;
    GroupsOnDemand<Group> groups_;
};

}  // namespace

std::unique_ptr<const ForceModel> make_line_drag(const Mesh& mesh) {
    return std::make_unique<LineDragBlock>(mesh);
}

}  // namespace twinchute::fullsim
