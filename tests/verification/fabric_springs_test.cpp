// Fabric as springs along the edges of its triangles: how stiff it is against the sheet it stands for, how
// far it stretches, and what its hardening costs.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <random>

#include "fullsim/forces/spring.hpp"
#include "fullsim/simulation.hpp"
#include "tests/support/c9_scene.hpp"
#include "tests/support/structure.hpp"

namespace twinchute::fullsim {
namespace {

constexpr double modulus = 4.3e8, thickness = 1e-4;

/// A flat sheet of `columns` x `rows` cells in the xy plane, with a function that says where its points lie
/// and one that says which way each cell is cut.
template <class Place, class Rising>
Mesh sheet(int columns, int rows, Place place, Rising rising) {
    Mesh mesh;
    mesh.fabric = {"fabric", 533.0, modulus, 0.3, thickness};
    for (int r = 0; r <= rows; ++r)
        for (int c = 0; c <= columns; ++c)
            mesh.position.push_back(place(c, r));
    const auto node = [&](int c, int r) { return static_cast<NodeIndex>(r * (columns + 1) + c); };
    for (int r = 0; r < rows; ++r)
        for (int c = 0; c < columns; ++c) {
            const NodeIndex q[4] = {node(c, r), node(c + 1, r), node(c + 1, r + 1), node(c, r + 1)};
            if (rising(c, r)) {
                test::add_triangle(mesh, {q[0], q[1], q[2]});
                test::add_triangle(mesh, {q[0], q[2], q[3]});
            } else {
                test::add_triangle(mesh, {q[0], q[1], q[3]});
                test::add_triangle(mesh, {q[1], q[2], q[3]});
            }
        }
    lump_masses(mesh, 0.0);
    return mesh;
}

/// Young's modulus over that of the fabric in a pull along y: rows at both ends held in y and free along x,
/// small strains, all springs in tension or not.
double modulus_ratio(const Mesh& mesh, int columns, int rows) {
    const int n = static_cast<int>(mesh.position.size());
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(2 * n, 2 * n);
    for (const FabricEdge& e : fabric_edges(mesh)) {
        const Vec3 d = (mesh.position[e.node[1]] - mesh.position[e.node[0]]).normalized();
        const double k = modulus * e.section / e.rest_length;
        for (int a = 0; a < 2; ++a)
            for (int b = 0; b < 2; ++b)
                for (int i = 0; i < 2; ++i)
                    for (int j = 0; j < 2; ++j)
                        K(2 * e.node[a] + i, 2 * e.node[b] + j) += (a == b ? k : -k) * d[i] * d[j];
    }
    // Unit strain of the top row; what is held gets a stiffness beside which all others vanish.
    const double height = mesh.position.back().y() - mesh.position.front().y();
    const double hold = 1e9 * K.diagonal().maxCoeff();
    Eigen::VectorXd load = Eigen::VectorXd::Zero(2 * n);
    const auto fix = [&](int dof, double value) {
        K(dof, dof) += hold;
        load[dof] += hold * value;
    };
    for (int c = 0; c <= columns; ++c) {
        fix(2 * c + 1, 0.0);
        fix(2 * (rows * (columns + 1) + c) + 1, height);
    }
    fix(0, 0.0);  // no sliding along x
    const Eigen::VectorXd u = K.ldlt().solve(load);
    double reaction = 0.0;
    for (int c = 0; c <= columns; ++c)
        reaction -= hold * u[2 * c + 1];
    const double width = (mesh.position[columns] - mesh.position[0]).norm();
    return -reaction / (modulus * thickness * width);
}

TEST(FabricSprings, ModulusOfAnEquilateralSheet) {
    // A lattice of springs k has 2 k/sqrt(3) per width; k = E t sqrt(3)/2 makes it E t. 5 % for the free
    // edges, whose springs stand for triangles on one side only.
    const double h = std::sqrt(0.75);
    const Mesh mesh = sheet(
        20, 16, [&](int c, int r) { return Vec3(c + 0.5 * (r % 2), h * r, 0.0); },
        [](int, int r) { return r % 2 != 0; });
    const double ratio = modulus_ratio(mesh, 20, 16);
    test::report("modulus of an equilateral sheet of springs over E:", ratio);
    EXPECT_NEAR(ratio, 1.0, 0.05);
}

TEST(FabricSprings, ModulusOfARandomSheet) {
    const double h = std::sqrt(0.75);
    std::mt19937 generator(3);
    std::uniform_real_distribution<double> step(-0.18, 0.18);
    const Mesh mesh = sheet(
        20, 16,
        [&](int c, int r) {
            const bool edge = c == 0 || c == 20 || r == 0 || r == 16;
            return Vec3(c + 0.5 * (r % 2) + (edge ? 0.0 : step(generator)),
                        h * r + (edge ? 0.0 : step(generator)), 0.0);
        },
        [](int, int r) { return r % 2 != 0; });
    const double ratio = modulus_ratio(mesh, 20, 16);
    test::report("modulus of a random sheet of springs over E:", ratio);
    EXPECT_NEAR(ratio, 1.0, 0.05);
}

TEST(FabricSprings, ModulusOfTheGorePattern) {
    // Right-angled cells with mirrored diagonals. Square ones are the worst: the springs along the pull carry
    // nearly all of it, and stand for the diagonals' share as well. Near the skirt of a C-9 cells are twice
    // as wide as long.
    for (const double width : {1.0, 2.0, 0.5}) {
        const Mesh mesh = sheet(
            16, 16, [&](int c, int r) { return Vec3(width * c, r, 0.0); },
            [](int c, int) { return c % 2 != 0; });
        const double ratio = modulus_ratio(mesh, 16, 16);
        test::report("modulus of the gore pattern of springs over E, width over length:", width, ratio);
        EXPECT_NEAR(ratio, 1.0, 0.20);
    }
}

TEST(FabricSprings, SectionsStandForTheWholeSheet) {
    // Every triangle counts once at each of its three edges: sum A_ij l0 = 3 t S.
    const Mesh mesh = test::coarse_c9();
    double volume = 0.0;
    for (const FabricEdge& e : fabric_edges(mesh))
        volume += e.section * e.rest_length;
    EXPECT_NEAR(volume, 3.0 * mesh.fabric.thickness * mesh.fabric_area(), 1e-12 * volume + 1e-15);
}

/// The bound on the step of springs and cables together, every spring strained by `strain`.
double step_at(const Mesh& mesh, double strain) {
    State state = test::state_of(mesh);
    for (NodeRecord& node : state.node)
        node.x *= splat(1.0 + strain);
    GershgorinSums sums{std::vector<double>(state.node.size(), 0.0),
                        std::vector<double>(state.node.size(), 0.0)};
    make_fabric_springs(mesh, 1e-5, 0.0, 0.0)->add_row_sums(state, sums);
    make_cable(mesh, 0.0)->add_row_sums(state, sums);
    std::vector<double> inertia = mesh.mass;
    inertia.resize(state.node.size(), 1.0);
    return critical_step(sums, inertia).dt;
}

TEST(FabricSprings, HardeningCostsNoTimeStep) {
    // On a uniform mesh the vent leaves the rest of the fabric room to harden; a graded one has no node so
    // fast, and so less room.
    for (const Grading grading : {Grading::uniform, Grading::graded}) {
        const Mesh mesh =
            make_gore_mesh(test::c9_scene().parachutes.front(), {2, 17, 31, 5, grading}, 152.4, Vec3::UnitZ(),
                           mouth_area_at_line_stretch(test::c9_scene().parachutes.front()), 0.0);
        const auto edges = fabric_edges(mesh);
        const auto above = [&](double hardening) {
            return static_cast<double>(std::ranges::count_if(
                       edges, [&](const FabricEdge& e) { return e.hardening > hardening; })) /
                   static_cast<double>(edges.size());
        };
        test::report("share of edges that harden by more than 1.5, 3:", above(1.5), above(3.0));
        EXPECT_GT(above(grading == Grading::uniform ? 3.0 : 1.5), 0.5);
        EXPECT_GE(step_at(mesh, 0.06), step_at(mesh, 0.0) * (1.0 - 1e-12));
    }
}

TEST(FabricSprings, FabricStaysBelowFivePercentInACraneDrop) {
    Scene scene = test::packed_c9(DeployBy::static_line);
    Simulation simulation(scene);
    const auto edges = fabric_edges(simulation.mesh());
    double largest = 0.0;
    simulation.evaluate_forces();
    const auto look = [&] {
        for (const FabricEdge& e : edges)
            largest = std::max(largest, (to_vec3(simulation.synchronised_state().node[e.node[1]].x) -
                                         to_vec3(simulation.synchronised_state().node[e.node[0]].x))
                                                    .norm() /
                                                e.rest_length -
                                            1.0);
    };
    while (!simulation.lines_are_taut()) {
        simulation.step_to(10.0);
        simulation.evaluate_forces();
    }
    ASSERT_FALSE(simulation.snatch());
    while (simulation.system().stage == Stage::springs && !simulation.mouth_is_open()) {
        simulation.step_to(simulation.inflation().end_of(simulation.system().phase));
        simulation.evaluate_forces();
        if (simulation.system().time >= simulation.inflation().end_of(Phase::initial))
            simulation.begin(Phase::filling);
        if (simulation.system().step % 10 == 0) look();
    }
    test::report("largest strain of an edge from snatch to the switch:", largest);
    EXPECT_LT(largest, 0.05);
}

}  // namespace
}  // namespace twinchute::fullsim
