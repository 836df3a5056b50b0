// Elasticities of the reduced-order model against closed forms, and against what dimensions say of any of
// them.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "rom/sensitivity/sensitivity.hpp"
#include "tests/unit/scene_text.hpp"

namespace twinchute {
namespace {

using namespace test;
using rom::InputSensitivity;
using rom::Sensitivity;

const std::string scene = edited(good_scene, "time = \"6 s\"", "at = \"steady-descent\"\ndelay = \"20 s\"");

Sensitivity sensitivities(const std::vector<std::string>& overrides = {}) {
    return rom::sensitivity_of(
        [&](const std::vector<std::string>& more) {
            std::vector<std::string> all = overrides;
            all.insert(all.end(), more.begin(), more.end());
            return read_text(scene, all);
        },
        {});
}

double elasticity(const Sensitivity& s, const std::string& key, const std::string& metric) {
    const auto row = std::ranges::find(s.inputs, key, &InputSensitivity::key);
    const auto column = std::ranges::find(s.metrics, metric);
    if (row == s.inputs.end() || column == s.metrics.end()) {
        ADD_FAILURE() << key << ", " << metric;
        return std::nan("");
    }
    const auto& e = row->of[static_cast<std::size_t>(column - s.metrics.begin())];
    EXPECT_TRUE(e) << key << ", " << metric;
    return e ? e->value : std::nan("");
}

TEST(RomSensitivity, OfADescentRateIsThatOfItsClosedForm) {
    // v = sqrt(2 m g/(rho C_D S)), C_D S = C_D0 pi/4 D0^2, twenty seconds after it is called steady:
    // exponents of a half, to 1e-6; payload and canopy share the mass.
    const Sensitivity s = sensitivities();
    const double share = 152.4 / (152.4 + 5.19);
    EXPECT_NEAR(elasticity(s, "payload.mass", "descent_rate_m_s"), 0.5 * share, 1e-6);
    EXPECT_NEAR(elasticity(s, "parachute.mass", "descent_rate_m_s"), 0.5 * (1.0 - share), 1e-6);
    EXPECT_NEAR(elasticity(s, "environment.gravity", "descent_rate_m_s"), 0.5, 1e-6);
    EXPECT_NEAR(elasticity(s, "environment.atmosphere.density", "descent_rate_m_s"), -0.5, 1e-6);
    EXPECT_NEAR(elasticity(s, "release.speed", "descent_rate_m_s"), 0.0, 1e-6);
    // t_f = n D0/v_s, exactly, and nothing else.
    EXPECT_NEAR(elasticity(s, "parachute.fill_time.n", "filling_time_s"), 1.0, 1e-6);
    EXPECT_NEAR(elasticity(s, "parachute.nominal_diameter", "filling_time_s"), 1.0, 1e-6);
    EXPECT_NEAR(elasticity(s, "release.speed", "filling_time_s"), -1.0, 1e-6);
    EXPECT_NEAR(elasticity(s, "payload.mass", "filling_time_s"), 0.0, 1e-6);
}

TEST(RomSensitivity, DimensionsAddUp) {
    // Buckingham: another unit of mass, length or time changes no physics, so that the elasticities of a
    // metric, each times its input's exponent of that unit, add up to the metric's own. Every input that
    // matters has to be among them. 1e-5: sums of ten central differences.
    struct Exponents {
        double mass, length, time;
    };
    const std::map<std::string, Exponents> units{
        {"kg", {1, 0, 0}},   {"m", {0, 1, 0}},      {"s", {0, 0, 1}},
        {"m/s", {0, 1, -1}}, {"m/s^2", {0, 1, -2}}, {"kg/m^3", {1, -3, 0}},
        {"m^2", {0, 2, 0}},  {"", {0, 0, 0}},       {"rad", {0, 0, 0}}};
    const Sensitivity s = sensitivities({"stop.delay=0.001 s"});
    const std::map<std::string, Exponents> wanted{{"peak_force_N", {1, 1, -2}},
                                                  {"filling_time_s", {0, 0, 1}}};
    for (const auto& [metric, own] : wanted) {
        Exponents sum{0, 0, 0};
        for (const InputSensitivity& input : s.inputs) {
            ASSERT_TRUE(units.contains(input.unit)) << input.key << " " << input.unit;
            const Exponents u = units.at(input.unit);
            if (input.unit == "rad")
                continue;  // straight down: at the end of its range, and without a dimension
            const double e = elasticity(s, input.key, metric);
            sum = {sum.mass + e * u.mass, sum.length + e * u.length, sum.time + e * u.time};
        }
        EXPECT_NEAR(sum.mass, own.mass, 1e-5) << metric;
        EXPECT_NEAR(sum.length, own.length, 1e-5) << metric;
        EXPECT_NEAR(sum.time, own.time, 1e-5) << metric;
    }
}

TEST(RomSensitivity, RowsAreSortedAndSettingsAreNone) {
    const Sensitivity s = sensitivities();
    for (std::size_t i = 1; i < s.inputs.size(); ++i)
        EXPECT_GE(s.inputs[i - 1].largest(), s.inputs[i].largest());
    for (const InputSensitivity& input : s.inputs)
        EXPECT_FALSE(input.key.starts_with("rom.") || input.key.starts_with("full.")) << input.key;
}

}  // namespace
}  // namespace twinchute
