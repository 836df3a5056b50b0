// Self-contact of fabric, pair by pair: its law beside the same typed by hand, and the kernels beside the
// law.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <random>

#include "fullsim/forces/self_contact_kernels.hpp"
#include "fullsim/forces/triangle_bins.hpp"
#include "fullsim/laws/self_contact.hpp"
#include "fullsim/state.hpp"

namespace twinchute::fullsim {
namespace {

// --- the law of one pair --------------------------------------------------------------------------

const SelfContactLaw law_of_pair{800.0, 0.3, 2.0};
constexpr double thick = 0.01;  // [m]

/// A node over the strip where a triangle hands over to the next: windows of 0.2 to 0.9.
const NodeAndTriangle over_edge{Vec3(0.105, 0.072, 0.206),
                                {Vec3(0.0, 0.0, 0.2), Vec3(0.2, 0.01, 0.21), Vec3(0.03, 0.15, 0.19)}};

NodeAndTriangle random_motion(unsigned seed) {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<double> one(-1.0, 1.0);
    const auto vector = [&] { return Vec3(one(generator), one(generator), one(generator)); };
    return {vector(), {vector(), vector(), vector()}};
}

/// E = 1/2 k w d^2, typed by hand: areas by cross products, the window as a product of cubics.
double energy_by_hand(const NodeAndTriangle& x, int side) {
    const auto& [a, b, c] = x.corner;
    const Vec3 area = (b - a).cross(c - a), n = area.normalized();
    const double gap = side * n.dot(x.node - a);
    if (gap >= thick) return 0.0;
    double window = 1.0;
    for (const auto& [p, q] : {std::pair{b, c}, std::pair{c, a}, std::pair{a, b}}) {
        const double share = n.dot((p - x.node).cross(q - x.node)) / area.norm();
        const double t = std::clamp((share + window_half_width) / (2.0 * window_half_width), 0.0, 1.0);
        window *= 3.0 * t * t - 2.0 * t * t * t;
    }
    return 0.5 * law_of_pair.stiffness * window * (thick - gap) * (thick - gap);
}

Vec3& point(NodeAndTriangle& x, int i) {
    return i == 0 ? x.node : x.corner[i - 1];
}

TEST(SelfContactLaw, ForcesAreTheDerivativeOfItsEnergy) {
    for (const int side : {1, -1}) {
        NodeAndTriangle x = over_edge;
        const OverTriangle at = over_triangle(x);
        ASSERT_GT(at.window, 0.1);
        ASSERT_LT(at.window, 0.95);
        SelfContactForce f = self_contact_force({law_of_pair.stiffness, 0.0, 0.0}, at, side,
                                                overlap_of(at, side, thick), random_motion(1));
        ASSERT_GT(f.energy, 1e-3 * thick * thick * law_of_pair.stiffness);
        EXPECT_NEAR(f.energy, energy_by_hand(x, side), 1e-12 * f.energy);
        EXPECT_EQ(f.dissipated, 0.0);
        // Over 1e-7 m of 0.1 m differences are right to 1e-10, of forces of newtons.
        const double h = 1e-7;
        for (int i = 0; i < 4; ++i)
            for (int c = 0; c < 3; ++c) {
                double& x_ic = point(x, i)[c];
                const double before = x_ic;
                x_ic = before + h;
                const double up = energy_by_hand(x, side);
                x_ic = before - h;
                const double down = energy_by_hand(x, side);
                x_ic = before;
                EXPECT_NEAR(point(f.on, i)[c], (down - up) / (2.0 * h), 1e-6) << i << ' ' << c << ' ' << side;
            }
    }
}

TEST(SelfContactLaw, ForcesHaveNeitherSumNorMoment) {
    for (unsigned seed = 0; seed < 20; ++seed) {
        NodeAndTriangle x = over_edge, v = random_motion(seed);
        const OverTriangle at = over_triangle(x);
        SelfContactForce f = self_contact_force(law_of_pair, at, 1, overlap_of(at, 1, thick), v);
        Vec3 sum = Vec3::Zero(), moment = sum;
        double power = 0.0;
        for (int i = 0; i < 4; ++i) {
            sum += point(f.on, i);
            moment += point(x, i).cross(point(f.on, i));
            power += point(f.on, i).dot(point(v, i));
        }
        EXPECT_LT(sum.norm(), 1e-14 * f.on.node.norm());
        EXPECT_LT(moment.norm(), 1e-14 * f.on.node.norm());
        // Power: that of the derivative of E, less what friction dissipates.
        SelfContactForce smooth =
            self_contact_force({law_of_pair.stiffness, 0.0, 0.0}, at, 1, overlap_of(at, 1, thick), v);
        for (int i = 0; i < 4; ++i)
            power -= point(smooth.on, i).dot(point(v, i));
        EXPECT_GT(f.dissipated, 0.0);
        EXPECT_NEAR(power, -f.dissipated, 1e-12 * f.dissipated);
    }
}

TEST(SelfContactLaw, NothingSlipsInARigidMotion) {
    NodeAndTriangle v;
    const Vec3 spin(0.3, -2.0, 5.0), drift(7.0, -1.0, 20.0);
    NodeAndTriangle x = over_edge;
    for (int i = 0; i < 4; ++i)
        point(v, i) = drift + spin.cross(point(x, i));
    const OverTriangle at = over_triangle(x);
    const SelfContactForce f = self_contact_force(law_of_pair, at, 1, overlap_of(at, 1, thick), v);
    EXPECT_GT(f.normal, 0.0);
    // Friction is below c |slip|; sums and products of 40 m/s round to 1e-13 m/s.
    EXPECT_LT(f.dissipated, law_of_pair.viscosity * 1e-26);
}

TEST(SelfContactLaw, FrictionIsCoulombsWhereSlipIsFastAndViscousWhereItIsSlow) {
    // In the middle of a triangle in the plane z = 0, 4 mm above it: N = k 6 mm.
    const NodeAndTriangle x{Vec3(0.1, 0.05, 0.004), {Vec3(0, 0, 0), Vec3(0.2, 0, 0), Vec3(0.1, 0.15, 0)}};
    const OverTriangle at = over_triangle(x);
    EXPECT_DOUBLE_EQ(at.window, 1.0);
    const double normal = 800.0 * 0.006;
    for (const double speed : {1e-4, 0.1, 100.0}) {
        NodeAndTriangle v{Vec3(speed, 0.0, -3.0), {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()}};
        const SelfContactForce f = self_contact_force(law_of_pair, at, 1, overlap_of(at, 1, thick), v);
        EXPECT_NEAR(f.on.node.z(), normal, 1e-12);
        EXPECT_NEAR(f.normal, normal, 1e-12);
        const double slow = law_of_pair.friction * normal / law_of_pair.viscosity;  // 0.72 m/s
        EXPECT_NEAR(f.on.node.x(), -0.3 * normal * speed / std::hypot(speed, slow), 1e-12);
        EXPECT_NEAR(f.dissipated, -f.on.node.x() * speed, 1e-12);
        if (speed == 100.0) {
            EXPECT_NEAR(f.on.node.x(), -0.3 * normal, 1e-4 * normal);
        }
        if (speed == 1e-4) {
            EXPECT_NEAR(f.on.node.x(), -2.0 * speed, 1e-7 * speed);
        }
    }
}

TEST(SelfContactLaw, NeighboursOnAFlatSheetHandOverAtTheSameForce) {
    // Two triangles of equal height on either side of x = 0: from one to the other the force on the node
    // stays k d along the normal.
    const Vec3 a(0, -0.1, 0), b(0, 0.1, 0);
    for (double along = -0.04; along <= 0.04; along += 0.01) {
        Vec3 force = Vec3::Zero();
        for (const double tip : {-0.15, 0.15}) {
            NodeAndTriangle x{Vec3(along, 0.01, 0.004), {a, b, Vec3(tip, 0, 0)}};
            if (tip > 0) std::swap(x.corner[0], x.corner[1]);
            const OverTriangle at = over_triangle(x);
            const int side = at.normal.z() > 0 ? 1 : -1;
            if (at.window > 0)
                force += self_contact_force({800.0, 0.0, 0.0}, at, side, overlap_of(at, side, thick),
                                            random_motion(1))
                             .on.node;
        }
        EXPECT_LT((force - Vec3(0, 0, 4.8)).norm(), 1e-12) << along;
    }
}

TEST(SelfContactLaw, TangentBoundsTheSecondDerivative) {
    std::mt19937 generator(3);
    std::uniform_real_distribution<double> one(0.0, 1.0);
    double closest = 0.0;
    for (int trial = 0; trial < 300; ++trial) {
        NodeAndTriangle x = over_edge;
        const double p = 1.3 * one(generator) - 0.15, q = 1.3 * one(generator) - 0.15;
        x.node = x.corner[0] + p * (x.corner[1] - x.corner[0]) + q * (x.corner[2] - x.corner[0]) +
                 (2.0 * one(generator) - 1.0) * thick * over_triangle(x).normal;
        const OverTriangle at = over_triangle(x);
        if (at.window <= 0.0 || overlap_of(at, 1, thick) <= 0.0) continue;
        const auto force = [&](const Vec3& node) {
            NodeAndTriangle moved = x;
            moved.node = node;
            const OverTriangle there = over_triangle(moved);
            return self_contact_force({800.0, 0.0, 0.0}, there, 1, overlap_of(there, 1, thick), x).on.node;
        };
        Eigen::Matrix3d tangent;
        const double h = 1e-7;
        for (int c = 0; c < 3; ++c)
            tangent.col(c) =
                (force(x.node + h * Vec3::Unit(c)) - force(x.node - h * Vec3::Unit(c))) / (2.0 * h);
        double steepest = 0.0;
        for (const Vec3& gradient : at.gradient)
            steepest = std::max(steepest, gradient.norm());
        const double bound = self_contact_tangent(800.0, overlap_of(at, 1, thick), steepest);
        const double norm = tangent.norm();
        EXPECT_LT(norm, bound * 1.0000001);
        closest = std::max(closest, norm / bound);
    }
    EXPECT_GT(closest, 0.3);  // no bound far from what it bounds
}

// --- pairs side by side ---------------------------------------------------------------------------

/// Nodes and triangles that lie anywhere within 20 cm, as many as make up some groups of any width and a part
/// of one: pushed and not, over and beside, on the wrong side and without one, slivers.
struct Jumble {
    static constexpr std::size_t count = 70;
    static constexpr double fullness_of_sliver = 0.1, most = 0.03, viscosity = 2.0;

    explicit Jumble(int lanes_of_group) : lanes(static_cast<std::size_t>(lanes_of_group)) {
        std::mt19937 generator(11);
        std::uniform_real_distribution<double> one(-0.1, 0.1);
        const auto vector = [&](double scale) {
            return Vec3(scale * one(generator), scale * one(generator), scale * one(generator));
        };
        const std::size_t groups = (count + lanes - 1) / lanes;
        node.assign(4 * groups * lanes, 0);
        number.assign(self_contact::pair_numbers * groups * lanes, 0.0);
        for (std::size_t k = 0; k < groups * lanes; ++k) {
            set(k, self_contact::fullness, infinity);
            if (k >= count) continue;
            NodeAndTriangle at{Vec3::Zero(), {vector(1.0), vector(1.0), vector(1.0)}};
            at.node = (at.corner[0] + at.corner[1] + at.corner[2]) / 3.0 + vector(k % 2 == 0 ? 0.2 : 1.0);
            x.push_back(at);
            v.push_back({vector(30.0), {vector(30.0), vector(30.0), vector(30.0)}});
            side.push_back(static_cast<int>(k % 3) - 1);
            thickness.push_back(0.005 + 0.1 * std::abs(one(generator)));
            for (int i = 0; i < 4; ++i) {
                node[(k / lanes * 4 + i) * lanes + k % lanes] =
                    static_cast<std::int32_t>(records.size() * sizeof(NodeVector));
                records.push_back({to_lanes(point(x.back(), i)), to_lanes(point(v.back(), i))});
            }
            set(k, self_contact::fullness, fullness_of_sliver);
            set(k, self_contact::most_thickness, most);
            set(k, self_contact::slow_viscosity, viscosity);
            set(k, self_contact::kept_side, side.back());
            set(k, self_contact::kept_thickness, thickness.back());
        }
        force.resize(records.size(), {splat(0.0)});
    }
    void set(std::size_t k, self_contact::PairNumber which, double value) {
        number[(k / lanes * self_contact::pair_numbers + which) * lanes + k % lanes] = value;
    }
    self_contact::Pairs pairs() const { return {node.size() / (4 * lanes), node.data(), number.data()}; }
    const double* record() const { return reinterpret_cast<const double*>(records.data()); }
    static double longest_edge(const NodeAndTriangle& at) {
        const auto& c = at.corner;
        return std::max({(c[1] - c[0]).norm(), (c[2] - c[1]).norm(), (c[0] - c[2]).norm()});
    }
    bool is_sliver(std::size_t k) const {
        return over_triangle(x[k]).twice_area <= fullness_of_sliver * std::pow(longest_edge(x[k]), 2);
    }

    std::size_t lanes;
    std::vector<NodeAndTriangle> x, v;
    std::vector<int> side;
    std::vector<double> thickness;
    std::vector<NodeRecord> records;
    std::vector<NodeVector> force;
    std::vector<std::int32_t> node;
    std::vector<double> number;
};

TEST(SelfContactKernels, PushAsTheLawDoesPairByPair) {
    for (const self_contact::Kernels& kernels : self_contact::all_kernels()) {
        SCOPED_TRACE(kernels.instruction_set);
        Jumble jumble(kernels.lanes);
        std::vector<std::uint32_t> attention(jumble.pairs().groups);
        const self_contact::Pushed pushed =
            kernels.push(jumble.record(), reinterpret_cast<double*>(jumble.force.data()), jumble.pairs(),
                         {law_of_pair.stiffness, law_of_pair.friction}, attention.data());
        double dissipated = 0.0, deepest = 0.0;
        int pushing = 0, attended = 0, slivers = 0;
        for (std::size_t k = 0; k < Jumble::count; ++k) {
            const OverTriangle at = over_triangle(jumble.x[k]);
            const int side = jumble.side[k];
            const double gap = side * at.gap, overlap = overlap_of(at, side, jumble.thickness[k]);
            const double thickest = std::min(Jumble::most, 0.25 * Jumble::longest_edge(jumble.x[k]));
            const bool sliver = jumble.is_sliver(k), open = !sliver && at.window > 0.0;
            const bool pushes = open && side != 0 && overlap > 0.0;
            // Sides are taken and lost, thickness grows, where nothing pushes.
            const bool wants = side == 0
                                   ? open && std::abs(at.gap) > 1e-3 * thickest
                                   : !open || (!pushes && std::min(thickest, gap) > jumble.thickness[k]);
            EXPECT_EQ(attention[k / jumble.lanes] >> (k % jumble.lanes) & 1U, wants ? 1U : 0U) << k;
            slivers += sliver, attended += wants, pushing += pushes;
            SelfContactForce f{};
            for (int i = 0; i < 4; ++i)
                point(f.on, i) = Vec3::Zero();
            if (pushes) {
                f = self_contact_force(law_of_pair, at, side, overlap, jumble.v[k]);
                if (at.window > 0.5) deepest = std::max(deepest, -gap / Jumble::most);
            }
            dissipated += f.dissipated;
            // Rounding, and a sliver's gradients.
            for (int i = 0; i < 4; ++i)
                EXPECT_LT((to_vec3(jumble.force[4 * k + i].value) - point(f.on, i)).norm(),
                          1e-12 * f.on.node.norm() + 1e-13)
                    << k;
        }
        EXPECT_GT(pushing, 10);
        EXPECT_GT(attended, 10);
        EXPECT_GT(slivers, 2);
        EXPECT_GT(deepest, 0.0);
        EXPECT_NEAR(pushed.dissipated, dissipated, 1e-12 * dissipated);
        EXPECT_NEAR(pushed.deepest, deepest, 1e-12 * deepest);
    }
}

TEST(SelfContactKernels, NeverMeasureMoreThanTheDistance) {
    for (const self_contact::Kernels& kernels : self_contact::all_kernels()) {
        SCOPED_TRACE(kernels.instruction_set);
        const Jumble jumble(kernels.lanes);
        const std::size_t slots = jumble.pairs().groups * jumble.lanes;
        std::vector<double> distance(slots), gap(slots);
        kernels.measure(jumble.record(), jumble.pairs(), distance.data(), gap.data());
        double tightest = 0.0;
        for (std::size_t k = 0; k < Jumble::count; ++k) {
            if (jumble.is_sliver(k)) {
                EXPECT_EQ(distance[k], 0.0);
                continue;
            }
            const NodeAndTriangle& at = jumble.x[k];
            EXPECT_NEAR(gap[k], over_triangle(at).gap, 1e-14);
            // The nearest of many points of the triangle over which the window is open.
            const double e = window_half_width;
            double nearest = infinity;
            constexpr int fine = 200;
            for (int i = 0; i <= fine; ++i)
                for (int j = 0; i + j <= fine; ++j) {
                    const double b1 = (1.0 + 3.0 * e) * i / fine - e, b2 = (1.0 + 3.0 * e) * j / fine - e;
                    const Vec3 p = (1.0 - b1 - b2) * at.corner[0] + b1 * at.corner[1] + b2 * at.corner[2];
                    nearest = std::min(nearest, (at.node - p).norm());
                }
            EXPECT_LT(distance[k], nearest + 1e-14) << k;
            tightest = std::max(tightest, distance[k] / nearest);
        }
        EXPECT_GT(tightest, 0.99);  // beside an edge it is the distance
    }
}

TEST(SelfContactKernels, FindTheNodeThatHasGoneFarthest) {
    for (const self_contact::Kernels& kernels : self_contact::all_kernels()) {
        SCOPED_TRACE(kernels.instruction_set);
        const Jumble jumble(kernels.lanes);
        const std::size_t nodes = jumble.records.size() - 3;  // the last of them fills up a group
        const std::size_t count = (nodes + jumble.lanes - 1) / jumble.lanes * jumble.lanes;
        const Vec3 centre(0.02, -0.03, 0.5), drift(0.3, 0.2, 0.1);
        LinearMotion motion;
        motion.stretch << 1.1, 0.2, -0.1, 0.3, 0.9, 0.05, -0.2, 0.4, 1.3;
        const Eigen::Matrix3d back = motion.stretch.inverse();
        std::vector<double> before(4 * count, 1.0);
        for (std::size_t i = 0; i < count; ++i) {
            const Vec3 x = back * (to_vec3(jumble.records[std::min(i, nodes - 1)].x) - drift);
            for (std::size_t c = 0; c < 3; ++c)
                before[c * count + i] = x[static_cast<Eigen::Index>(c)];
        }
        const auto farthest = [&](const Vec3& now) {
            motion.centre = now;
            return kernels.farthest(jumble.record(), before.data(), count, nodes - 1, motion);
        };
        EXPECT_NEAR(farthest(drift), 0.0, 1e-30);
        EXPECT_NEAR(farthest(centre), (drift - centre).squaredNorm(), 1e-15);
        before[count + nodes / 2] += 1.0;  // one of them, by y
        const double farther = motion.stretch.col(1).squaredNorm();
        EXPECT_NEAR(farthest(drift), farther, 1e-14);
        before[3 * count + nodes / 2] = 0.5;
        EXPECT_NEAR(farthest(drift), 0.25 * farther, 1e-14);
        before[nodes / 3] = std::nan("");
        EXPECT_TRUE(std::isnan(farthest(drift)));
    }
}

TEST(TriangleBins, FindEveryBoxThatHoldsAPoint) {
    std::mt19937 generator(5);
    std::uniform_real_distribution<double> one(0.0, 1.0);
    const auto vector = [&] { return Vec3(3.0 * one(generator), one(generator), 0.2 * one(generator)); };
    std::vector<Box> boxes;
    for (int k = 0; k < 200; ++k) {
        const Vec3 low = vector();
        boxes.push_back({low, low + 0.6 * vector()});
    }
    const TriangleBins bins(boxes);
    int held = 0;
    for (int k = 0; k < 500; ++k) {
        const Vec3 x = 1.2 * vector() - Vec3::Constant(0.02);  // some of them outside of all
        std::vector<std::int32_t> expected, found;
        for (std::size_t t = 0; t < boxes.size(); ++t)
            if (boxes[t].holds(x)) expected.push_back(static_cast<std::int32_t>(t));
        bins.each_that_holds(x, [&](std::int32_t t) { found.push_back(t); });
        EXPECT_EQ(found, expected);
        held += static_cast<int>(found.size());
    }
    EXPECT_GT(held, 500);
}

}  // namespace
}  // namespace twinchute::fullsim
