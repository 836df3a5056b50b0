#include "fullsim/canopy_plane.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace twinchute::fullsim {
namespace {

/// From centre to centre.
struct Line {
    Lanes origin, normal;  // [m], [-]
    double distance;       // [m]
};

Line line_of(const PressedNodes& a, const PressedNodes& b) {
    const Lanes apart = b.centre - a.centre;
    const double distance = std::sqrt(sum3(apart * apart));
    return {a.centre, distance > 0.0 ? apart / splat(distance) : splat(0.0), distance};
}

/// A node that may be behind the plane: where it is along the normal, and its stiffness.
struct Candidate {
    std::size_t node;
    double along, stiffness;  // [m], [N/m]
};

/// Nodes of a canopy that are beyond `other` [m], seen from its side: +1 for the one that the normal comes
/// from.
std::vector<Candidate> beyond(const PressedNodes& canopy, const Line& line, double side, double other) {
    std::vector<Candidate> found;
    for (std::size_t i = 0; i < canopy.node.size(); ++i) {
        const double along = sum3((canopy.node[i].x - line.origin) * line.normal);
        if (side * (along - other) > 0.0) found.push_back({i, along, canopy.stiffness * canopy.mass[i]});
    }
    return found;
}

struct Extent {
    double reach, speed;  // [m], [m/s] along side * normal, the largest of all nodes
};

Extent extent_of(const PressedNodes& canopy, const Line& line, double side) {
    Extent most{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (const NodeRecord& node : canopy.node) {
        most.reach = std::max(most.reach, side * sum3((node.x - line.origin) * line.normal));
        most.speed = std::max(most.speed, side * sum3(node.v * line.normal));
    }
    return most;
}

/// Where both sides push as much, between `low` and `high` [m]: their difference falls along the normal.
double balanced(const std::vector<Candidate>& a, const std::vector<Candidate>& b, double low, double high) {
    constexpr int most = 200;  // halvings alone would take 60
    double place = 0.5 * (low + high);
    for (int k = 0; k < most; ++k) {
        double stiffness = 0.0, moment = 0.0;
        for (const Candidate& c : a)
            if (c.along > place) stiffness += c.stiffness, moment += c.stiffness * c.along;
        for (const Candidate& c : b)
            if (c.along < place) stiffness += c.stiffness, moment += c.stiffness * c.along;
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
    const Line line = line_of(a, b);
    if (a.node.empty() || b.node.empty() || !(line.distance > 0.0)) return contact;
    const Extent from_a = extent_of(a, line, 1.0), from_b = extent_of(b, line, -1.0);
    const double high = from_a.reach, low = -from_b.reach;
    contact.gap = low - high;
    contact.closing = from_a.speed + from_b.speed;
    if (!(contact.gap < 0.0)) return contact;

    const std::vector<Candidate> behind_a = beyond(a, line, 1.0, low), behind_b = beyond(b, line, -1.0, high);
    const double place = balanced(behind_a, behind_b, low, high);
    Lanes turning = splat(0.0);  // dU/dn
    const auto push = [&](const PressedNodes& canopy, const std::vector<Candidate>& behind, double side,
                          std::span<Lanes> on) {
        double sum = 0.0;
        for (const Candidate& c : behind) {
            const double depth = side * (c.along - place);
            if (!(depth > 0.0)) continue;
            const double force = c.stiffness * depth;
            on[c.node] -= (side * force) * line.normal;
            turning += (side * force) * (canopy.node[c.node].x - line.origin);
            contact.energy += 0.5 * force * depth;
            contact.depth = std::max(contact.depth, depth);
            sum += force;
        }
        return sum;
    };
    contact.force = push(a, behind_a, 1.0, on_a);
    push(b, behind_b, -1.0, on_b);
    // The normal follows the centres: what turns it acts on them.
    contact.on_first = (turning - sum3(turning * line.normal) * line.normal) / splat(line.distance);
    return contact;
}

std::array<std::vector<NodeIndex>, 2> near_nodes(const PressedNodes& a, const PressedNodes& b, double reach) {
    const Line line = line_of(a, b);
    if (!(line.distance > 0.0)) return {};
    const double high = extent_of(a, line, 1.0).reach, low = -extent_of(b, line, -1.0).reach;
    std::array<std::vector<NodeIndex>, 2> near;
    const auto find = [&](const PressedNodes& canopy, double side, double other, std::vector<NodeIndex>& to) {
        for (const Candidate& c : beyond(canopy, line, side, other - side * reach))
            to.push_back(static_cast<NodeIndex>(c.node));
    };
    find(a, 1.0, low, near[0]);
    find(b, -1.0, high, near[1]);
    return near;
}

void CanopyPlane::search(const PressedNodes& a, const PressedNodes& b, double meanwhile, double least) {
    const Line line = line_of(a, b);
    const double closing = extent_of(a, line, 1.0).speed + extent_of(b, line, -1.0).speed;
    near_ = near_nodes(a, b, least + std::max(0.0, closing) * meanwhile);
}

void CanopyPlane::serialize(Archive& archive) {
    for (double* x : {&largest_force_, &deepest_, &first_touch_})
        archive.number("plane between canopies", *x);
    for (std::vector<NodeIndex>& nodes : near_) {
        archive.length("nodes near a plane", nodes, 100'000'000);
        for (NodeIndex& i : nodes)
            archive.whole("node near a plane", i, 0);
    }
}

}  // namespace twinchute::fullsim
