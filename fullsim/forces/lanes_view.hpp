// The reference that storages are compared with: elements four side by side, which read their nodes' records
// and add forces to them one after the other in mesh order (see fullsim/elements/membrane.hpp for views).
#pragma once

#include <hwy/highway.h>

#include "fullsim/elements/passes.hpp"
#include "fullsim/forces/gather.hpp"

namespace twinchute::fullsim {

/// A view of groups of four. Element: made of a state's nodes, the forces on them, and a group. Forces: those
/// that Element adds to.
template <class Element>
class LanesView {
public:
    using T = Lanes;
    using T3 = Lanes3;
    using Flow = Lanes3;
    using Group = typename Element::Group;
    static constexpr bool skips = true;

    LanesView(const std::vector<NodeRecord>& node, NodeForces::View on_node, const std::vector<Group>& groups)
        : part_{node, on_node, groups} {}

    static HWY_INLINE Lanes all(double a) { return splat(a); }
    static HWY_INLINE Lanes3 all3(const std::array<double, 3>& a) {
        return {splat(a[0]), splat(a[1]), splat(a[2])};
    }
    HWY_INLINE int first() const { return 0; }
    HWY_INLINE int last() const { return 1; }
    HWY_INLINE Flow flow(const std::array<double, 3>& direction) const { return all3(direction); }

    struct Part {
        const std::vector<NodeRecord>& node;
        NodeForces::View on_node;
        const std::vector<Group>& groups;

        HWY_INLINE std::size_t size() const { return groups.size(); }
        HWY_INLINE Element element(std::size_t k) const { return Element(node, on_node, groups[k]); }
        HWY_INLINE Lanes live(Lanes sum) const { return sum; }
        HWY_INLINE Lanes live_load(Lanes load) const { return load; }
        HWY_INLINE void finish(std::size_t) const {}
        HWY_INLINE void close() const {}
    };
    HWY_INLINE const Part& part(int) const { return part_; }

private:
    Part part_;
};

template <class OfGroup>
class LanesElement {
public:
    using Group = OfGroup;

    HWY_INLINE LanesElement(const std::vector<NodeRecord>& node, NodeForces::View on_node, const Group& group)
        : node_(node), on_node_(on_node), g_(group) {}

    HWY_INLINE Lanes live(Lanes a, double) const { return a; }
    HWY_INLINE void add_force(int corner, Lanes3 force) const {
        const CornerForces of(force);
        for (int k = 0; k < lane_count; ++k)
            on_node_[g_.node[corner][k]].value += of.row[k];
    }
    HWY_INLINE void subtract_force(int corner, Lanes3 force) const {
        const CornerForces of(force);
        for (int k = 0; k < lane_count; ++k)
            on_node_[g_.node[corner][k]].value -= of.row[k];
    }

protected:
    HWY_INLINE Lanes3 x(int corner) const { return gather_position(node_, g_.node[corner]); }
    HWY_INLINE Lanes3 v(int corner) const { return gather_velocity(node_, g_.node[corner]); }
    HWY_INLINE void add_to_all(Lanes3 force) const {
        const CornerForces of(force);
        for (int k = 0; k < lane_count; ++k)
            for (const LaneNodes& corner : g_.node)
                on_node_[corner[k]].value += of.row[k];
    }

    const std::vector<NodeRecord>& node_;
    NodeForces::View on_node_;
    const Group& g_;
};

template <class OfGroup>
class TriangleLanes : public LanesElement<OfGroup> {
public:
    HWY_INLINE TriangleLanes(const std::vector<NodeRecord>& node, NodeForces::View on_node,
                             const OfGroup& group)
        : LanesElement<OfGroup>(node, on_node, group) {}

    HWY_INLINE void edges(Lanes3& e1, Lanes3& e2) const {
        const Lanes3 x0 = this->x(0);
        e1 = this->x(1) - x0, e2 = this->x(2) - x0;
    }
    HWY_INLINE void edges(Lanes3& e1, Lanes3& e2, Lanes3& w1, Lanes3& w2) const {
        edges(e1, e2);
        const Lanes3 v0 = this->v(0);
        w1 = this->v(1) - v0, w2 = this->v(2) - v0;
    }
    HWY_INLINE void edges_and_mean_velocity(Lanes3& e1, Lanes3& e2, Lanes3& mean) const {
        edges(e1, e2);
        mean = (1.0 / 3.0) * (this->v(0) + this->v(1) + this->v(2));
    }
    HWY_INLINE void pull(Lanes3 first, Lanes3 second, Lanes3 third) const {
        this->add_force(0, first);
        this->subtract_force(1, second);
        this->subtract_force(2, third);
    }
    HWY_INLINE void add_drag(Lanes3 force) const { this->add_to_all(force); }
};

template <class OfGroup>
class SpanLanes : public LanesElement<OfGroup> {
public:
    HWY_INLINE SpanLanes(const std::vector<NodeRecord>& node, NodeForces::View on_node, const OfGroup& group)
        : LanesElement<OfGroup>(node, on_node, group) {}

    HWY_INLINE Lanes3 distance() const { return this->x(1) - this->x(0); }
    HWY_INLINE void ends(Lanes3& d, Lanes3& w) const { d = distance(), w = this->v(1) - this->v(0); }
    HWY_INLINE Lanes3 mean_velocity(Lanes3) const { return 0.5 * (this->v(0) + this->v(1)); }
    HWY_INLINE Lanes inverse_length() const { return this->g_.inverse_length; }
    HWY_INLINE Lanes stiffness() const { return this->g_.stiffness; }
    HWY_INLINE Lanes dashpot() const { return this->g_.dashpot; }
    HWY_INLINE void pull_together(Lanes3 force) const {
        const CornerForces pull(force);
        for (int k = 0; k < lane_count; ++k) {
            this->on_node_[this->g_.node[0][k]].value += pull.row[k];
            this->on_node_[this->g_.node[1][k]].value -= pull.row[k];
        }
    }
    HWY_INLINE void add_drag(Lanes3 end) const { this->add_to_all(end); }
};

}  // namespace twinchute::fullsim
