// Panels with fabrics of their own: masses against closed forms, forces against those of each fabric alone,
// and the same bits where all are alike.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "fullsim/fidelity.hpp"
#include "fullsim/mesh/start.hpp"
#include "fullsim/simulation.hpp"
#include "lib/models/meridian.hpp"
#include "lib/scene/needs.hpp"
#include "tests/unit/scene_text.hpp"

namespace twinchute::fullsim {
namespace {

Scene of_type(const std::string& type, const std::vector<std::string>& keys = {}) {
    std::vector<std::string> all{"parachute.type=" + type};
    all.insert(all.end(), keys.begin(), keys.end());
    return test::read_text(test::good_scene, all);
}

/// A fabric that is heavier and stiffer, and contracts otherwise.
Fabric other_fabric(const Parachute& chute) {
    Fabric fabric = chute.fabric;
    fabric.name = "other";
    fabric.density *= 1.5;
    fabric.thickness *= 2.0;
    fabric.youngs_modulus *= 3.0;
    fabric.poisson_ratio = 0.1;
    return fabric;
}

TEST(PanelFabric, WeighsWhatEachPanelWeighs) {
    // Areas of a biconical canopy's panels by hand: 28 gores, each flat across, so that between two rows it
    // is a trapezoid of their chords and of the distance along its middle; a panel from the apex loses the
    // vent.
    for (const std::size_t own : {0, 1}) {
        Scene scene = of_type("biconical");
        Parachute& chute = scene.parachutes.front();
        const Mesh plain = built_mesh(scene);
        chute.panel.resize(2);
        chute.panel[own].fabric = other_fabric(chute);
        const Mesh mesh = built_mesh(scene);
        ASSERT_EQ(mesh.sheets(), 2);
        const Meridian meridian = gore_meridian(chute);
        const double sine = std::sin(pi / 28.0), edge = meridian.edges().front(), skirt = meridian.length();
        const auto area = [&](double from, double to) {
            const MeridianPoint a = meridian.at(from), b = meridian.at(to);
            return 28.0 * (a.radius + b.radius) * sine * (b.centre - a.centre);
        };
        const double vent = meridian.seam_at(polygon_radius(chute.vent_diameter, 28));
        const double areas[] = {area(vent, edge), area(edge, skirt)};
        EXPECT_NEAR(areas[0] + areas[1], plain.fabric_area(), 1e-10 * plain.fabric_area());
        const Fabric& f = chute.fabric;
        // Three times the weight of a panel: two more.
        const double more = 2.0 * f.density * f.thickness * areas[own];
        EXPECT_NEAR(mesh.parachute_mass() - plain.parachute_mass(), more, 1e-10 * mesh.parachute_mass());
        double lumped = 0.0;
        for (std::size_t i = 0; i < mesh.mass.size(); ++i)
            lumped += mesh.mass[i] - plain.mass[i];
        EXPECT_NEAR(lumped, more, 1e-10 * mesh.parachute_mass());
    }
}

/// Nodes after some steps, as bits.
std::vector<double> flown(const Scene& scene, int steps = 200) {
    Simulation simulation(scene);
    for (int step = 0; step < steps; ++step) {
        simulation.evaluate_forces();
        simulation.step_to(1e9);
    }
    std::vector<double> all;
    const State& state = simulation.synchronised_state();
    for (NodeIndex i = 0; i < simulation.mesh().node_count(); ++i)
        for (int c = 0; c < 3; ++c)
            all.insert(all.end(), {state.node[i].x[c], state.node[i].v[c]});
    return all;
}

TEST(PanelFabric, OneFabricWrittenForEachPanelHasTheSameBits) {
    const std::string fabric = "mil-c-7020-c9";
    for (const char* start : {"line-stretch", "inflated", "free"}) {
        const std::string by = std::string("parachute.deploy.by=") + start;
        const Scene common = of_type("triconical", {by});
        const Scene each = of_type(
            "triconical", {by, "parachute.panel=[{fabric='" + fabric + "'}, {}, {fabric='" + fabric + "'}]"});
        ASSERT_EQ(common.parachutes.front().fabric.name, fabric);
        ASSERT_EQ(each.parachutes.front().panel.size(), 3u);
        EXPECT_EQ(flown(common), flown(each)) << start;
    }
}

TEST(PanelFabric, ASheetWithTheConstantsOfTheOtherMovesAlike) {
    // Two sheets of one fabric under two names: other batches, other order of sums, the same mechanics. 1e-9
    // m after 200 steps from line stretch leaves room for round-off that an opening lets grow; a sheet whose
    // forces were lost or doubled would be centimetres off. In a pack edges that come taut and slack let it
    // grow faster, 4e-8 m after as many: there it is twenty.
    struct Start {
        const char* by;
        int steps;
    };
    for (const auto& [start, steps] : {Start{"line-stretch", 200}, Start{"free", 20}}) {
        Scene scene = of_type("biconical", {std::string("parachute.deploy.by=") + start});
        scene.full.time_step_factor = 0.5;
        const std::vector<double> one = flown(scene, steps);
        Parachute& chute = scene.parachutes.front();
        chute.panel.resize(2);
        chute.panel[1].fabric = chute.fabric;
        chute.panel[1].fabric.name = "the same";
        ASSERT_EQ(built_mesh(scene).sheets(), 2);
        const std::vector<double> two = flown(scene, steps);
        ASSERT_EQ(one.size(), two.size());
        double furthest = 0.0;
        for (std::size_t i = 0; i < one.size(); i += 2)
            furthest = std::max(furthest, std::abs(one[i] - two[i]));
        EXPECT_LT(furthest, 1e-9) << start;
    }
}

TEST(PanelFabric, SectorsAndAPredictedFillingAreRefusedByKey) {
    Scene scene = of_type("biconical", {"full.symmetry='sector'"});
    scene.parachutes.front().panel.resize(2);
    EXPECT_NO_THROW(Simulation{scene});
    scene.parachutes.front().panel[0].fabric = other_fabric(scene.parachutes.front());
    try {
        Simulation simulation(scene);
        FAIL() << "it has no alike sectors in rows of one fabric";
    } catch (const SceneError& error) {
        EXPECT_EQ(error.key(), "full.symmetry");
        EXPECT_NE(std::string(error.what()).find("panels have fabrics of their own"), std::string::npos)
            << error.what();
    }
    const auto refused = [](const std::vector<std::string>& keys) {
        return test::complaint(test::good_scene, keys);
    };
    const auto expect = [&](const std::vector<std::string>& keys, const char* text) {
        EXPECT_NE(refused(keys).find(text), std::string::npos) << refused(keys);
    };
    expect({"parachute.type=biconical", "parachute.panel=[{}]"}, "panel: 1 for 2 panels");
    expect({"parachute.type=disk-gap-band", "parachute.panel=[{}, {fabric='mil-c-7020-c9'}, {}]"},
           "panel.2.fabric: is that of a gap");
    expect({"parachute.type=biconical", "parachute.panel=[{fabric='no-such'}, {}]"}, "no-such");
}

}  // namespace
}  // namespace twinchute::fullsim
