#include "fullsim/canopy_plane.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace twinchute::fullsim {
namespace {

/// Where the payload sees the centre of a canopy.
struct Sight {
    Lanes along;      // [-]
    double distance;  // [m]

    explicit Sight(const PressedNodes& canopy) {
        const Lanes away = canopy.centre - canopy.payload;
        distance = std::sqrt(sum3(away * away));
        along = distance > 0.0 ? away / splat(distance) : splat(0.0);
    }
    /// [N] on the centre, from `turns`, dU over the change of `along`.
    Lanes force(Lanes turns) const { return (sum3(turns * along) * along - turns) / splat(distance); }
};

/// From canopy to canopy, across the plane between them.
struct Line {
    Lanes origin, normal;  // [m], [-]
    double apart;          // twice the sine of half the angle in which the payload sees both; zero: no line
};

Line line_between(const PressedNodes& canopy, const Sight& a, const Sight& b) {
    const Lanes apart = b.along - a.along;
    const double size = a.distance > 0.0 && b.distance > 0.0 ? std::sqrt(sum3(apart * apart)) : 0.0;
    return {canopy.centre, size > 0.0 ? apart / splat(size) : splat(0.0), size};
}

/// A node that may be behind the plane: where it is along the normal, and its stiffness.
struct Candidate {
    std::size_t node;
    double along, stiffness;  // [m], [N/m]
};

/// Nodes of a canopy along the normal [m], from the origin, and the farthest of them by side * normal: side
/// is +1 for the canopy that the normal comes from.
struct Projection {
    std::vector<double> along;
    double reach = -std::numeric_limits<double>::infinity();
};

Projection project(const PressedNodes& canopy, const Line& line, double side) {
    Projection nodes{std::vector<double>(canopy.node.size())};
    for (std::size_t i = 0; i < canopy.node.size(); ++i) {
        nodes.along[i] = sum3((canopy.node[i].x - line.origin) * line.normal);
        nodes.reach = std::max(nodes.reach, side * nodes.along[i]);
    }
    return nodes;
}

/// Nodes beyond `other` [m], seen from their side.
std::vector<Candidate> beyond(const PressedNodes& canopy, const Projection& nodes, double side,
                              double other) {
    std::vector<Candidate> found(nodes.along.size());
    std::size_t count = 0;  // no branch: which nodes are beyond follows no pattern
    for (std::size_t i = 0; i < nodes.along.size(); ++i) {
        found[count] = {i, nodes.along[i], canopy.stiffness * canopy.mass[i]};
        count += side * (nodes.along[i] - other) > 0.0 ? 1 : 0;
    }
    found.resize(count);
    return found;
}

/// [m/s] of the fastest node by side * normal.
double fastest(const PressedNodes& canopy, const Line& line, double side) {
    double most = -std::numeric_limits<double>::infinity();
    for (const NodeRecord& node : canopy.node)
        most = std::max(most, side * sum3(node.v * line.normal));
    return most;
}

/// Where both sides push as much, between `low` and `high` [m]: their difference falls along the normal.
double balanced(const std::vector<Candidate>& a, const std::vector<Candidate>& b, double low, double high) {
    constexpr int most = 200;  // halvings alone would take 60
    double place = 0.5 * (low + high);
    for (int k = 0; k < most; ++k) {
        double stiffness = 0.0, moment = 0.0;
        const auto add = [&](const Candidate& c, bool pushes) {
            const double of = pushes ? c.stiffness : 0.0;
            stiffness += of;
            moment += of * c.along;
        };
        for (const Candidate& c : a)
            add(c, c.along > place);
        for (const Candidate& c : b)
            add(c, c.along < place);
        const double push = moment - stiffness * place;  // of a over that of b
        (push > 0.0 ? low : high) = place;
        double next = stiffness > 0.0 ? moment / stiffness : 0.5 * (low + high);
        if (next == place) break;
        if (!(next > low && next < high)) next = 0.5 * (low + high);
        if (next == low || next == high) break;
        place = next;
    }
    return place;
}

}  // namespace

PlaneContact press_apart(const PressedNodes& a, const PressedNodes& b, std::span<Lanes> on_a,
                         std::span<Lanes> on_b) {
    PlaneContact contact;
    const Sight sight_a(a), sight_b(b);
    const Line line = line_between(a, sight_a, sight_b);
    if (a.node.empty() || b.node.empty() || !(line.apart > 0.0)) return contact;
    const Projection of_a = project(a, line, 1.0), of_b = project(b, line, -1.0);
    const double high = of_a.reach, low = -of_b.reach;
    contact.gap = low - high;
    if (!(contact.gap < 0.0)) return contact;

    const std::vector<Candidate> behind_a = beyond(a, of_a, 1.0, low), behind_b = beyond(b, of_b, -1.0, high);
    const double place = balanced(behind_a, behind_b, low, high);
    Lanes turning = splat(0.0);  // dU/dn
    const auto push = [&](const PressedNodes& canopy, const std::vector<Candidate>& behind, double side,
                          std::span<Lanes> on) {
        double sum = 0.0;
        for (const Candidate& c : behind) {
            const double depth = std::max(0.0, side * (c.along - place)), force = c.stiffness * depth;
            const Lanes along = splat(side * force);
            on[c.node] -= along * line.normal;
            turning += along * (canopy.node[c.node].x - line.origin);
            contact.energy += 0.5 * force * depth;
            contact.depth = std::max(contact.depth, depth);
            sum += force;
        }
        return sum;
    };
    contact.force = push(a, behind_a, 1.0, on_a);
    push(b, behind_b, -1.0, on_b);
    // The normal follows the centres as the payload sees them: what turns it acts on all three.
    const Lanes turns = (turning - sum3(turning * line.normal) * line.normal) / splat(line.apart);
    contact.on_first = sight_a.force(-turns);
    contact.on_second = sight_b.force(turns);
    contact.on_payload = -(contact.on_first + contact.on_second);
    return contact;
}

std::array<std::vector<NodeIndex>, 2> near_nodes(const PressedNodes& a, const PressedNodes& b, double reach) {
    const Line line = line_between(a, Sight(a), Sight(b));
    if (!(line.apart > 0.0)) return {};
    const Projection of_a = project(a, line, 1.0), of_b = project(b, line, -1.0);
    std::array<std::vector<NodeIndex>, 2> near;
    for (const Candidate& c : beyond(a, of_a, 1.0, -of_b.reach - reach))
        near[0].push_back(static_cast<NodeIndex>(c.node));
    for (const Candidate& c : beyond(b, of_b, -1.0, of_a.reach + reach))
        near[1].push_back(static_cast<NodeIndex>(c.node));
    return near;
}

void CanopyPlane::search(const PressedNodes& a, const PressedNodes& b, double meanwhile, double least) {
    const Line line = line_between(a, Sight(a), Sight(b));
    const double closing = fastest(a, line, 1.0) + fastest(b, line, -1.0);
    near_ = near_nodes(a, b, least + std::max(0.0, closing) * meanwhile);
}

void CanopyPlane::serialize(Archive& archive, const std::array<NodeIndex, 2>& nodes_of) {
    for (double* x : {&largest_force_, &deepest_})
        archive.number("plane between canopies", *x);
    for (std::size_t side = 0; side < near_.size(); ++side) {
        archive.length("nodes near a plane", near_[side], static_cast<std::size_t>(nodes_of[side]));
        for (NodeIndex& i : near_[side])
            archive.whole("node near a plane", i, 0, nodes_of[side] - 1);
    }
}

}  // namespace twinchute::fullsim
