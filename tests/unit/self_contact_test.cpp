// Self-contact of fabric: its law beside the same typed by hand, and sheets that meet.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <filesystem>
#include <functional>
#include <random>
#include <set>
#include <span>

#include "fullsim/forces/registry.hpp"
#include "fullsim/forces/self_contact.hpp"
#include "fullsim/forces/self_contact_kernels.hpp"
#include "fullsim/forces/triangle_bins.hpp"
#include "fullsim/laws/self_contact.hpp"
#include "fullsim/serialize_state.hpp"
#include "fullsim/simulation.hpp"
#include "fullsim/time/energy.hpp"
#include "lib/scene/read_scene.hpp"
#include "lib/scene/scene_error.hpp"
#include "tests/support/c9_scene.hpp"
#include "tests/support/small_parachute.hpp"

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
    EXPECT_LT(slip_of(over_triangle(x), v).norm(), 1e-13);
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

// --- sheets ----------------------------------------------------------------------------------------

/// Square sheets of one fabric, one after the other, and a payload far away that belongs to none.
class Sheets {
public:
    explicit Sheets(double friction, double modulus = 4e7) : friction_(friction) {
        mesh.fabric.density = 500.0;
        mesh.fabric.youngs_modulus = modulus;
        mesh.fabric.poisson_ratio = 0.14;
        mesh.fabric.thickness = 1e-4;
        for (Cord& cord : mesh.cords)
            cord = {};
    }
    /// across x along squares of `cell` [m], from `corner`, in the directions u and v.
    void add(int across, int along, double cell, const Vec3& corner, const Vec3& u, const Vec3& v) {
        const auto first = static_cast<NodeIndex>(mesh.position.size());
        for (int j = 0; j <= along; ++j)
            for (int i = 0; i <= across; ++i)
                mesh.position.push_back(corner + cell * i * u + cell * j * v);
        const auto node = [&](int i, int j) { return first + j * (across + 1) + i; };
        const auto triangle = [&](NodeIndex a, NodeIndex b, NodeIndex c) {
            mesh.triangles.push_back(
                laid_flat({a, b, c}, {mesh.position[a], mesh.position[b], mesh.position[c]}));
        };
        for (int j = 0; j < along; ++j)
            for (int i = 0; i < across; ++i) {
                triangle(node(i, j), node(i + 1, j), node(i + 1, j + 1));
                triangle(node(i, j), node(i + 1, j + 1), node(i, j + 1));
            }
        firsts.push_back(first);
    }
    /// others: nodes that belong to no sheet.
    void finish(std::span<const Vec3> others = {}) {
        mesh.canopy_nodes = static_cast<int>(mesh.position.size());
        mesh.position.insert(mesh.position.end(), others.begin(), others.end());
        mesh.position.emplace_back(0.0, 0.0, -50.0);
        firsts.push_back(mesh.canopy_nodes);
        mesh.tributary_area.assign(mesh.canopy_nodes, 0.0);
        for (const Triangle& t : mesh.triangles)
            for (const NodeIndex i : t.node)
                mesh.tributary_area[i] += t.area() / 3.0;
        lump_masses(mesh, 1.0);
        state = test::state_of(mesh);
        state.added_mass = 0.0;
        constants = node_constants(mesh, 0.0);
        update_sums(state, constants);
        structure.push_back(make_membrane(mesh, 0.0));
        structure.push_back(make_self_contact(mesh, friction_));
        state.energy.kinetic_start = kinetic_energy(state, constants);
    }
    void launch(std::size_t sheet, const std::function<Vec3(const Vec3&)>& velocity) {
        for (NodeIndex i = firsts[sheet]; i < firsts[sheet + 1]; ++i) {
            state.node[i].v = to_lanes(velocity(mesh.position[i]));
            state.v_half[i].value = state.node[i].v;
        }
        update_sums(state, constants);
        state.energy.kinetic_start = kinetic_energy(state, constants);
    }
    /// Makes a sheet as heavy as a table.
    void hold(std::size_t sheet) {
        constexpr double heavy = 1e6;  // [kg] a node
        for (NodeIndex i = firsts[sheet]; i < firsts[sheet + 1]; ++i) {
            constants.canopy_mass += heavy - constants.mass[i];
            constants.system_mass += heavy - constants.mass[i];
            constants.mass[i] = heavy;
        }
        update_sums(state, constants);
    }
    /// Steps of half the bound, which is renewed as in a run, up to `time`.
    void run(double time, const std::function<void(State&)>& others = {}) {
        while (state.time < time) {
            if (state.step % 20 == 0) dt_ = 0.5 * critical();
            step(dt_, others);
        }
    }
    /// One step with other forces beside those of the blocks.
    void step(double dt, const std::function<void(State&)>& others = {}) {
        for (const auto& block : structure)
            block->add_forces(state);
        if (others) others(state);
        advance(state, constants, dt, 0.0);
        state.time += dt;
    }
    double mass(std::size_t sheet) const {
        double sum = 0.0;
        for (NodeIndex i = firsts[sheet]; i < firsts[sheet + 1]; ++i)
            sum += mesh.mass[i];
        return sum;
    }
    Vec3 mean(std::size_t sheet, bool velocity = false) const {
        Vec3 sum = Vec3::Zero();
        for (NodeIndex i = firsts[sheet]; i < firsts[sheet + 1]; ++i)
            sum += mesh.mass[i] * to_vec3(velocity ? state.v_half[i].value : state.node[i].x);
        return sum / mass(sheet);
    }
    Vec3 momentum() const {
        Vec3 sum = Vec3::Zero();
        for (NodeIndex i = 0; i < mesh.node_count(); ++i)
            sum += mesh.mass[i] * to_vec3(state.v_half[i].value);
        return sum;
    }
    /// As the scheme conserves it: with velocities of half steps.
    Vec3 angular_momentum() const {
        Vec3 sum = Vec3::Zero();
        for (NodeIndex i = 0; i < mesh.node_count(); ++i)
            sum += mesh.mass[i] * to_vec3(state.node[i].x).cross(to_vec3(state.v_half[i].value));
        return sum;
    }
    /// Puts a node there, at that velocity.
    void put(NodeIndex i, const Vec3& x, const Vec3& v) {
        state.node[i] = {to_lanes(x), to_lanes(v)};
        state.v_half[i].value = state.node[i].v;
    }
    /// Contact of nodes that were put somewhere `dt` [s] later.
    void see_to_contact(double dt) {
        state.time += dt;
        update_sums(state, constants);
        structure.back()->add_forces(state);
    }
    double critical() const { return fullsim::critical_step(state, constants, structure, {}, {}).dt; }

    Mesh mesh;
    std::vector<NodeIndex> firsts;
    State state;
    NodeConstants constants;
    ForceModels structure;

private:
    double friction_, dt_ = 0.0;
};

/// Two sheets of 0.6 m, 3 cm apart, that fly at each other at 1 m/s each, turned against each other and
/// sliding: with different meshes, so that no node meets a node.
Sheets meeting_sheets(double friction, const Eigen::Matrix3d& turn = Eigen::Matrix3d::Identity()) {
    Sheets two(friction);
    const Vec3 x = turn * Vec3::UnitX(), y = turn * Vec3::UnitY(), z = turn * Vec3::UnitZ();
    const Vec3 u = (std::cos(0.3) * x + std::sin(0.3) * y), v = z.cross(u);
    two.add(6, 6, 0.1, Vec3(turn * Vec3(0.0, 0.0, 0.0)), x, y);
    two.add(5, 5, 0.12, Vec3(turn * Vec3(0.11, -0.13, 0.03)), u, v);
    two.finish();
    two.launch(0, [&](const Vec3& at) { return Vec3(turn * Vec3(0.0, 0.0, 1.0) + z.cross(at)); });
    two.launch(1, [&](const Vec3&) { return Vec3(turn * Vec3(0.5, 0.2, -1.0)); });
    return two;
}

TEST(SelfContact, SheetsThatMeetKeepMomentumAndAngularMomentum) {
    Sheets two = meeting_sheets(0.3);
    const double dt = 0.5 * two.critical();
    const Vec3 momentum = two.momentum(), angular = two.angular_momentum();
    double most = 0.0, deepest = 0.0;
    while (two.state.time < 0.06) {
        two.step(dt);
        most = std::max(most, two.structure[1]->energy(two.state));
        deepest = std::max(deepest, two.state.contact.deepest);
    }
    const double kinetic = two.state.energy.kinetic_start;
    EXPECT_GT(most, 0.05 * kinetic);        // they have met,
    EXPECT_GT(two.mean(1, true).z(), 0.3);  // thrown each other back
    EXPECT_LT(two.mean(0, true).z(), -0.3);
    EXPECT_GT(two.state.energy.damping, 0.01 * kinetic);  // and rubbed
    EXPECT_LT((two.momentum() - momentum).norm(), 1e-10 * momentum.norm());
    EXPECT_LT((two.angular_momentum() - angular).norm(), 1e-10 * angular.norm());
    EXPECT_EQ(two.state.contact.passed, 0);
    EXPECT_LT(deepest, 0.1);
}

TEST(SelfContact, EnergyOfSheetsThatMeetAddsUp) {
    // The scheme's error falls with the square of the step while the sheets touch.
    double before = 0.0;
    for (const double share : {0.5, 0.25}) {
        Sheets two = meeting_sheets(0.3);
        const double dt = share * two.critical();
        double worst = 0.0;
        while (two.state.time < 0.06) {
            two.step(dt);
            const EnergyLedger ledger = energy_ledger(two.state, kinetic_energy(two.state, two.constants),
                                                      elastic_energy(two.state, two.structure));
            worst = std::max(worst, std::abs(residual(ledger)));
        }
        worst /= two.state.energy.kinetic_start;
        EXPECT_LT(worst, 0.05);
        if (before > 0.0) {
            EXPECT_LT(worst, 0.5 * before);
        }
        before = worst;
    }
}

TEST(SelfContact, TurnsWithTheWorld) {
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    Sheets one = meeting_sheets(0.3), other = meeting_sheets(0.3, turn);
    const double dt = 0.5 * one.critical();
    while (one.state.time < 0.025) {
        one.step(dt);
        other.step(dt);
    }
    double worst = 0.0;
    for (NodeIndex i = 0; i < one.mesh.canopy_nodes; ++i)
        worst =
            std::max(worst, (turn * to_vec3(one.state.node[i].x) - to_vec3(other.state.node[i].x)).norm());
    // Round-off of 1e-16 grows with the folds of the sheets: 50 ms of them leave nine digits.
    EXPECT_LT(worst, 1e-9);
}

TEST(SelfContact, PressedSheetsCarryThePressureAndStayApart) {
    // 300 Pa on the upper of two sheets, the lower one as heavy as a table: the force between both is p S.
    Sheets two(0.0, 4e8);
    two.add(8, 8, 0.1, Vec3(-0.1, -0.1, 0.0), Vec3::UnitX(), Vec3::UnitY());
    two.add(5, 5, 0.11, Vec3(0.03, 0.02, 0.002), Vec3::UnitX(), Vec3::UnitY());
    two.finish();
    two.hold(0);
    const double pressure = 300.0, area = 0.55 * 0.55;
    const auto press = [&](State& state) {
        for (NodeIndex i = two.firsts[1]; i < two.firsts[2]; ++i) {
            state.force[i].value[2] -= pressure * two.mesh.tributary_area[i];
            state.force[i].value -= 40.0 * two.mesh.mass[i] * state.node[i].v;  // settles
        }
    };
    // Closer than their thickness they begin without a force.
    two.structure[1]->add_forces(two.state);
    EXPECT_EQ(two.structure[1]->energy(two.state), 0.0);
    for (std::size_t i = 0; i < two.state.force.size(); ++i)
        EXPECT_EQ(to_vec3(two.state.force[i].value).norm(), 0.0);
    two.run(0.6, press);
    clear_forces(two.state);
    two.structure[1]->add_forces(two.state);
    double held = 0.0, lowest = 1.0;
    for (NodeIndex i = two.firsts[1]; i < two.firsts[2]; ++i) {
        held += two.state.force[i].value[2];
        lowest = std::min(lowest, two.state.node[i].x[2]);
    }
    EXPECT_NEAR(held, pressure * area, 1e-3 * pressure * area);
    EXPECT_EQ(two.state.contact.passed, 0);
    EXPECT_LT(two.state.contact.deepest, 0.1);
}

/// A strip of 0.3 x 0.2 m on a table, under gravity at `angle` to its normal, sliding at v0: x [m] over time.
struct Slide {
    double distance, speed, dissipated, mass;
};
Slide slide(double friction, double angle, double v0, double time) {
    constexpr double g = 9.80665;
    Sheets two(friction);
    two.add(14, 5, 0.1, Vec3(-0.1, -0.15, 0.0), Vec3::UnitX(), Vec3::UnitY());
    two.add(3, 2, 0.1, Vec3(0.03, 0.02, 0.002), Vec3::UnitX(), Vec3::UnitY());
    two.finish();
    two.hold(0);
    const auto weigh = [&](State& state) {
        for (NodeIndex i = two.firsts[1]; i < two.firsts[2]; ++i)
            state.force[i].value +=
                two.mesh.mass[i] * to_lanes(g * Vec3(std::sin(angle), 0.0, -std::cos(angle)));
    };
    two.launch(1, [&](const Vec3&) { return Vec3(v0, 0.0, 0.0); });
    const double from = two.mean(1).x();
    two.run(time, weigh);
    EXPECT_EQ(two.state.contact.passed, 0);
    return {two.mean(1).x() - from, two.mean(1, true).x(), two.state.energy.damping, two.mass(1)};
}

TEST(SelfContact, AStripStopsAfterTheDistanceOfItsFriction) {
    const double v0 = 2.0, mu = 0.3, g = 9.80665, distance = v0 * v0 / (2.0 * mu * g);
    const Slide s = slide(mu, 0.0, v0, 1.2 * v0 / (mu * g));
    // What falls short of Coulomb below mu N/c, some mm/s, lengthens the way by less than a per cent.
    EXPECT_NEAR(s.distance, distance, 0.01 * distance);
    EXPECT_LT(std::abs(s.speed), 0.01);
    EXPECT_NEAR(s.dissipated, 0.5 * s.mass * v0 * v0, 0.01 * 0.5 * s.mass * v0 * v0);
}

TEST(SelfContact, AStripSlidesDownAnInclineAsItsFrictionLetsIt) {
    const double mu = 0.3, g = 9.80665, steep = std::atan(0.6), time = 0.6;
    const Slide s = slide(mu, steep, 0.0, time);
    const double acceleration = g * (std::sin(steep) - mu * std::cos(steep));
    EXPECT_NEAR(s.speed, acceleration * time, 0.01 * acceleration * time);
    EXPECT_NEAR(s.distance, 0.5 * acceleration * time * time, 0.02 * 0.5 * acceleration * time * time);
    // Below the angle of friction it stays, but for a creep at g sin(angle) m/c.
    const Slide at_rest = slide(mu, std::atan(0.15), 0.0, 0.6);
    EXPECT_LT(at_rest.speed, 0.01);
}

TEST(SelfContact, CoincidentSheetsStartWithoutForceAndStayOnTheSideTheyTake) {
    Sheets two(0.2);
    two.add(5, 5, 0.1, Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY());
    two.add(5, 5, 0.1, Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY());
    two.finish();
    two.structure[1]->add_forces(two.state);
    for (std::size_t i = 0; i < two.state.force.size(); ++i)
        EXPECT_EQ(to_vec3(two.state.force[i].value).norm(), 0.0);
    // One leaves upwards, and comes back: it ends above.
    two.launch(1, [](const Vec3&) { return Vec3(0.0, 0.0, 0.5); });
    double highest = 0.0;
    two.run(0.2, [&](State& state) {
        for (NodeIndex i = two.firsts[1]; i < two.firsts[2]; ++i)
            state.force[i].value[2] -= 10.0 * two.mesh.mass[i];
        highest = std::max(highest, two.mean(1).z() - two.mean(0).z());
    });
    EXPECT_GT(highest, 0.01);
    EXPECT_GT(two.mean(1).z(), two.mean(0).z());
    EXPECT_EQ(two.state.contact.passed, 0);
    EXPECT_LT(two.state.contact.deepest, 0.1);
}

// --- in a run --------------------------------------------------------------------------------------

Scene coarse_scene() {
    Scene scene = test::c9_scene();
    scene.full.contact = Contact::self;
    scene.full.contact_friction = 0.2;
    scene.full.mesh = {2, 7, 6, 2};
    return scene;
}

void take_steps(Simulation& simulation, int count) {
    for (int k = 0; k < count; ++k) {
        simulation.evaluate_forces();
        simulation.step_to(1.0);
    }
}

TEST(SelfContact, ARunGoesOnToTheSameBitsWithAnyNumberOfThreads) {
    const Scene scene = coarse_scene();
    Simulation whole(scene);
    EXPECT_EQ(whole.layout().name(), "gore-batched");
    take_steps(whole, 1500);
    Archive out;
    whole.serialize(out);
    const std::string bytes = out.take();
    Simulation resumed(scene, [](const Scene& s, const Mesh& mesh, const NodeConstants& constants) {
        return make_layout(s, mesh, constants, 2);
    });
    Archive in(bytes, "a test");
    resumed.serialize(in);
    in.end();
    ASSERT_GT(resumed.system().contact.pairs.size(), 0u);
    const auto searches = whole.system().contact.searches;
    EXPECT_EQ(whole.system().contact.looked_at, resumed.system().contact.looked_at);
    EXPECT_EQ(whole.system().contact.velocity_gradient, resumed.system().contact.velocity_gradient);
    EXPECT_GT(resumed.system().contact.velocity_gradient.norm(), 0.1);
    take_steps(whole, 1);
    take_steps(resumed, 1);
    EXPECT_EQ(whole.system().contact.awake.index, resumed.system().contact.awake.index);
    EXPECT_EQ(whole.system().contact.awake.number, resumed.system().contact.awake.number);
    take_steps(whole, 1500);
    take_steps(resumed, 1500);
    EXPECT_GT(whole.system().contact.searches, searches);  // pairs have been found anew in between
    EXPECT_EQ(whole.system().contact.searches, resumed.system().contact.searches);
    EXPECT_EQ(whole.unknowns(), resumed.unknowns());
    EXPECT_EQ(whole.system().energy.damping, resumed.system().energy.damping);
}

TEST(SelfContact, PairsThatSleepDoNotTouch) {
    const Scene scene = coarse_scene();
    Simulation simulation(scene);
    const Mesh& mesh = simulation.mesh();
    std::int64_t asleep = 0, held = 0;
    for (int look = 0; look < 300; ++look) {
        take_steps(simulation, 7);
        simulation.evaluate_forces();
        const State& s = simulation.synchronised_state();
        std::vector<bool> awake(s.contact.pairs.size());
        for (const std::int32_t k : s.contact.awake.index)
            awake[k] = true;
        for (std::size_t k = 0; k < awake.size(); ++k) {
            const NearPair& pair = s.contact.pairs[k];
            if (awake[k]) continue;
            ++asleep;
            if (pair.side == 0) continue;
            const auto& n = mesh.triangles[pair.triangle].node;
            const auto x = [&](NodeIndex i) { return to_vec3(s.node[i].x); };
            const OverTriangle at = over_triangle({x(pair.node), {x(n[0]), x(n[1]), x(n[2])}});
            const bool touches = at.window > 0.0 && overlap_of(at, pair.side, pair.thickness) > 0.0;
            EXPECT_FALSE(touches) << pair.node << ' ' << pair.triangle << ' ' << s.time;
            ++held;
        }
        simulation.step_to(1.0);
    }
    EXPECT_GT(asleep, 1000);
    EXPECT_GT(held, 100);
}

/// Two sheets that lie 5 cm apart, with other nodes.
Sheets parted_sheets(std::span<const Vec3> others) {
    Sheets two(0.0);
    two.add(6, 6, 0.1, Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY());
    two.add(5, 5, 0.12, Vec3(0.013, 0.017, 0.05), Vec3::UnitX(), Vec3::UnitY());
    two.finish(others);
    return two;
}

/// Every pair of a node and a triangle of another sheet that touch is awake. Returns how many do.
int expect_awake_where_they_touch(const Sheets& sheets) {
    const Mesh& mesh = sheets.mesh;
    const SelfContactState& contact = sheets.state.contact;
    const auto x = [&](NodeIndex i) { return to_vec3(sheets.state.node[i].x); };
    std::set<std::pair<NodeIndex, std::int32_t>> awake;
    for (const std::int32_t k : contact.awake.index)
        awake.emplace(contact.pairs[k].node, contact.pairs[k].triangle);
    int touches = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Triangle& triangle = mesh.triangles[t];
        const bool second = triangle.node[0] >= sheets.firsts[1];
        for (NodeIndex i = 0; i < mesh.payload(); ++i) {
            if (mesh.is_canopy(i) && (i >= sheets.firsts[1]) == second) continue;
            const auto& n = triangle.node;
            const OverTriangle at = over_triangle({x(i), {x(n[0]), x(n[1]), x(n[2])}});
            // The thickness of docs/theory/full-model.md.
            if (!(at.window > 0.0) || std::abs(at.gap) > 0.03 * std::sqrt(triangle.a * triangle.c)) continue;
            ++touches;
            EXPECT_TRUE(awake.contains({i, static_cast<std::int32_t>(t)}))
                << i << ' ' << t << ' ' << sheets.state.time;
        }
    }
    return touches;
}

TEST(SelfContact, MissesNoPairThatTouches) {
    // Sheets that are stretched, turned and crumpled through each other, and, every other time, four nodes
    // that shoot through them from afar.
    std::mt19937 generator(3);
    std::uniform_real_distribution<double> one(-1.0, 1.0);
    const auto random = [&] { return Vec3(one(generator), one(generator), one(generator)); };
    std::vector<Vec3> afar;
    for (int k = 0; k < 4; ++k)
        afar.push_back(Vec3(0.3, 0.3, 0.0) + 0.7 * (2.0 + k) * random().normalized());
    Sheets sheets = parted_sheets(afar);
    const Mesh& mesh = sheets.mesh;
    const int steps_of_a_bout = 400;
    const double dt = 5e-4, pace = pi / (steps_of_a_bout * dt);
    int touches = 0;
    std::int64_t searches = 0;  // while no node shoots
    for (int bout = 0; bout < 8; ++bout) {
        const std::int64_t searches_before = sheets.state.contact.searches;
        Eigen::Matrix3d gradient;
        gradient << 0.4 * random(), 0.4 * random(), 0.4 * random();
        std::vector<Vec3> course;  // away from where each node was, and back
        for (NodeIndex i = 0; i < mesh.payload(); ++i) {
            const Vec3& x = mesh.position[i];
            if (mesh.is_canopy(i))
                course.emplace_back(gradient * x + 0.06 * random());
            else if (bout % 2 == 0)
                course.emplace_back(1.3 * (Vec3(0.3, 0.3, 0.0) + 0.25 * random() - x));
            else
                course.emplace_back(Vec3::Zero());
        }
        for (int k = 1; k <= steps_of_a_bout; ++k) {
            const double s = std::sin(pace * k * dt), rate = pace * std::cos(pace * k * dt);
            for (NodeIndex i = 0; i < mesh.payload(); ++i)
                sheets.put(i, mesh.position[i] + s * course[i], rate * course[i]);
            sheets.see_to_contact(dt);
            if (k % 3 == 0) touches += expect_awake_where_they_touch(sheets);
        }
        if (bout % 2 == 1) searches += sheets.state.contact.searches - searches_before;
    }
    EXPECT_GT(touches, 1000);
    EXPECT_LT(searches, 4 * steps_of_a_bout / 6);  // it does not always search
}

TEST(SelfContact, SeesSheetsThatAnEvenMotionBringsTogether) {
    // A third sheet stands upright: what lies flat has no motion that could be fitted to it across.
    Sheets sheets(0.0);
    sheets.add(6, 6, 0.1, Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY());
    sheets.add(5, 5, 0.12, Vec3(0.013, 0.017, 0.05), Vec3::UnitX(), Vec3::UnitY());
    sheets.add(8, 8, 0.15, Vec3(1.5, -0.3, -0.6), Vec3::UnitY(), Vec3::UnitZ());
    sheets.finish();
    const double dt = 1e-3, rate = 2.0;  // [1/s]
    int touches = 0;
    for (int k = 1; k <= 490; ++k) {
        for (NodeIndex i = 0; i < sheets.mesh.payload(); ++i) {
            const Vec3& x = sheets.mesh.position[i];
            const Vec3 v(0.0, 0.0, -rate * x.z());
            sheets.put(i, x + k * dt * v, v);
        }
        sheets.see_to_contact(dt);
        touches += expect_awake_where_they_touch(sheets);
    }
    EXPECT_GT(touches, 1000);
    EXPECT_LT(sheets.state.contact.searches, 10);
}

TEST(SelfContact, SeesANodeThatFliesThroughFabricFromAfar) {
    // Beside which nothing moves that could call for a search.
    const std::vector<Vec3> afar{{0.27, 0.31, 1.0}};
    Sheets sheets = parted_sheets(afar);
    const Vec3 v(0.0, 0.0, -2.0);
    const double dt = 5e-4;
    int touches = 0;
    for (int k = 1; k <= 1100; ++k) {
        sheets.put(sheets.mesh.canopy_nodes, afar.front() + k * dt * v, v);
        sheets.see_to_contact(dt);
        touches += expect_awake_where_they_touch(sheets);
    }
    EXPECT_GT(touches, 5);
    EXPECT_LT(sheets.state.contact.searches, 20);
}

TEST(SelfContact, NeitherAnEvenStretchNorANodeFarFromFabricIsSearchedFor) {
    const std::vector<Vec3> afar{{0.3, 0.3, 1.0}};
    Sheets sheets = parted_sheets(afar);
    Eigen::Matrix3d gradient;
    gradient << 1.0, 0.3, 0.0, -0.5, 0.8, 0.2, 0.1, 0.0, 0.5;  // [1/s]
    const double dt = 1e-3;
    for (int k = 1; k <= 50; ++k) {  // corners of the sheets go 4 cm, of a skin of 2 cm
        for (NodeIndex i = 0; i < sheets.mesh.payload(); ++i) {
            const Vec3& x = sheets.mesh.position[i];
            const Vec3 v = sheets.mesh.is_canopy(i) ? Vec3(gradient * x) : Vec3(0.0, 0.0, -5.0);
            sheets.put(i, x + k * dt * v, v);
        }
        sheets.see_to_contact(dt);
    }
    EXPECT_EQ(sheets.state.contact.searches, 1);
}

TEST(SelfContact, AsksForNoPlaceOfANodeThatSleeps) {
    // A layout that keeps nodes elsewhere hands over those that are awake: bits are those of a run in which
    // the records of all nodes are current in every step. Pleats are full triangles.
    Scene scene = coarse_scene();
    scene.full.mesh.gore_columns = 4;
    Simulation alone(scene), watched(scene);
    const ForceModels structure = make_structure(scene, alone.mesh(), alone.system().stage);
    const auto* contact = dynamic_cast<const SelfContact*>(find_block(structure, Block::self_contact));
    ASSERT_TRUE(contact);
    const auto nodes = static_cast<std::size_t>(alone.mesh().payload());
    const auto push_awake = [&](State& state) {
        clear_forces(state);
        contact->push_awake(state);
        std::vector<Vec3> forces;
        for (std::size_t i = 0; i < nodes; ++i)
            forces.push_back(to_vec3(state.force[i].value));
        return forces;
    };
    /// As SelfContact::sleeps_on takes it.
    const auto strayed_squared = [&](const State& now) {
        const std::vector<double>& before = now.contact.looked_at;
        const LinearMotion motion = SelfContact::motion(now);
        double most = 0.0;
        for (std::size_t i = 0, n = before.size() / 4; i < nodes; ++i)
            most = std::max(
                most, (before[3 * n + i] * (to_vec3(now.node[i].x) -
                                            motion.place_of({before[i], before[n + i], before[2 * n + i]})))
                          .squaredNorm());
        return most;
    };
    std::mt19937 generator(5);
    std::int64_t asleep = 0, pushed = 0, looks = 0;
    for (int k = 0; k < 6000; ++k) {
        take_steps(alone, 1);
        // Pairs are looked at where a node has gone so far that others may not sleep, and only there.
        const State& before = watched.synchronised_state();
        const double strayed = strayed_squared(before);
        const bool may_sleep = k > 0 && contact->sleeps_on(before, strayed * (1.0 + 1e-9));
        const bool may_look = k == 0 || !contact->sleeps_on(before, strayed * (1.0 - 1e-9));
        watched.evaluate_forces();
        const State& now = watched.synchronised_state();
        const bool looked = now.contact.look_time == now.time;
        ASSERT_TRUE(looked ? may_look : may_sleep) << k;
        looks += looked ? 1 : 0;
        watched.step_to(1.0);
        if (k % 97 != 0) continue;
        // Nor does it read one that is not marked, even where sides are undecided or those of neighbours
        // contradict, so that all of them are asked.
        State all = alone.synchronised_state();
        for (NearPair& pair : all.contact.pairs)
            pair.side *= static_cast<int>(generator() % 3) - 1;
        all.contact.looked_at.clear();
        contact->prepare(all);
        std::vector<bool> awake(all.node.size(), false);
        contact->mark_awake_nodes(all.contact, awake);
        State some = all;
        for (std::size_t i = 0; i < nodes; ++i) {
            if (awake[i]) continue;
            some.node[i] = {splat(std::nan("")), splat(std::nan(""))};
            ++asleep;
        }
        const std::vector<Vec3> expected = push_awake(all), found = push_awake(some);
        ASSERT_EQ(found, expected) << k;
        pushed += std::ranges::count_if(expected, [](const Vec3& f) { return !f.isZero(0.0); });
        for (std::size_t i = 0; i < all.contact.pairs.size(); ++i)
            ASSERT_EQ(some.contact.pairs[i].side, all.contact.pairs[i].side) << k;
    }
    EXPECT_GT(asleep, 1000);
    EXPECT_GT(pushed, 100);
    EXPECT_GT(looks, 20);
    EXPECT_EQ(alone.unknowns(), watched.unknowns());
    EXPECT_EQ(alone.system().contact.searches, watched.system().contact.searches);
}

TEST(SelfContact, IsKnownToTheBoundOfTheFirstStep) {
    // Folds of a canopy at line stretch are near each other.
    Scene scene = coarse_scene();
    const Simulation simulation(scene);
    EXPECT_EQ(simulation.system().contact.searches, 1);
    scene.full.contact = Contact::none;
    const Simulation without(scene);
    EXPECT_LT(simulation.bound().dt, without.bound().dt);
}

TEST(SelfContact, NeedsAStartThatIsDrawnOutAndTheWholeCanopy) {
    const std::filesystem::path scenes = TWINCHUTE_SOURCE_DIR "/data/scenes";
    const auto key_of = [&](const char* scene, std::vector<std::string> set) -> std::string {
        try {
            read_scene(scenes / scene, set);
        } catch (const SceneError& error) {
            return error.key();
        }
        return "";
    };
    EXPECT_EQ(key_of("c9-inflation.toml", {"full.contact='self'", "full.symmetry='none'"}), "");
    EXPECT_EQ(key_of("c9-window.toml", {"full.contact='self'"}), "");  // an imported mesh
    EXPECT_EQ(key_of("c9-inflation.toml", {"full.contact='self'", "full.symmetry='sector'"}),
              "full.symmetry");
    EXPECT_EQ(key_of("paper/crane-drop.toml", {"full.contact='self'"}), "full.contact");
    EXPECT_EQ(key_of("c9-inflation.toml", {"full.contact=self", "full.contact_friction=-0.1"}),
              "full.contact_friction");
    EXPECT_EQ(key_of("c9-inflation.toml", {"full.contact_friction=0.1"}), "full.contact_friction");
    EXPECT_EQ(key_of("c9-inflation.toml", {"full.contact=self", "full.contact_friction=0.1"}), "");
}

}  // namespace
}  // namespace twinchute::fullsim
