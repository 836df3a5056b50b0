#include "fullsim/canopy_plane.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace twinchute::fullsim {
namespace {

struct Centre {
    Lanes position = splat(0.0);  // [m]
    double mass = 0.0;            // [kg]
};

Centre centre_of(const PressedNodes& canopy) {
    Centre centre;
    for (std::size_t i = 0; i < canopy.node.size(); ++i) {
        centre.position += canopy.mass[i] * canopy.node[i].x;
        centre.mass += canopy.mass[i];
    }
    centre.position = centre.position / splat(centre.mass);
    return centre;
}

/// A node that may be behind the plane: where it is along the normal, and its stiffness.
struct Candidate {
    std::size_t node;
    double along, stiffness;  // [m], [N/m]
};

/// Candidates of a canopy, `side` +1 for the one that the normal comes from; `reach`: how far it extends
/// toward the other. Places are from `origin`.
std::vector<Candidate> beyond(const PressedNodes& canopy, Lanes origin, Lanes normal, double side, double other) {
    std::vector<Candidate> found;
    for (std::size_t i = 0; i < canopy.node.size(); ++i) {
        const double along = sum3((canopy.node[i].x - origin) * normal);
        if (side * (along - other) > 0.0) found.push_back({i, along, canopy.stiffness * canopy.mass[i]});
    }
    return found;
}

struct Extent {
    double reach, speed;  // [m], [m/s] along side * normal, the largest of all nodes
};

Extent extent_of(const PressedNodes& canopy, Lanes origin, Lanes normal, double side) {
    Extent most{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (const NodeRecord& node : canopy.node) {
        most.reach = std::max(most.reach, side * sum3((node.x - origin) * normal));
        most.speed = std::max(most.speed, side * sum3(node.v * normal));
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
    const Centre of_a = centre_of(a), of_b = centre_of(b);
    const Lanes apart = of_b.position - of_a.position;
    const double distance = std::sqrt(sum3(apart * apart));
    PlaneContact contact;
    if (!(distance > 0.0)) return contact;
    const Lanes normal = apart / splat(distance), origin = of_a.position;
    const Extent from_a = extent_of(a, origin, normal, 1.0), from_b = extent_of(b, origin, normal, -1.0);
    const double high = from_a.reach, low = -from_b.reach;
    contact.gap = low - high;
    contact.closing = from_a.speed + from_b.speed;
    if (!(contact.gap < 0.0)) return contact;

    const std::vector<Candidate> behind_a = beyond(a, origin, normal, 1.0, low),
                                 behind_b = beyond(b, origin, normal, -1.0, high);
    const double place = balanced(behind_a, behind_b, low, high);
    Lanes turning = splat(0.0);  // dU/dn
    const auto push = [&](const PressedNodes& canopy, const std::vector<Candidate>& behind, double side,
                          std::span<Lanes> on) {
        double sum = 0.0;
        for (const Candidate& c : behind) {
            const double depth = side * (c.along - place);
            if (!(depth > 0.0)) continue;
            const double force = c.stiffness * depth;
            on[c.node] -= (side * force) * normal;
            turning += (side * force) * (canopy.node[c.node].x - origin);
            contact.energy += 0.5 * force * depth;
            contact.depth = std::max(contact.depth, depth);
            sum += force;
        }
        return sum;
    };
    contact.force = push(a, behind_a, 1.0, on_a);
    push(b, behind_b, -1.0, on_b);

    // The normal follows the centres: what turns it acts on them.
    const Lanes across = turning - sum3(turning * normal) * normal;
    const Lanes on_centre = across / splat(distance);
    for (std::size_t i = 0; i < a.node.size(); ++i)
        on_a[i] += (a.mass[i] / of_a.mass) * on_centre;
    for (std::size_t i = 0; i < b.node.size(); ++i)
        on_b[i] -= (b.mass[i] / of_b.mass) * on_centre;
    return contact;
}

void CanopyPlane::serialize(Archive& archive) {
    for (double* x : {&last_.gap, &last_.closing, &last_.force, &last_.energy, &last_.depth, &time_,
                      &largest_force_, &deepest_, &first_touch_})
        archive.number("plane between canopies", *x);
    archive.whole("looked at", looked_at_, -longest_wait);
}

}  // namespace twinchute::fullsim
