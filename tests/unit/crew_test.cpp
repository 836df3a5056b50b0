// How many threads take a step: by what steps take, given here.
#include <gtest/gtest.h>

#include "fullsim/gores/crew.hpp"

namespace twinchute::fullsim {
namespace {

/// Steps on an otherwise idle machine, [s] with one thread and with more.
double idle(int threads) {
    return threads == 1 ? 50e-6 : 30e-6;
}
/// Where others have the second processor: it waits for its turn.
double crowded(int threads) {
    return threads == 1 ? 50e-6 : 5e-3;
}

template <class Cost>
double total(Crew& crew, int steps, Cost&& cost) {
    double sum = 0.0;
    for (int i = 0; i < steps; ++i) {
        const double seconds = cost(crew.now());
        sum += seconds;
        crew.took(seconds);
    }
    return sum;
}

TEST(Crew, OfOneStaysSo) {
    Crew crew(1);
    total(crew, 2000, idle);
    EXPECT_EQ(crew.now(), 1);
}

TEST(Crew, WorksWhereItPays) {
    // All but the trials of eight steps with one thread; 1 % more is what they may cost.
    Crew crew(2);
    EXPECT_LT(total(crew, 50'000, idle), 1.01 * 50'000 * idle(2));
}

TEST(Crew, IsHardlySlowerThanOneWhereItDoesNot) {
    // Trials end with their first step; there are nine of them in so many steps, the last ones 8000 apart.
    Crew crew(2);
    EXPECT_LT(total(crew, 50'000, crowded), 50'000 * crowded(1) + 10 * crowded(2));
}

TEST(Crew, NoticesWhenOthersCome) {
    Crew crew(2);
    total(crew, 3000, idle);
    ASSERT_EQ(crew.now(), 2);
    EXPECT_LT(total(crew, 400, crowded), 400 * crowded(1) + 3 * crowded(2));
    EXPECT_EQ(crew.now(), 1);
    // And when they go again: at the next trial, 500 steps on.
    total(crew, 600, idle);
    EXPECT_EQ(crew.now(), 2);
}

TEST(Crew, ForgivesASingleLongStep) {
    // One in which a frame was written, say.
    Crew crew(2);
    total(crew, 100, idle);
    ASSERT_EQ(crew.now(), 2);
    crew.took(0.1);
    EXPECT_EQ(crew.now(), 2);
}

}  // namespace
}  // namespace twinchute::fullsim
