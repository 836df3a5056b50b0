// The judge of steady descents on falls whose limit is known: made of a formula, or of an equation of motion.
#include "lib/solve/steady_descent.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "lib/math/vec.hpp"

namespace twinchute {
namespace {

constexpr double g = standard_gravity;
constexpr double step = 0.01;  // [s] between samples

/// Air of one density, the ground far below.
Environment uniform_air() {
    Environment air;
    air.atmosphere.model = find_atmosphere("constant");
    air.atmosphere.constant_density = 1.0;
    air.gravity = g;
    air.ground = -1e6;
    return air;
}

/// A fall in air of density 1 at sink [m/s] with `across` [m/s] besides; no speed is gained but `gained`.
FallSample fall_at(double time, double sink, double across = 0.0, double gained = 0.0) {
    FallSample now;
    now.time = time;
    now.density = 1.0;
    now.sink = sink;
    now.airspeed = std::hypot(sink, across);
    now.system_sink = now.air_sink = gained;
    return now;
}

/// The first steady window of a fall, where there is one within `longest` [s].
std::optional<DescentWindow> first_steady(const std::function<FallSample(double)>& fall,
                                          double longest = 600.0) {
    const Environment air = uniform_air();
    SteadyDescent judge(air);
    for (int k = 0; k * step < longest; ++k) {
        judge.add(fall(k * step));
        if (const auto window = judge.judge(0.0); window && window->is_steady()) return window;
    }
    return {};
}

/// The speed at which drag carries the weight with a velocity s across: w sqrt(w^2 + s^2) = w_e^2.
double carried(double w_e, double s) {
    return std::sqrt(0.5 * (std::sqrt(std::pow(s, 4) + 4.0 * std::pow(w_e, 4)) - s * s));
}

TEST(SteadyDescent, FindsTheEndOfABrakedFall) {
    // (1 + mu) dw/dt = g (1 - (w/w_e)^2) from above is w_e coth(g t/((1 + mu) w_e) + c). The balance knows
    // the limit to the rounding of a sum, so that what is said to remain does remain: to the trapezoidal
    // rule.
    for (const double w_e : {0.8, 7.7, 60.0})
        for (const double mu : {0.0, 0.4, 3.0}) {
            const auto window = first_steady([&](double t) {
                const double w = w_e / std::tanh(g * t / ((1.0 + mu) * w_e) + 0.4);
                FallSample now = fall_at(t, w, 0.0, w);
                now.added_mass_ratio = mu;
                return now;
            });
            ASSERT_TRUE(window) << w_e << ' ' << mu;
            const double off = window->rate / w_e - 1.0;
            EXPECT_LT(off, steady_descent_remaining) << w_e << ' ' << mu;
            EXPECT_NEAR(window->remaining, off, 2e-4) << w_e << ' ' << mu;
            EXPECT_NEAR(window->to - window->from, descent_window(w_e, mu, g),
                        0.05 * descent_window(w_e, mu, g));
            // Not before it could be: a window, and no later than ten times tau after its approach.
            EXPECT_LT(window->to, descent_window(w_e, mu, g) + 5.0 * (1.0 + mu) * w_e / g);
        }
}

TEST(SteadyDescent, SeesASlowDecayThatTheBalanceDoesNotHold) {
    // Forces that come and go with a breathing canopy: at each instant drag carries what it has to, yet the
    // speed goes down by exp(-t/tau). Within a window of 3.14 s it drifts by less than the limit from the
    // second half of it on.
    const double w_e = 7.7;
    for (const double tau : {0.5, 2.0, 5.0, 15.0, 40.0}) {
        const auto window =
            first_steady([&](double t) { return fall_at(t, w_e * (1.0 + 0.03 * std::exp(-t / tau))); });
        ASSERT_TRUE(window) << tau;
        EXPECT_NEAR(window->rate, w_e, 0.005 * w_e) << tau;
    }
}

TEST(SteadyDescent, WaitsForASwingToDecay) {
    // A pendulum across lowers the rate by s^2/(8 w^2) in the mean: 12 % at first.
    const double w_e = 5.0, period = 6.0, omega = 2.0 * pi / period;
    for (const double decay : {1.0, 4.0, 10.0}) {  // periods
        const auto window = first_steady([&](double t) {
            const double most = w_e * std::exp(-t / (decay * period));
            const double s = most * std::sin(omega * t);
            FallSample now = fall_at(t, carried(w_e, s), s);
            now.swing = most * most;
            now.period = period;
            return now;
        });
        ASSERT_TRUE(window) << decay;
        EXPECT_NEAR(window->rate, w_e, 0.005 * w_e) << decay;
    }
}

TEST(SteadyDescent, TakesTheMeanOfALimitCycle) {
    // The swing stays, and so does what it takes from the rate. Its mean over whole periods:
    const double w_e = 5.0, period = 6.0, s_0 = 0.6 * w_e;
    const auto at = [&](double t) { return carried(w_e, s_0 * std::sin(2.0 * pi / period * t)); };
    double mean = 0.0;
    for (int k = 0; k < 1000; ++k)
        mean += at(period * k / 1000.0) / 1000.0;
    ASSERT_LT(mean, 0.97 * w_e);
    const auto window = first_steady([&](double t) {
        const double s = s_0 * std::sin(2.0 * pi / period * t);
        FallSample now = fall_at(t, at(t), s);
        now.swing = s_0 * s_0;
        now.period = period;
        return now;
    });
    ASSERT_TRUE(window);
    EXPECT_NEAR(window->rate, mean, 0.005 * mean);
    EXPECT_GT(window->amplitude, steady_descent_amplitude);
    EXPECT_GE(window->to - window->from, 6.0 * period - 0.1);  // no fewer than show that it does not decay
}

TEST(SteadyDescent, IsNotSteadyWhileASwingGrows) {
    // A swing that doubles in 20 s takes from the rate what it now does not, long before it is half as large.
    const double w_e = 5.0, period = 6.0;
    const auto growing = [&](double t) {
        const double most = 0.25 * w_e * std::exp2((t - 40.0) / 20.0);
        const double s = most * std::sin(2.0 * pi / period * t);
        FallSample now = fall_at(t, carried(w_e, s), s);
        now.swing = most * most;
        now.period = period;
        return now;
    };
    const Environment air = uniform_air();
    SteadyDescent judge(air);
    for (int k = 0; k * step < 80.0; ++k) {
        judge.add(growing(k * step));
        const auto window = judge.judge(0.0);
        if (k * step > 25.0 && window) {
            ASSERT_FALSE(window->is_steady()) << k * step;
        }
    }
}

TEST(SteadyDescent, WaitsForAGlideToGo) {
    // Lift turns the force across the path: w = w_e cos^1.5 gamma, of which the balance of drag and weight
    // holds a third, since it takes V w = w_e^2 cos^2 gamma for the drag's. One that lasts for a minute shows
    // no trend: without the rest, a rate 0.75 % low would pass.
    const double w_e = 7.0;
    for (const double tau : {5.0, 15.0, 40.0}) {
        const auto window = first_steady([&](double t) {
            const double gamma = 0.1 * std::exp(-std::max(0.0, t - 60.0) / tau);
            const double w = w_e * std::pow(std::cos(gamma), 1.5);
            FallSample now = fall_at(t, w, w * std::tan(gamma));
            now.across = {0.6 * w * std::tan(gamma), -0.8 * w * std::tan(gamma)};
            return now;
        });
        ASSERT_TRUE(window) << tau;
        EXPECT_NEAR(window->rate, w_e, 0.005 * w_e) << tau;
    }
}

/// Breathes five times a second with a force that lasts, mu = 0.3 + 0.1 cos and dw_a/dt against it, and
/// shifts the rate by r [-] from w_e = u_b.
FallSample breathing_at(double t, double w_e, double r) {
    const double omega = 2.0 * pi / 0.2, push = -4.0 * g * r / 0.1;
    FallSample now = fall_at(t, w_e * (1.0 + r), 0.0, push / omega * std::sin(omega * t));
    now.system_sink = 0.0;
    now.added_mass_ratio = 0.3 + 0.1 * std::cos(omega * t);
    return now;
}

TEST(SteadyDescent, WaitsForACanopyThatStillFills) {
    // Nothing in the speed tells of a canopy that fell in and fills again while its drag area is prescribed.
    // Its area grows by 2 % a second for a minute, which is 5 % from half to half of a window of 5 s and
    // more; then it breathes by a fifth, five times a second, of which means over whole periods see nothing.
    const double w_e = 1.3 * g;
    const auto filling = [&](double t) {
        FallSample now = fall_at(t, w_e);
        now.area = 100.0 * std::exp(0.02 * std::min(t, 60.0)) * (1.0 + 0.2 * std::cos(10.0 * pi * t));
        return now;
    };
    const auto window = first_steady(filling);
    ASSERT_TRUE(window);
    // Half of the window, 2.6 s, may hold 1 % of growth for each 0.5 s before the end: 5 % is left behind.
    EXPECT_GT(window->to, 60.0);
    EXPECT_LT(window->to, 60.0 + descent_window(w_e, 0.0, g));
    EXPECT_LT(std::abs(window->filling), steady_descent_filling);

    const Environment air = uniform_air();
    SteadyDescent judge(air);
    for (int k = 0; k < 2000; ++k)
        judge.add(filling(k * step));
    const auto last = judge.judge(0.0);
    ASSERT_TRUE(last);
    // exp(0.02 (5.2 s)/2) - 1, and a hundredth of it for halves that cut a period.
    EXPECT_NEAR(last->filling, std::expm1(0.02 * 0.5 * descent_window(w_e, 0.0, g)), 0.01);
    EXPECT_NE(unsteadiness_text(last).find("projected area"), std::string::npos) << unsteadiness_text(last);
}

TEST(SteadyDescent, WaitsForABreathThatGrows) {
    // Nothing damps it: the area of the canopy, which breathes five times a second, varies by a tenth more
    // each second, and after a minute by 2 % less. Its mean is the same in all windows, and so is the speed.
    const double w_e = 1.3 * g;
    const auto breathing = [&](double rms) {
        return [=](double t) {
            FallSample now = fall_at(t, w_e);
            const double grown = std::exp(0.1 * (std::min(t, 60.0) - 60.0) - 0.02 * std::max(0.0, t - 60.0));
            now.area = 100.0 * (1.0 + std::sqrt(2.0) * rms * grown * std::cos(10.0 * pi * t));
            return now;
        };
    };
    const double longest = 58.0, half = 0.5 * descent_window(w_e, 0.0, g);
    const Environment air = uniform_air();
    SteadyDescent judge(air);
    // From when on it is large enough to be looked at: 0.5 % in 11 % that it comes to, ln(22)/0.1 = 31 s
    // before its end.
    const auto fall = breathing(0.11);
    for (int k = 0; k * step < longest; ++k) {
        judge.add(fall(k * step));
        if (k * step < 33.0) continue;
        const auto window = judge.judge(0.0);
        ASSERT_TRUE(window && !window->is_steady()) << k * step;
    }
    const auto last = judge.judge(0.0);
    // Rows lie a tenth of a period apart, so that a half may be off by as much at either end.
    EXPECT_NEAR(last->breath[1] / last->breath[0], std::exp(0.1 * half), 0.02);
    EXPECT_NEAR(last->breath[1], 0.11 * std::exp(0.1 * (longest - 60.0 - 0.5 * half)), 0.02 * 0.11);
    EXPECT_NE(unsteadiness_text(last).find("breathing_damping"), std::string::npos)
        << unsteadiness_text(last);
    // Once it dies out it is steady, although it is as large; and one that is small is at once.
    for (double t = longest; t < 60.0 + 4.0 * half; t += step)
        judge.add(fall(t));
    EXPECT_TRUE(judge.judge(0.0)->is_steady());
    EXPECT_TRUE(first_steady(breathing(0.004), 10.0));
}

TEST(SteadyDescent, IsNotSteadyWhileItBreathesOn) {
    // Breathing adds 0.2 % to the rate now, less than may remain; but that goes with the square of an
    // amplitude that nothing holds. A window of 4 w/g = 3 s has whole periods in each of its thirds.
    const double w_e = 0.75 * g;
    const Environment air = uniform_air();
    SteadyDescent judge(air);
    std::optional<DescentWindow> last;
    for (int k = 0; k < 6000; ++k) {
        judge.add(breathing_at(k * step, w_e, 0.002));
        last = judge.judge(0.0);
        ASSERT_FALSE(last && last->is_steady()) << k * step;
    }
    ASSERT_TRUE(last);
    // Rows lie 0.02 s apart, a tenth of a period: of the force in the last one, 1 % of that in the window.
    EXPECT_NEAR(last->breathing, 3.0 * 0.002, 0.02 * 0.006);
    EXPECT_NE(unsteadiness_text(last).find("breathing_damping"), std::string::npos)
        << unsteadiness_text(last);
    // Where it decays, or is small, it does no harm.
    for (const double r : {0.01, 0.0005}) {
        const auto window =
            first_steady([&](double t) { return breathing_at(t, w_e, r * std::exp(-t / 8.0)); });
        ASSERT_TRUE(window) << r;
        EXPECT_NEAR(window->rate, w_e, 1.02 * steady_descent_remaining / 4.0 * w_e) << r;
    }
}

TEST(SteadyDescent, IsNotSteadyWhileACanopyGrowsTowardsItsAccretion) {
    // It holds less air than it once did, so that none has to be brought to speed yet; but it grows by 0.7 %
    // a second, which will take mu w^2 0.7 %/(2 g w) of the rate, 1 %.
    const double w_e = 2.5;
    const auto growing = [&](double rate) {
        return [&, rate](double t) {
            FallSample now = fall_at(t, w_e);
            now.added_mass_ratio = 11.0 * std::exp(rate * t);
            now.growth = 11.0 * rate * std::exp(rate * t);
            return now;
        };
    };
    EXPECT_FALSE(first_steady(growing(0.007), 60.0));
    EXPECT_TRUE(first_steady(growing(0.0001), 60.0));
    // Denser air below belongs to a steady fall: 0.7 % a second is what it does at 56 m/s.
    EXPECT_TRUE(first_steady(
        [&](double t) {
            FallSample now = growing(0.007)(t);
            now.density = std::exp(0.007 * t);
            now.sink = now.airspeed = w_e * std::exp(-0.0035 * t);
            return now;
        },
        60.0));
}

TEST(SteadyDescent, MeansOverBeatsAndNoise) {
    // Bounces of 4 % that beat, and noise of 2 %: neither moves the mean.
    const double w_e = 7.7;
    std::mt19937_64 generator(1);
    std::normal_distribution<double> normal(0.0, 0.02);
    const std::function<FallSample(double)> beat = [&](double t) {
        const double w = w_e * (1.0 + 0.02 * std::sin(5.0 * t) + 0.02 * std::sin(5.5 * t));
        return fall_at(t, w);
    };
    const std::function<FallSample(double)> noise = [&](double t) {
        return fall_at(t, w_e * (1.0 + normal(generator)));
    };
    for (const auto& fall : {beat, noise}) {
        const auto window = first_steady(fall);
        ASSERT_TRUE(window);
        EXPECT_NEAR(window->rate, w_e, 0.005 * w_e);
        EXPECT_GT(window->amplitude, steady_descent_amplitude);
    }
}

/// A fall in the standard atmosphere from 12 km on, in equilibrium but for its inertia; [m/s] at sea level.
struct Fast {
    double at_sea_level;
    double altitude = 12e3, sink = 0.0;

    void fly(const Environment& air, double dt) {
        const auto rate = [&](double z, double w) {
            const double e = at_sea_level / std::sqrt(air.atmosphere.at(z).density / 1.225);
            return g * (1.0 - w * w / (e * e));
        };
        const double w = sink + 0.5 * dt * rate(altitude, sink);
        sink += dt * rate(altitude - 0.5 * dt * sink, w);
        altitude -= dt * w;
    }
};

TEST(SteadyDescent, ComparesAtEqualDensityInThinAir) {
    // 1 + lag above the equilibrium, lag = w^2/(4 g H): 2.6 % at 12 km, 0.9 % at the ground. Steady where the
    // rest of it goes by less than the limit within a minute; what a minute later is so is the truth.
    Environment air;
    air.atmosphere.model = find_atmosphere("us76");
    air.gravity = g;
    Fast fall{55.0};
    SteadyDescent judge(air);
    std::optional<DescentWindow> window;
    double time = 0.0, density = 0.0;
    for (; fall.altitude > 0.0 && !window; time += step) {
        FallSample now = fall_at(time, fall.sink, 0.0, fall.sink);
        density = now.density = air.atmosphere.at(fall.altitude).density;
        judge.add(now);
        window = judge.judge(fall.altitude);
        if (window && !window->is_steady()) window.reset();
        fall.fly(air, step);
    }
    ASSERT_TRUE(window);
    const double lag = density_lag(air, fall.altitude, fall.sink, 0.0);
    EXPECT_NEAR(fall.sink * std::sqrt(density / 1.225), 55.0 * (1.0 + lag), 0.0015 * 55.0);
    Fast later = fall;
    for (double t = 0.0; t < 60.0 && later.altitude > 0.0; t += step)
        later.fly(air, step);
    const double then = later.sink * std::sqrt(air.atmosphere.at(later.altitude).density);
    EXPECT_NEAR(fall.sink * std::sqrt(density), then, 0.005 * then);
}

TEST(SteadyDescent, LooksForWindBelow) {
    Environment air = uniform_air();
    air.ground = 0.0;
    const double w = 7.7, way = w * w / g;
    // 0.1 m/s a metre between 100 and 200 m: 0.1 w^2/g across, half its square over that of w.
    air.wind = Wind{{{100.0, Vec3::Zero()}, {200.0, Vec3(6.0, 8.0, 0.0)}}};
    EXPECT_NEAR(change_below(air, 400.0, w, 0.0), 0.5 * std::pow(0.1 * way / w, 2), 1e-12);
    EXPECT_EQ(change_below(air, 90.0, w, 0.0), 0.0);   // it is above
    EXPECT_EQ(change_below(air, 700.0, w, 0.0), 0.0);  // a minute is 462 m
    EXPECT_EQ(change_below(uniform_air(), 400.0, w, 0.0), 0.0);
    // Air that rises takes its speed from the rate over ground.
    air.wind = Wind{{{100.0, Vec3(0.0, 0.0, 0.77)}, {200.0, Vec3::Zero()}}};
    EXPECT_NEAR(change_below(air, 400.0, w, 0.0), 0.1, 1e-12);
}

TEST(SteadyDescent, MeansOverGroundInAirThatRises) {
    const auto window = first_steady([](double t) {
        FallSample now = fall_at(t, 7.7);
        now.updraft = 1.2;
        return now;
    });
    ASSERT_TRUE(window);
    EXPECT_NEAR(window->rate, 6.5, 1e-9);
}

TEST(SteadyDescent, JudgesNothingShorterThanItsWindow) {
    const Environment air = uniform_air();
    SteadyDescent judge(air);
    const double whole = descent_window(7.7, 0.0, g);
    for (int k = 0; k * step < 0.99 * whole; ++k) {
        judge.add(fall_at(k * step, 7.7));
        ASSERT_FALSE(judge.judge(0.0));
    }
    judge.add(fall_at(1.01 * whole, 7.7));
    ASSERT_TRUE(judge.judge(0.0));
    judge.restart();
    judge.add(fall_at(1.02 * whole, 7.7));
    EXPECT_FALSE(judge.judge(0.0));
    EXPECT_NE(unsteadiness_text({}).find("4 v/g"), std::string::npos);
}

TEST(SteadyDescent, GoesOnFromACheckpointToTheSameBits) {
    const Environment air = uniform_air();
    SteadyDescent whole(air), before(air);
    const auto fall = [](double t) {
        return fall_at(t, 7.7 * (1.0 + std::exp(-t)), std::sin(t), std::exp(-t));
    };
    for (int k = 0; k < 700; ++k) {
        whole.add(fall(k * step));
        before.add(fall(k * step));
    }
    Archive out;
    before.serialize(out);
    const std::string kept = out.take();
    SteadyDescent after(air);
    Archive in(kept, "here");
    after.serialize(in);
    in.end();
    for (int k = 700; k < 900; ++k) {
        whole.add(fall(k * step));
        after.add(fall(k * step));
    }
    const auto a = whole.judge(0.0), b = after.judge(0.0);
    ASSERT_TRUE(a && b);
    EXPECT_EQ(a->rate, b->rate);
    EXPECT_EQ(a->remaining, b->remaining);
    EXPECT_EQ(a->drift, b->drift);
    EXPECT_EQ(a->amplitude, b->amplitude);
    EXPECT_EQ(a->from, b->from);
}

}  // namespace
}  // namespace twinchute
