#include "fullsim/forces/inflow.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "lib/solve/opening.hpp"

namespace twinchute::fullsim {
namespace {

/// Nodes along the edge of the fabric that runs through a node, in the direction of its triangles.
std::vector<NodeIndex> fabric_edge_through(const Mesh& mesh, NodeIndex first) {
    std::map<std::pair<NodeIndex, NodeIndex>, bool> has_two;  // from node to node
    for (const Triangle& t : mesh.triangles)
        for (int c = 0; c < 3; ++c) {
            const NodeIndex a = t.node[c], b = t.node[(c + 1) % 3];
            if (const auto back = has_two.find({b, a}); back != has_two.end())
                back->second = true;
            else
                has_two[{a, b}] = false;
        }
    std::map<NodeIndex, NodeIndex> next;
    for (const auto& [edge, two] : has_two)
        if (!two) next.insert(edge);
    std::vector<NodeIndex> ring{first};
    for (NodeIndex i = next.at(first); i != first; i = next.at(i))
        ring.push_back(i);
    return ring;
}

/// Share of the full canopy's area above which one that has been full has its steady drag area. Shapes settle
/// at 0.85 and more where the scene's D_p/D0 is not the mesh's own, or a dent stays.
constexpr double smallest_settled = 0.7;

/// Area that faces the air with its outside more than with its inside, over that which does with its inside,
/// up to which fabric is folded: the crane drop of data/ has 0.2 as its lines come taut. A canopy that lies
/// across the air has 0, one that is open and has turned over no fabric that faces it with its inside.
constexpr double folded = 0.5;

/// Speed of the air that is pressed out of the mouth, over the airspeed, at which the search for it ends.
constexpr double largest_outflow = 64.0;

Vec3 area_of(const Triangle& t, const State& state) {
    const Vec3 first = to_vec3(state.node[t.node[0]].x);
    return 0.5 * (to_vec3(state.node[t.node[1]].x) - first).cross(to_vec3(state.node[t.node[2]].x) - first);
}

class InflowPressure final : public ForceModel {
public:
    InflowPressure(const Mesh& mesh, InflowBalance balance)
        : mesh_(mesh), balance_(std::move(balance)), fabric_area_(mesh.fabric_area()) {}

    Block block() const override { return Block::canopy_pressure; }
    std::size_t elements() const override { return mesh_.triangles.size(); }

    void add_forces(State& state) const override {
        ElementSums sums;
        Vec3 all = Vec3::Zero();
        for (const Triangle& t : mesh_.triangles) {
            const Vec3 area = area_of(t, state);
            sums.positive_area += std::max(0.0, area.dot(state.air.direction));
            for (const NodeIndex i : t.node)
                sums.swept += area.dot(to_vec3(state.node[i].v)) / 3.0;
            all += area;
        }
        sums.area = {all.x(), all.y(), all.z()};
        const auto record = [&](std::size_t k) { return state.node[balance_.edges()[k]]; };
        const Lanes across = to_lanes(balance_.set_pressure(state, sums, balance_.openings(record)));
        for (const Triangle& t : mesh_.triangles) {
            const Lanes force = to_lanes(state.air.pressure / 3.0 * area_of(t, state));
            for (const NodeIndex i : t.node)
                state.aero[i].value += force;
        }
        for (NodeIndex i = 0; i < mesh_.canopy_nodes; ++i)
            state.aero[i].value += (mesh_.tributary_area[i] / fabric_area_) * across;
    }

private:
    const Mesh& mesh_;
    InflowBalance balance_;
    double fabric_area_;  // [m^2]
};

}  // namespace

std::optional<InflowBalance> InflowBalance::of(const Scene& scene, const Mesh& mesh) {
    if (!scene.parachutes.front().filling.is_predicted()) return {};
    return InflowBalance(scene, mesh);
}

InflowBalance::InflowBalance(const Scene& scene, const Mesh& mesh)
    : mesh_(mesh),
      edges_(fabric_edge_through(mesh, mesh.seam_rings.back().front())),
      vent_(fabric_edge_through(mesh, mesh.seam_rings.front().front())),
      skirt_(edges_.size()) {
    // The triangles' edges run round the mouth as its area into the canopy does, and the other way at the
    // vent.
    const Parachute& chute = scene.parachutes.front();
    const FillingCanopy canopy = filling_canopy(chute);
    const double D0 = chute.nominal_diameter, radius = steady_radius(chute);
    filling_ = canopy.filling();
    fabric_ = canopy.sizes().fabric;
    geometric_porosity_ = canopy.sizes().geometric_porosity;
    std::map<NodeIndex, std::size_t> edge;
    for (const Triangle& t : mesh.gaps) {
        auto& corners = gaps_.emplace_back();
        for (std::size_t c = 0; c < 3; ++c) {
            const auto [at, is_new] = edge.try_emplace(t.node[c], edges_.size());
            if (is_new) edges_.push_back(t.node[c]);
            corners[c] = at->second;
        }
    }
    area_ = mesh.fabric_area() + mesh.gap_area();
    geometric_porosity_ = std::max(geometric_porosity_, mesh.gap_area() / area_);
    full_area_ = pi * radius * radius;
    smallest_mouth_ = filling_.initial_mouth * full_area_;
    if (!mesh.reefing_line.empty()) {  // no mouth is larger than the circle that its line may enclose
        double line = 0.0;
        for (const std::size_t c : mesh.reefing_line)
            line += mesh.cables[c].rest_length;
        smallest_mouth_ = std::min(smallest_mouth_, line * line / (4.0 * pi));
    }
    full_volume_ = canopy.family().at(canopy.steady_radius()).volume * D0 * D0 * D0;
}

double InflowBalance::leak(double dp, double wetted, double density) const {
    const double through_openings =
        geometric_porosity_ > 0.0 ? geometric_porosity_ * opening_speed(dp, density) : 0.0;
    return wetted * ((1.0 - geometric_porosity_) * fabric_.speed(dp) + through_openings);
}

Vec3 InflowBalance::set_pressure(SystemState& state, const ElementSums& of_canopy,
                                 const Openings& open) const {
    AeroState& air = state.air;
    InflowState& inflow = state.inflow;
    const Vec3 area(of_canopy.area.data()), closed = area + open.gaps;
    air.projected_area = of_canopy.positive_area;
    air.signed_area = area.dot(air.direction);
    air.pressure = 0.0;
    air.pressure_capped = false;
    inflow.swept = of_canopy.swept + open.gaps_sweep - closed.dot(open.velocity);
    inflow.mouth = std::max(open.mouth.dot(air.direction), smallest_mouth_);
    inflow.ratio = inflow.leak = inflow.inside = inflow.loss = air.drag_area = 0.0;
    inflow.note_displaced(of_canopy.swept - area.dot(state.sums.canopy_area_velocity), state.dt, state.time);
    const double speed = (air.wind - open.velocity).dot(air.direction);
    // A canopy that has turned over shows its outside to the air: its mouth takes none in. Of one that is
    // folded as it comes from its pack nearly as much faces the air either way.
    const bool has_turned_over = air.signed_area < -folded * air.projected_area;
    if (!(speed > 0.0) || !(air.density > 0.0) || has_turned_over) return Vec3::Zero();

    const double rho = air.density, q = 0.5 * rho * speed * speed, supply = inflow.mouth * speed;
    const double filled = std::clamp(inflow.volume / full_volume_, 0.0, 1.0);
    const double wetted = area_ * std::cbrt(filled * filled);  // of bulbs that are alike
    const double K = filling_.entrance_loss;
    // Suction outside grows with the radius to what the full canopy's drag area asks for, whatever area it
    // settles at once it has been full. That was measured with the fabric's leak, so the inflow that feeds
    // it, which a full canopy loses at its mouth, comes back as it gets there: at most all, or no such canopy
    // stays open.
    const double full = (inflow.has_been_full ? smallest_settled : 1.0) * full_area_;
    const double wide = std::max(air.signed_area, full), steady = inflow.steady_drag_area / wide;
    const double fullness = std::clamp(air.signed_area / full, 0.0, 1.0);
    const double feed = leak(q * steady, area_, rho) / (wide * speed);
    const double suction =
        (steady - 1.0) * std::sqrt(fullness) + std::min(1.0, K * feed * feed) * std::pow(fullness, 4);

    const Inertance around = inertance(inflow, rho);
    const double loaded = 1.0 + around.value * inflow.mobility;

    // Everything falls with the inflow s but the supply: one root. The rate of the volume is that of the end
    // of the step, in which the pressure changes and all else pulls as it did. (The edges of gaps take their
    // surfaces with them, which the mobility leaves out: an error of that part of one step.)
    const double mobility = state.dt * inflow.mobility / loaded;
    const auto pressure = [&](double s) { return q * std::max(0.0, 1.0 - K * s * std::abs(s) + suction); };
    const auto surplus = [&](double s) {
        const double dp = pressure(s);
        return supply * s - inflow.swept - mobility * (dp - inflow.last_inside) - leak(dp, wetted, rho);
    };
    double high = std::min(1.0, std::sqrt(std::max(0.0, (1.0 + suction) / K))), low = -1.0;
    if (surplus(high) < 0.0) low = high;  // it grows faster than air can follow
    while (surplus(low) > 0.0 && low > -largest_outflow)
        low *= 2.0;
    while (high - low > 1e-14 * (1.0 + std::abs(low))) {
        const double s = 0.5 * (low + high);
        if (s == low || s == high) break;
        (surplus(s) > 0.0 ? high : low) = s;
    }
    inflow.ratio = 0.5 * (low + high);
    inflow.inside = pressure(inflow.ratio);
    inflow.leak = leak(inflow.inside, wetted, rho);

    // d/dt(I Q) - 1/2 dI/dt Q of the air around, with Q' = mobility times the pressure and all else that
    // pulls: what that would give the canopy, the air around shares.
    const double outside = (around.value * (inflow.mobility * inflow.inside + inflow.other_pull) +
                            0.5 * around.rate * inflow.displaced) /
                           loaded;
    air.pressure = inflow.inside - outside;
    // Air that a gap moves through has pushed nothing.
    const double unpushed = open.gaps_sweep - open.gaps.dot(air.wind);
    inflow.loss =
        inflow.inside * (supply * (1.0 - inflow.ratio) + inflow.leak + unpushed) + outside * inflow.displaced;
    const double dragged = std::max(0.0, air.signed_area);
    if (air.dynamic_pressure > 0.0) air.drag_area = inflow.inside * dragged / air.dynamic_pressure;
    return inflow.inside * dragged * air.direction - air.pressure * area;
}

InflowBalance::Inertance InflowBalance::inertance(const InflowState& inflow, double density) const {
    // No bulb is smaller than the one that the mouth begins with.
    const double least = std::pow(filling_.initial_mouth, 1.5), filled = inflow.volume / full_volume_;
    const double radius = std::sqrt(full_area_ / pi) * std::cbrt(std::max(filled, least));
    const double value = density / (2.0 * pi * radius);
    return {value, filled > least ? -value * inflow.swept / (3.0 * inflow.volume) : 0.0};
}

void InflowBalance::measure(State& state, const NodeConstants& constants) const {
    const auto middle_of = [&](std::span<const NodeIndex> ring) {
        Vec3 middle = Vec3::Zero();
        for (const NodeIndex i : ring)
            middle += to_vec3(state.node[i].x) / static_cast<double>(ring.size());
        return middle;
    };
    const Vec3 mouth = middle_of(std::span(edges_).first(skirt_)), vent = middle_of(vent_) - mouth;
    std::vector<Vec3> area(static_cast<std::size_t>(mesh_.canopy_nodes), Vec3::Zero());
    double volume = 0.0;
    const auto add_volume = [&](const Triangle& t, const Vec3& third) {
        for (const NodeIndex i : t.node)
            volume += third.dot(to_vec3(state.node[i].x) - mouth) / 3.0;
    };
    for (const Triangle& t : mesh_.triangles) {
        const Vec3 third = area_of(t, state) / 3.0;
        for (const NodeIndex i : t.node)
            area[i] += third;
        add_volume(t, third);
    }
    for (const Triangle& t : mesh_.gaps)
        add_volume(t, area_of(t, state) / 3.0);
    // The vent closes it as a cone whose base goes round the other way.
    for (std::size_t k = 0; k < vent_.size(); ++k) {
        const Vec3 here = to_vec3(state.node[vent_[k]].x) - mouth - vent;
        const Vec3 next = to_vec3(state.node[vent_[(k + 1) % vent_.size()]].x) - mouth - vent;
        volume -= 0.5 * here.cross(next).dot(vent) / 3.0;
    }
    double mobility = 0.0;
    for (std::size_t i = 0; i < area.size(); ++i)
        mobility += area[i].squaredNorm() / (constants.mass[i] + constants.share[i] * state.added_mass);
    state.inflow.volume = volume;
    state.inflow.mobility = mobility;
}

std::unique_ptr<const ForceModel> make_inflow_pressure(const Mesh& mesh, const InflowBalance& balance) {
    return std::make_unique<InflowPressure>(mesh, balance);
}

}  // namespace twinchute::fullsim
