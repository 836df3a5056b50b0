// Drag of the suspension lines as cylinders across the wind (paper, Eq. 10).
#include <algorithm>
#include <cmath>

#include "fullsim/elements/cable.hpp"
#include "fullsim/forces/lanes_view.hpp"
#include "fullsim/forces/registry.hpp"
#include "lib/models/cylinder_drag.hpp"

namespace twinchute::fullsim {
namespace {

struct LineGroup {
    std::array<LaneNodes, 2> node;
};

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

    TWINCHUTE_FOR_EACH_CPU void sweep(State& state, const std::vector<LineGroup>& groups) const {
        static const CylinderDragTable drag_coefficient;
        if (!(state.air.density > 0.0)) return;  // no Reynolds number without air
        const AeroState& air = state.air;
        HWY_NAMESPACE::cable_forces_in<false>(
            LanesView<SpanLanes<LineGroup>>(state.node, state.aero.view(), groups),
            {&drag_coefficient,
             diameter_,
             air.density,
             air.viscosity,
             {air.wind.x(), air.wind.y(), air.wind.z()}});
    }

private:
    std::vector<LineGroup> make_groups() const {
        std::vector<const Cable*> lines;
        for (const Cable& c : mesh_.cables)
            if (c.kind == CableKind::line) lines.push_back(&c);
        std::vector<LineGroup> groups;
        for (std::size_t first = 0; first < lines.size(); first += lane_count) {
            LineGroup g{};
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
    GroupsOnDemand<LineGroup> groups_;
};

}  // namespace

std::unique_ptr<const ForceModel> make_line_drag(const Mesh& mesh) {
    return std::make_unique<LineDragBlock>(mesh);
}

}  // namespace twinchute::fullsim
