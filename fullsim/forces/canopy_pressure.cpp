// The air's force on the canopy: an average pressure that gives the prescribed drag along e_r and
// spreads the canopy across it (paper, Eqs 11 and 12).
#include "fullsim/forces/canopy_pressure.hpp"

#include <algorithm>

#include "fullsim/forces/gather.hpp"
#include "fullsim/forces/registry.hpp"
#include "fullsim/laws/pressure.hpp"

namespace twinchute::fullsim {
namespace {

/// D/S_p may not exceed this many dynamic pressures: stagnation and suction together reach about
/// 2 on an open canopy, and a shape that is still a tube has next to no projected area.
constexpr double largest_pressure_coefficient = 3.0;

[[gnu::always_inline]] inline auto pushed(const State& state, const CornerGroup& g, const Lanes3& e) {
    const Lanes3 x0 = gather_position(state.node, g.node[0]);
    const Lanes3 e1 = gather_position(state.node, g.node[1]) - x0;
    const Lanes3 e2 = gather_position(state.node, g.node[2]) - x0;
    return HWY_NAMESPACE::pushed_area(0.5 * cross(e1, e2), e, splat(1.0 / 3.0),
                                      splat(state.air.radial_pressure / 3.0));
}

class CanopyPressure final : public ForceModel {
public:
    CanopyPressure(const Mesh& mesh, double smallest_area)
        : mesh_(mesh), smallest_area_(smallest_area), fabric_area_(mesh.fabric_area()) {}

    Block block() const override { return Block::canopy_pressure; }
    std::size_t elements() const override { return mesh_.triangles.size(); }

    void add_forces(State& state) const override {
        sweep(state, groups_.get([this] { return corner_groups(mesh_); }));
    }

    TWINCHUTE_FOR_EACH_CPU void sweep(State& state, const std::vector<CornerGroup>& groups) const {
        AeroState& air = state.air;
        const Lanes3 e{splat(air.direction.x()), splat(air.direction.y()), splat(air.direction.z())};
        measure_area(state, groups, e);

        const Lanes flag = to_lanes(set_pressure(air, smallest_area_));

        const Lanes pressure = splat(air.pressure);
        const NodeForces::View on_node = state.aero.view();
        for (const CornerGroup& g : groups) {
            const CornerForces corner(pressure * pushed(state, g, e).on_corner);
            for (int k = 0; k < lane_count; ++k)
                for (int c = 0; c < 3; ++c)
                    on_node[g.node[c][k]].value += corner.row[k];
        }

        for (NodeIndex i = 0; i < mesh_.canopy_nodes; ++i)
            on_node[i].value += (mesh_.tributary_area[i] / fabric_area_) * flag;
    }

private:
    TWINCHUTE_FOR_EACH_CPU void measure_area(State& state, const std::vector<CornerGroup>& groups,
                                             const Lanes3& e) const {
        Lanes positive = splat(0.0), all = splat(0.0);
        for (const CornerGroup& g : groups) {
            const auto area = pushed(state, g, e);
            positive += area.projected;
            all += area.along;
        }
        state.air.projected_area = sum(positive);
        state.air.signed_area = sum(all);
    }

    const Mesh& mesh_;
    double smallest_area_, fabric_area_;  // [m^2]
    GroupsOnDemand<CornerGroup> groups_;
};

}  // namespace

Vec3 set_pressure(AeroState& air, double smallest_area) {
    const double drag = air.dynamic_pressure * air.drag_area;
    const double wanted = drag / std::max(air.projected_area, smallest_area);
    air.pressure = std::min(wanted, largest_pressure_coefficient * air.dynamic_pressure);
    air.pressure_capped = air.pressure < wanted;
    return (drag - air.pressure * air.projected_area) * air.direction;
}

std::unique_ptr<const ForceModel> make_canopy_pressure(const Mesh& mesh, double smallest_area) {
    return std::make_unique<CanopyPressure>(mesh, smallest_area);
}

}  // namespace twinchute::fullsim
