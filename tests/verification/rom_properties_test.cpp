// Properties of every scene of the reduced-order model, of whatever size: two thousand random scenes,
// with reefing, clusters, sequences, winds and releases in all directions.
#include <gtest/gtest.h>

#include <cmath>

#include "lib/solve/opening.hpp"
#include "tests/support/c9_scene.hpp"
#include "tests/support/random.hpp"
#include "tests/support/runs.hpp"

namespace twinchute {
namespace {

using namespace test;

constexpr int scenes = 2000;

class Scenes : public Random {
public:
    using Random::Random;

    Parachute parachute(double payload) {
        Parachute p = c9_scene().parachutes.front();
        const double scale = number_in(0.05, 8.0);
        p.nominal_diameter *= scale;
        p.drag_area = number_in(0.3, 1.0) * 0.25 * pi * p.nominal_diameter * p.nominal_diameter;
        p.mass = payload * number_in(0.01, 0.1);
        p.line_length *= scale;
        p.riser_length *= scale;
        p.initial_drag_area_ratio = number_in(0.001, 0.1);
        p.drag_area_law = &drag_area_laws()[below(drag_area_laws().size())];
        p.fill_time.n = number_in(1.0, 14.0);
        if (random_bool(0.3)) p.initial_phase = {false, 0.0};
        if (random_bool(0.3)) {
            p.count = 1 + static_cast<int>(below(3));
            if (p.count > 1)
                for (int i = 0; i < p.count; ++i)
                    p.lag.push_back(number_in(0.0, 0.5));
        }
        double ratio = p.initial_drag_area_ratio;
        for (std::size_t stages = random_bool(0.4) ? 1 + below(2) : 0; stages > 0; --stages) {
            ratio += (1.0 - ratio) * number_in(0.05, 0.4);
            Reefing& stage = p.reefing.emplace_back();
            stage.drag_area_ratio = ratio;
            stage.until = {random_bool(0.5) ? Trigger::Kind::line_stretch : Trigger::Kind::full_open, 0.0,
                           number_in(0.0, 3.0)};
        }
        return p;
    }

    Scene scene() {
        Scene s = c9_scene();
        s.environment.atmosphere.constant_density = number_in(0.05, 1.5);
        s.payload.mass = number_in(0.1, 5000.0);
        if (random_bool(0.5)) s.payload.drag_area = number_in(0.001, 1.0);
        s.release = {number_in(2000.0, 5000.0), number_in(5.0, 150.0), number_in(-0.5 * pi, 0.5 * pi),
                     number_in(-pi, pi)};
        if (random_bool(0.3))
            s.environment.wind = uniform_wind({number_in(-20.0, 20.0), number_in(-20.0, 20.0), 0.0});
        if (random_bool(0.3)) s.aerodynamics.added_mass.reset();
        s.parachutes = {parachute(s.payload.mass)};
        if (random_bool(0.3)) {
            s.parachutes.push_back(parachute(s.payload.mass));
            s.parachutes[1].name = "second";
            s.parachutes[1].deploy_when = {Trigger::Kind::time, number_in(0.1, 5.0), 0.0};
            if (random_bool(0.5)) s.parachutes[0].cut = {Trigger::Kind::full_open, 0.0, 0.0, "second"};
        }
        s.stop = {Trigger::Kind::time, number_in(1.0, 15.0), 0.0};
        return s;
    }
};

double of(const RunRecord& record, const char* key) {
    return record.metric(key).value_or(std::nan(""));
}

/// Refused is an answer, too: of a snatch too slow for its initial phase.
bool has_run(const RunRecord& record) {
    return record.status.code == StatusCode::completed || record.status.code == StatusCode::stopped_by_event;
}

TEST(RomProperties, EveryRunEndsInANameAndInNumbers) {
    Scenes some(1);
    int ran = 0;
    for (int i = 0; i < scenes; ++i) {
        const Scene scene = some.scene();
        const RunRecord record = run_rom(scene);
        ASSERT_TRUE(has_run(record) || record.status.code == StatusCode::refused)
            << i << ": " << record.status.detail;
        ran += has_run(record) ? 1 : 0;
        for (const Metric& metric : record.metrics)
            ASSERT_TRUE(std::isfinite(metric.value)) << i << ": " << metric.key;
        for (const Channel& channel : record.channels)
            for (const double value : channel.values)
                ASSERT_TRUE(std::isfinite(value)) << i << ": " << channel.name;
        for (std::size_t k = 1; k < record.events.size(); ++k)
            ASSERT_LE(record.events[k - 1].time, record.events[k].time) << i;
    }
    EXPECT_GT(ran, scenes * 9 / 10);
}

TEST(RomProperties, EnergyOnlyFallsInStillAir) {
    // 1/2 v^2 + g z of a body that nothing but drag and weight act on falls; air that it gathers and lets go,
    // and parts that it casts off, would need a balance of their own. Between the rows of a run 1e-7 of what
    // there is may come from the integration's 1e-8 on speed and altitude.
    Scenes some(2);
    for (int i = 0; i < scenes; ++i) {
        Scene scene = some.scene();
        scene.environment.wind.reset();
        scene.aerodynamics.added_mass.reset();
        for (Parachute& p : scene.parachutes)
            p.cut.reset();
        const RunRecord record = run_rom(scene);
        if (!has_run(record)) continue;
        const auto& z = record.find_channel("altitude")->values;
        const auto& v = record.find_channel("speed")->values;
        const auto energy = [&](std::size_t k) { return 0.5 * v[k] * v[k] + standard_gravity * z[k]; };
        for (std::size_t k = 1; k < z.size(); ++k)
            ASSERT_LE(energy(k), energy(k - 1) * (1.0 + 1e-7)) << i << ", row " << k;
    }
}

TEST(RomProperties, WithoutGravityAFasterReleasePullsHarder) {
    // All speeds scale with that of the release, and forces with its square: exactly so with a filling time
    // that is a length over a speed and no added mass to speak of.
    Scenes some(3);
    for (int i = 0; i < scenes; ++i) {
        Scene slow = some.scene();
        slow.environment.gravity = 0.0;
        slow.environment.wind.reset();
        slow.parachutes.resize(1);
        Parachute& p = slow.parachutes.front();
        p.reefing.clear();
        p.lag.clear();
        p.cut.reset();
        Scene fast = slow;
        const double factor = some.number_in(1.1, 3.0);
        fast.release.speed *= factor;
        fast.stop.value /= factor;
        const RunRecord a = run_rom(slow), b = run_rom(fast);
        if (!has_run(a) || !has_run(b)) continue;
        const double expected = factor * factor * of(a, "max_force_N");
        ASSERT_NEAR(of(b, "max_force_N"), expected, 1e-5 * expected) << i;
    }
}

TEST(RomProperties, UnitsOfMassLengthAndTimeMeanNothing) {
    // A fall told in other units: one of mass, length and time each. The integration's tolerance is
    // relative to a metre and a metre per second only where things are small.
    Scenes some(4);
    for (int i = 0; i < scenes / 4; ++i) {
        Scene told = some.scene();
        told.rom.rtol = 1e-10;
        const double m = some.number_in(0.5, 2.0), l = some.number_in(0.5, 2.0), t = some.number_in(0.5, 2.0);
        Scene other = told;
        other.environment.atmosphere.constant_density *= m / (l * l * l);
        other.environment.gravity *= l / (t * t);
        if (other.environment.wind)
            for (auto& level : other.environment.wind->levels)
                level.velocity *= l / t;
        other.payload.mass *= m;
        if (other.payload.drag_area) *other.payload.drag_area *= l * l;
        other.release.altitude *= l;
        other.release.speed *= l / t;
        other.stop.value *= t;
        for (Parachute& p : other.parachutes) {
            p.nominal_diameter *= l;
            p.drag_area *= l * l;
            p.mass *= m;
            for (double& lag : p.lag)
                lag *= t;
            if (p.deploy_when) p.deploy_when->value *= t;
            for (Reefing& stage : p.reefing)
                stage.until.delay *= t;
        }
        const RunRecord a = run_rom(told), b = run_rom(other);
        if (!has_run(a) || !has_run(b)) continue;
        const double force = of(a, "max_force_N") * m * l / (t * t);
        ASSERT_NEAR(of(b, "max_force_N"), force, 1e-6 * force) << i;
        const double speed = last(a, "speed") * l / t;
        ASSERT_NEAR(last(b, "speed"), speed, 1e-6 * speed) << i;
    }
}

TEST(RomProperties, NorthIsADirectionLikeAnyOther) {
    Scenes some(5);
    for (int i = 0; i < scenes / 4; ++i) {
        Scene scene = some.scene();
        scene.environment.wind =
            uniform_wind({some.number_in(-20.0, 20.0), some.number_in(-20.0, 20.0), 0.0});
        Scene turned = scene;
        const double angle = some.number_in(0.1, 6.0);  // clockwise, as headings are
        turned.release.heading += angle;
        const Vec3 wind = scene.environment.wind->at(0.0);
        turned.environment.wind =
            uniform_wind({wind.x() * std::cos(angle) + wind.y() * std::sin(angle),
                          wind.y() * std::cos(angle) - wind.x() * std::sin(angle), 0.0});
        const RunRecord a = run_rom(scene), b = run_rom(turned);
        if (!has_run(a) || !has_run(b)) continue;
        ASSERT_NEAR(of(b, "max_force_N"), of(a, "max_force_N"), 1e-6 * of(a, "max_force_N")) << i;
        const double east = last(a, "east"), north = last(a, "north"), far = std::hypot(east, north);
        ASSERT_NEAR(last(b, "east"), east * std::cos(angle) + north * std::sin(angle), 1e-6 * (far + 1.0))
            << i;
        ASSERT_NEAR(last(b, "north"), north * std::cos(angle) - east * std::sin(angle), 1e-6 * (far + 1.0))
            << i;
    }
}

TEST(RomProperties, TheOrderOfParachutesIsNone) {
    Scenes some(6);
    int tried = 0;
    for (int i = 0; i < scenes && tried < scenes / 4; ++i) {
        const Scene scene = some.scene();
        if (scene.parachutes.size() < 2) continue;
        ++tried;
        Scene turned = scene;
        std::swap(turned.parachutes[0], turned.parachutes[1]);
        const RunRecord a = run_rom(scene), b = run_rom(turned);
        ASSERT_EQ(a.status.code, b.status.code) << i;
        if (!has_run(a)) continue;
        // Sums in another order: rounding, and what the integration's 1e-8 makes of it.
        ASSERT_NEAR(of(a, "max_force_N"), of(b, "max_force_N"), 1e-6 * of(b, "max_force_N")) << i;
        ASSERT_EQ(a.events.size(), b.events.size()) << i;
    }
    EXPECT_GT(tried, scenes / 8);
}

}  // namespace
}  // namespace twinchute
