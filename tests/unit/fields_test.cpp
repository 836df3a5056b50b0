// Fields of cells whose strain and stress are known in closed form, and when frames are taken.
#include <gtest/gtest.h>

#include <cmath>

#include "fullsim/run/fields.hpp"

namespace twinchute::fullsim {
namespace {

constexpr double modulus = 2e8, thickness = 1e-4, poisson = 0.25;  // [Pa], [m], [-]
constexpr double tension_modulus = modulus * thickness;            // [N/m]

/// One triangle with legs of 1 m, a line of 2 m from its corner 0 to the payload.
Mesh small_mesh() {
    Mesh mesh;
    mesh.position = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, -2}};
    mesh.canopy_nodes = 3;
    mesh.triangles = {{{0, 1, 2}, 0, 1.0, 0.0, 1.0}};
    mesh.cables = {{{0, 3}, 2.0, 3.0, CableKind::line}};
    mesh.fabric.youngs_modulus = modulus;
    mesh.fabric.thickness = thickness;
    mesh.fabric.poisson_ratio = poisson;
    mesh.fabric.density = 500.0;
    mesh.cords.fill({});
    for (Cord& cord : mesh.cords) {
        cord.youngs_modulus = 1e9;
        cord.diameter = 2e-3;
        cord.density = 1000.0;
    }
    return mesh;
}

/// The triangle's legs and the line are `along`, `across`, `line` times as long as unstrained.
State stretched(const Mesh& mesh, double along, double across, double line) {
    State state;
    state.time = 0.75;
    for (const Vec3& x : mesh.position)
        state.node.push_back({Lanes{along * x.x(), across * x.y(), line * x.z(), 0.0}, Lanes{1, 2, 3, 0}});
    state.node.emplace_back();  // the dummy
    state.air.pressure = 42.0;
    return state;
}

double value(const VtuGrid& grid, std::string_view name, std::size_t cell) {
    for (const VtuArray& array : grid.cell_data)
        if (array.name == name)
            return std::visit([&](const auto& values) { return static_cast<double>(values.at(cell)); },
                              array.values);
    ADD_FAILURE() << "no array " << name;
    return std::nan("");
}

class Fields : public testing::Test {
protected:
    VtuGrid frame(double along, double across, double line = 1.0, double weight = 1.0) {
        State state = stretched(mesh_, along, across, line);
        state.fe_weight = weight;
        return field_frame(mesh_grid(mesh_), mesh_, state);
    }
    /// Green strain of a length that is `stretch` times as long.
    static double green(double stretch) { return 0.5 * (stretch * stretch - 1.0); }

    Mesh mesh_ = small_mesh();
};

TEST_F(Fields, TautFabricHasPlaneStress) {
    const VtuGrid grid = frame(1.02, 1.01);
    const double e1 = green(1.02), e2 = green(1.01), plane = tension_modulus / (1.0 - poisson * poisson);
    EXPECT_NEAR(value(grid, "strain_first", 0), e1, 1e-7);
    EXPECT_NEAR(value(grid, "strain_second", 0), e2, 1e-7);
    EXPECT_NEAR(value(grid, "stress_first_N_m", 0), plane * (e1 + poisson * e2), 1e-3);
    EXPECT_NEAR(value(grid, "stress_second_N_m", 0), plane * (e2 + poisson * e1), 1e-3);
    EXPECT_EQ(value(grid, "wrinkling_state", 0), 2.0);
    EXPECT_EQ(value(grid, "pressure_Pa", 0), 42.0);
}

TEST_F(Fields, WrinkledFabricCarriesOneWayAndSlackFabricNothing) {
    const VtuGrid wrinkled = frame(1.02, 0.9);
    EXPECT_NEAR(value(wrinkled, "stress_first_N_m", 0), tension_modulus * green(1.02), 1e-3);
    EXPECT_NEAR(value(wrinkled, "stress_second_N_m", 0), 0.0, 1e-3);
    EXPECT_EQ(value(wrinkled, "wrinkling_state", 0), 1.0);
    const VtuGrid slack = frame(0.99, 0.9);
    EXPECT_EQ(value(slack, "stress_first_N_m", 0), 0.0);
    EXPECT_NEAR(value(slack, "strain_first", 0), green(0.99), 1e-7);
    EXPECT_EQ(value(slack, "wrinkling_state", 0), 0.0);
}

TEST_F(Fields, CablesPullAndNeverPush) {
    const double stiffness = mesh_.cord(CableKind::line).axial_stiffness() * 3.0;
    const VtuGrid taut = frame(1, 1, 1.004), slack = frame(1, 1, 0.7);
    EXPECT_NEAR(value(taut, "cable_strain", 1), 0.004, 1e-8);
    EXPECT_NEAR(value(taut, "cable_tension_N", 1), 0.004 * stiffness, 1e-6 * stiffness);
    EXPECT_NEAR(value(slack, "cable_strain", 1), -0.3, 1e-7);
    EXPECT_EQ(value(slack, "cable_tension_N", 1), 0.0);
}

TEST_F(Fields, WithoutWeightThereIsStrainButNoStress) {
    const VtuGrid none = frame(1.02, 1.01, 1.0, 0.0), half = frame(1.02, 1.01, 1.0, 0.5);
    EXPECT_EQ(value(none, "stress_first_N_m", 0), 0.0);
    EXPECT_EQ(value(none, "stress_second_N_m", 0), 0.0);
    EXPECT_NEAR(value(none, "strain_first", 0), green(1.02), 1e-7);
    EXPECT_EQ(value(none, "wrinkling_state", 0), 2.0);
    EXPECT_NEAR(value(half, "stress_first_N_m", 0), 0.5 * value(frame(1.02, 1.01), "stress_first_N_m", 0),
                1e-3);
}

TEST_F(Fields, CellsStandInTheOrderOfTheMeshAndKnowTheirKind) {
    const VtuGrid grid = frame(1, 1);
    EXPECT_EQ(grid.cells, (std::vector{VtuCell::triangle, VtuCell::line, VtuCell::vertex}));
    EXPECT_EQ(grid.connectivity, (std::vector<std::int32_t>{0, 1, 2, 0, 3, 3}));
    EXPECT_EQ(cell_kind_names()[static_cast<std::size_t>(value(grid, "kind", 0))], "fabric");
    EXPECT_EQ(cell_kind_names()[static_cast<std::size_t>(value(grid, "kind", 1))], "line");
    EXPECT_EQ(cell_kind_names()[static_cast<std::size_t>(value(grid, "kind", 2))], "payload");
    mesh_.reefing_line = {0};
    EXPECT_EQ(cell_kind_names()[static_cast<std::size_t>(value(frame(1, 1), "kind", 1))], "reefing line");
    EXPECT_EQ(grid.time, 0.75);
    EXPECT_EQ(grid.points.size(), 12u);
    EXPECT_EQ(std::get<std::vector<float>>(grid.point_data.front().values),
              (std::vector<float>{1, 2, 3, 1, 2, 3, 1, 2, 3, 1, 2, 3}));
}

class FieldRecorderTest : public Fields {
protected:
    /// Steps of 0.03 s up to `end`, observed each.
    void fly(FieldRecorder& recorder, double begin, double end) {
        for (int i = static_cast<int>(std::lround(begin / 0.03)); 0.03 * i < end; ++i) {
            State state = stretched(mesh_, 1, 1, 1);
            state.time = 0.03 * i;
            recorder.observe(state);
        }
    }
    std::vector<double> times_;
    FieldRecorder::Sink sink_ = [this](const VtuGrid& frame) { times_.push_back(*frame.time); };
};

TEST_F(FieldRecorderTest, GivesFramesAwayOnceTheyAreFoundSound) {
    FieldRecorder recorder(mesh_, 10.0, sink_);
    fly(recorder, 0.0, 0.25);
    EXPECT_TRUE(times_.empty());
    recorder.accept();
    ASSERT_EQ(times_.size(), 3u);  // the first steps at or after 0, 0.1 and 0.2 s
    EXPECT_NEAR(times_[1], 0.12, 1e-12);
    EXPECT_NEAR(times_[2], 0.21, 1e-12);
    fly(recorder, 0.27, 0.45);
    recorder.forget();
    recorder.accept();
    EXPECT_EQ(times_.size(), 3u);
}

TEST_F(FieldRecorderTest, WithoutARateOrASinkNothingIsTaken) {
    FieldRecorder unasked(mesh_, {}, sink_);
    fly(unasked, 0.0, 1.0);
    unasked.accept();
    EXPECT_TRUE(times_.empty());
    const FieldRecorder::Sink nobody;
    FieldRecorder unheard(mesh_, 10.0, nobody);
    fly(unheard, 0.0, 1.0);
    unheard.accept();  // calls nothing
}

}  // namespace
}  // namespace twinchute::fullsim
