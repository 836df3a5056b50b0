// Contact of two canopies along the plane between them, as a force law alone.
#include "fullsim/canopy_plane.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "tests/support/random.hpp"

namespace twinchute::fullsim {
namespace {

/// Nodes of a canopy at rest, at `place`.
struct Blob {
    std::vector<NodeRecord> node;
    std::vector<double> mass;
    double stiffness = 1e4;  // [1/s^2]
    Lanes payload = to_lanes(Vec3(0.5, -0.7, -4.0));

    void add(const Vec3& x, double m) {
        node.push_back({to_lanes(x), splat(0.0)});
        mass.push_back(m);
    }
    PressedNodes pressed() const {
        Lanes centre = splat(0.0);
        double sum = 0.0;
        for (std::size_t i = 0; i < node.size(); ++i) {
            centre += mass[i] * node[i].x;
            sum += mass[i];
        }
        return {node, mass, stiffness, centre / splat(sum), sum, payload};
    }
};

/// 40 nodes of 1 to 3 g in a ball of 1 m.
Blob random_blob(test::Random& random, const Vec3& place, double stiffness) {
    Blob blob;
    blob.stiffness = stiffness;
    while (blob.node.size() < 40) {
        const Vec3 x(random.number_in(-1.0, 1.0), random.number_in(-1.0, 1.0), random.number_in(-1.0, 1.0));
        if (x.norm() < 1.0) blob.add(place + x, random.number_in(1e-3, 3e-3));
    }
    return blob;
}

struct Pushed {
    PlaneContact contact;
    std::vector<Lanes> on_a, on_b;  // all of it, what acts on the whole canopy included
};

Pushed push(const Blob& a, const Blob& b) {
    Pushed all{{}, std::vector(a.node.size(), splat(0.0)), std::vector(b.node.size(), splat(0.0))};
    const PressedNodes of_a = a.pressed(), of_b = b.pressed();
    all.contact = press_apart(of_a, of_b, all.on_a, all.on_b);
    for (std::size_t i = 0; i < a.node.size(); ++i)
        all.on_a[i] += (a.mass[i] / of_a.canopy_mass) * all.contact.on_first;
    for (std::size_t i = 0; i < b.node.size(); ++i)
        all.on_b[i] += (b.mass[i] / of_b.canopy_mass) * all.contact.on_second;
    return all;
}

class CanopyPlaneTest : public testing::Test {
protected:
    test::Random random_{11};
    Blob a_ = random_blob(random_, {0.0, 0.0, 0.0}, 1e4), b_ = random_blob(random_, {1.3, 0.4, -0.3}, 4e4);
};

TEST_F(CanopyPlaneTest, ForcesAreTheGradientOfTheEnergy) {
    // Central differences of U, h = 1e-6 m: truncation h^2 U''' is below rounding, which is 1e-16 U/h.
    constexpr double h = 1e-6;
    const Pushed at = push(a_, b_);
    ASSERT_GT(at.contact.force, 0.0);
    double largest = 0.0, wrong = 0.0;
    for (int c = 0; c < 3; ++c) {
        const auto energy = [&](double shift) {
            Blob a = a_, b = b_;
            a.payload[c] += shift;
            b.payload[c] += shift;
            return push(a, b).contact.energy;
        };
        wrong = std::max(wrong, std::abs(at.contact.on_payload[c] + (energy(h) - energy(-h)) / (2.0 * h)));
    }
    for (auto* blob : {&a_, &b_})
        for (std::size_t i = 0; i < blob->node.size(); ++i)
            for (int c = 0; c < 3; ++c) {
                double& x = reinterpret_cast<double*>(&blob->node[i].x)[c];
                const double before = x;
                x = before + h;
                const double above = push(a_, b_).contact.energy;
                x = before - h;
                const double below = push(a_, b_).contact.energy;
                x = before;
                const double force = (blob == &a_ ? at.on_a : at.on_b)[i][c];
                largest = std::max(largest, std::abs(force));
                wrong = std::max(wrong, std::abs(force + (above - below) / (2.0 * h)));
            }
    EXPECT_LT(wrong, 1e-6 * largest);
}

TEST_F(CanopyPlaneTest, MomentaAreKept) {
    const Pushed at = push(a_, b_);
    Vec3 force = to_vec3(at.contact.on_payload), torque = to_vec3(a_.payload).cross(force);
    double sum = force.norm();
    ASSERT_GT(sum, 0.0);
    for (const auto& [blob, on] : {std::pair{&a_, &at.on_a}, std::pair{&b_, &at.on_b}})
        for (std::size_t i = 0; i < on->size(); ++i) {
            const Vec3 f = to_vec3((*on)[i]);
            force += f;
            torque += to_vec3(blob->node[i].x).cross(f);
            sum += f.norm();
        }
    // 80 nodes, each with some rounding of a force and an arm of 2 m.
    EXPECT_LT(force.norm(), 1e-13 * sum);
    EXPECT_LT(torque.norm(), 1e-12 * sum);
}

TEST_F(CanopyPlaneTest, CanopiesDrawnOutSideBySideDoNotTouch) {
    // Two strings from the payload on, straight and 20 mrad apart, one drawn out 2 m and the other 3: from
    // centre to centre would lead along them, half a metre past each other.
    Blob left, right;
    for (int i = 1; i <= 20; ++i) {
        left.add(to_vec3(left.payload) + 0.1 * i * Vec3(-0.01, 0.0, 1.0), 1e-3);
        right.add(to_vec3(left.payload) + 0.15 * i * Vec3(0.01, 0.0, 1.0), 1e-3);
    }
    EXPECT_GT(push(left, right).contact.gap, 0.0);
    EXPECT_EQ(push(left, right).contact.force, 0.0);
}

TEST_F(CanopyPlaneTest, CanopiesThatStandApartDoNothing) {
    Blob left, right;
    left.payload = right.payload = to_lanes(Vec3(-0.15, 0.0, -4.0));  // as far from both centres
    left.add({-1.0, 0.0, 0.0}, 1.0);
    left.add({-0.2, 0.0, 0.0}, 1.0);
    right.add({0.3, 0.0, 0.0}, 2.0);
    const Pushed at = push(left, right);
    EXPECT_NEAR(at.contact.gap, 0.5, 1e-14);  // from -0.2 to 0.3
    EXPECT_EQ(at.contact.force, 0.0);
    EXPECT_EQ(at.on_a[1][0], 0.0);
}

TEST_F(CanopyPlaneTest, NodesShareTheirOverlapAsSpringsInSeries) {
    // 2 mm of overlap; k = m w^2: 1e-3 kg * 1e4 = 10 N/m against 1e-3 * 4e4 = 40 N/m, 8 N/m in series. The
    // centres lie on the line of both: nothing turns.
    Blob left, right;
    left.payload = right.payload = to_lanes(Vec3(0.0, 0.0, -4.0));
    right.stiffness = 4e4;
    left.add({-1.0, 0.0, 0.0}, 1e-3);
    left.add({0.001, 0.0, 0.0}, 1e-3);
    right.add({-0.001, 0.0, 0.0}, 1e-3);
    right.add({1.0, 0.0, 0.0}, 1e-3);
    const Pushed at = push(left, right);
    EXPECT_NEAR(at.contact.force, 8.0 * 2e-3, 1e-12);
    EXPECT_NEAR(at.on_a[1][0], -8.0 * 2e-3, 1e-12);
    EXPECT_NEAR(at.on_b[0][0], 8.0 * 2e-3, 1e-12);
    EXPECT_NEAR(at.contact.energy, 0.5 * 8.0 * 4e-6, 1e-15);
    EXPECT_NEAR(at.contact.depth, 1.6e-3, 1e-12);  // the softer one gives way, 4 of 5 parts
}

TEST_F(CanopyPlaneTest, NodesThatMayTouchAreAllThatDo) {
    // Contact of those alone is that of all, as long as they reach as far as the others are behind.
    const Pushed all = push(a_, b_);
    const auto near = near_nodes(a_.pressed(), b_.pressed(), 0.01);
    ASSERT_LT(near[0].size(), a_.node.size());
    Blob some_a, some_b;
    const auto pick = [](const Blob& from, const std::vector<NodeIndex>& nodes, Blob& to) {
        to.stiffness = from.stiffness;
        for (const NodeIndex i : nodes)
            to.add(to_vec3(from.node[static_cast<std::size_t>(i)].x), from.mass[static_cast<std::size_t>(i)]);
        PressedNodes pressed = from.pressed();
        pressed.node = to.node;
        pressed.mass = to.mass;
        return pressed;
    };
    const PressedNodes of_a = pick(a_, near[0], some_a), of_b = pick(b_, near[1], some_b);
    std::vector<Lanes> on_a(some_a.node.size(), splat(0.0)), on_b(some_b.node.size(), splat(0.0));
    const PlaneContact contact = press_apart(of_a, of_b, on_a, on_b);
    EXPECT_NEAR(contact.force, all.contact.force, 1e-12 * all.contact.force);
    EXPECT_NEAR(contact.energy, all.contact.energy, 1e-12 * all.contact.energy);
}

}  // namespace
}  // namespace twinchute::fullsim
