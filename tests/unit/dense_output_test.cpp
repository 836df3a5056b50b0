// The state inside a step: orders on a solution in closed form, and steps in which positions are lost in
// rounding.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "lib/solve/dense_output.hpp"

namespace twinchute {
namespace {

/// x = sin t, v = cos t as two blocks of one position each, the second of twice the size.
using State = std::array<double, 4>;
State state_at(double t) {
    return {std::sin(t), std::cos(t), 2.0 * std::sin(t), 2.0 * std::cos(t)};
}
State rate_at(double t) {
    return {std::cos(t), -std::sin(t), 2.0 * std::cos(t), -2.0 * std::sin(t)};
}

/// Largest errors of position and velocity in a step of h from t = 0.4, of both blocks.
struct Errors {
    double position = 0.0, velocity = 0.0;
};
Errors errors(double h, int space) {
    const double a = 0.4, b = a + h;
    const State y0 = state_at(a), f0 = rate_at(a), y1 = state_at(b), f1 = rate_at(b);
    Errors worst;
    for (int i = 0; i <= 64; ++i) {
        const double t = a + h * i / 64.0;
        State y;
        interpolate_step({a, b, y0, f0, y1, f1}, space, t, y);
        const State exact = state_at(t);
        for (std::size_t k = 0; k < 4; k += 2) {
            worst.position = std::max(worst.position, std::abs(y[k] - exact[k]));
            worst.velocity = std::max(worst.velocity, std::abs(y[k + 1] - exact[k + 1]));
        }
    }
    return worst;
}

TEST(DenseOutput, PositionsAreOfOrderSixVelocitiesOfOrderFive) {
    // The bounds of Hermite interpolation: h^6 max|x^(6)|/(720 * 64), and of its derivative
    // h^5 max|x^(6)|/720 max|d/ds (s(1 - s))^3|, = 0.0537; both blocks, the larger |x^(6)| is 2 sin t.
    for (const double h : {0.4, 0.2}) {
        const double sixth = 2.0 * std::sin(0.4 + h);
        EXPECT_LT(errors(h, 1).position, std::pow(h, 6) * sixth / (720.0 * 64.0) * 1.001);
        EXPECT_LT(errors(h, 1).velocity, std::pow(h, 5) * sixth / 720.0 * 0.0538);
    }
    // From above by the change of x^(6) over the step, 3 % of an order.
    EXPECT_NEAR(std::log2(errors(0.2, 1).position / errors(0.1, 1).position), 6.0, 0.2);
    EXPECT_NEAR(std::log2(errors(0.2, 1).velocity / errors(0.1, 1).velocity), 5.0, 0.2);
}

TEST(DenseOutput, SystemsOfFirstOrderAreOfOrderFour) {
    // h^4 max|y^(4)|/384.
    EXPECT_LT(errors(0.2, 0).position, std::pow(0.2, 4) * 2.0 * std::sin(0.6) / 384.0 * 1.001);
    EXPECT_NEAR(std::log2(errors(0.2, 0).position / errors(0.1, 0).position), 4.0, 0.2);
}

TEST(DenseOutput, TheEndsAreMetToTheBit) {
    const State y0{1.0, 2.0, 3.0, 4.0}, y1{1.3, 2.1, 3.7, 4.4}, f{2.0, 0.1, 4.0, 0.2};
    for (const int space : {0, 1, 2}) {
        State y;
        interpolate_step({0.1, 0.3, y0, f, y1, f}, space, 0.1, y);
        EXPECT_EQ(y, y0);
        interpolate_step({0.1, 0.3, y0, f, y1, f}, space, 0.3, y);
        EXPECT_EQ(y, y1);
    }
}

TEST(DenseOutput, PlacesLostInRoundingDoNotShowInVelocities) {
    // A steady climb of 1 m/s at 3e4 m for 1e-12 s: the way is less than the spacing of doubles there,
    // 3.6e-12 m; taken seriously, the next one would ask for 30/16 (3.6 - 1) m/s more in the middle.
    const double z = 3e4;
    const std::array<double, 2> y0{z, 1.0}, y1{std::nextafter(z, 1e9), 1.0}, f{1.0, 0.0};
    std::array<double, 2> y{};
    interpolate_step({0.0, 1e-12, y0, f, y1, f}, 1, 0.5e-12, y);
    EXPECT_EQ(y[1], 1.0);
    EXPECT_NEAR(y[0], z, 4e-12);
}

}  // namespace
}  // namespace twinchute
