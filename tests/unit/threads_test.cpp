// How many threads take a step: by what steps take, given here. And those threads.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>
#include <vector>

#include "fullsim/threads/thread_count_tuner.hpp"
#include "fullsim/threads/worker_pool.hpp"

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
double total(ThreadCountTuner& tuner, int steps, Cost&& cost) {
    double sum = 0.0;
    for (int i = 0; i < steps; ++i) {
        const double seconds = cost(tuner.now());
        sum += seconds;
        tuner.took(seconds);
    }
    return sum;
}

TEST(ThreadCountTuner, OfOneStaysSo) {
    ThreadCountTuner tuner(1);
    total(tuner, 2000, idle);
    EXPECT_EQ(tuner.now(), 1);
}

TEST(ThreadCountTuner, TakesTimesByItself) {
    // After eight steps with one thread, which end as the ninth begins, it tries two.
    ThreadCountTuner tuner(2);
    for (int step = 0; step < 8; ++step) {
        tuner.begin_step();
        EXPECT_EQ(tuner.now(), 1);
    }
    tuner.begin_step();
    EXPECT_EQ(tuner.now(), 2);
}

TEST(ThreadCountTuner, WorksWhereItPays) {
    // All but the trials of eight steps with one thread; 1 % more is what they may cost.
    ThreadCountTuner tuner(2);
    EXPECT_LT(total(tuner, 50'000, idle), 1.01 * 50'000 * idle(2));
}

TEST(ThreadCountTuner, IsHardlySlowerThanOneWhereItDoesNot) {
    // Trials end with their first step; there are nine of them in so many steps, the last ones 8000 apart.
    ThreadCountTuner tuner(2);
    EXPECT_LT(total(tuner, 50'000, crowded), 50'000 * crowded(1) + 10 * crowded(2));
}

TEST(ThreadCountTuner, ForgivesThatOthersHaveToWake) {
    // 0.05 to 1.1 ms were seen, forty times what a step takes.
    ThreadCountTuner tuner(2);
    auto sleepy = [before = 1](int threads) mutable {
        const bool wake = threads > std::exchange(before, threads);
        return idle(threads) + (wake ? 1e-3 : 0.0);
    };
    // Seven trials, and 1 % as above.
    EXPECT_LT(total(tuner, 50'000, sleepy), 1.01 * 50'000 * idle(2) + 10 * 1e-3);
}

TEST(ThreadCountTuner, NoticesWhenOthersCome) {
    ThreadCountTuner tuner(2);
    total(tuner, 3000, idle);
    ASSERT_EQ(tuner.now(), 2);
    EXPECT_LT(total(tuner, 400, crowded), 400 * crowded(1) + 3 * crowded(2));
    EXPECT_EQ(tuner.now(), 1);
    // And when they go again: at the next trial, 500 steps on.
    total(tuner, 600, idle);
    EXPECT_EQ(tuner.now(), 2);
}

TEST(ThreadCountTuner, IsHardlySlowerThanOneWhereOthersComeAndGo) {
    // Two other programs on both processors: for 3 ms all threads run, then one of them waits as long for its
    // turn. A program with one thread has its processor for half of the time as well, so that each step
    // counts as long as on an idle machine, and what waiting adds is lost: 3 ms of 6, more than is gained.
    ThreadCountTuner tuner(2);
    auto shared = [gone = 0.0](int threads) mutable {
        if (threads == 1) return idle(1);
        gone += idle(threads);
        if (gone < 3e-3) return idle(threads);
        gone = 0.0;
        return idle(threads) + 3e-3;
    };
    EXPECT_LT(total(tuner, 50'000, shared), 1.05 * 50'000 * idle(1));
}

TEST(ThreadCountTuner, StaysWithOneWhereMoreAreALittleSlower) {
    // Half of a step more: none is far too long.
    ThreadCountTuner tuner(2);
    const auto slower = [](int threads) { return idle(1) * (threads == 1 ? 1.0 : 1.5); };
    EXPECT_LT(total(tuner, 50'000, slower), 1.01 * 50'000 * idle(1));
}

TEST(ThreadCountTuner, ForgetsTroubleOnceAllHaveWorkedForLong) {
    ThreadCountTuner tuner(2);
    total(tuner, 20'000, crowded);  // rests 8000 steps at a time by then
    total(tuner, 30'000, idle);
    ASSERT_EQ(tuner.now(), 2);
    total(tuner, 400, crowded);
    ASSERT_EQ(tuner.now(), 1);
    total(tuner, 600, idle);  // a first rest again: 500 steps
    EXPECT_EQ(tuner.now(), 2);
}

TEST(ThreadCountTuner, TriesAgainSoonAfterTrouble) {
    ThreadCountTuner tuner(2);
    total(tuner, 40'000, idle);  // all work 8000 steps at a time by then
    total(tuner, 400, crowded);
    total(tuner, 600, idle);
    ASSERT_EQ(tuner.now(), 2);
    int alone = 0;
    const auto counted = [&alone](int threads) {
        alone += threads == 1;
        return idle(threads);
    };
    total(tuner, 700, counted);
    EXPECT_EQ(alone, 8);  // one trial, 500 steps on
}

TEST(ThreadCountTuner, ForgivesASingleLongStep) {
    // One in which a frame was written, say.
    ThreadCountTuner tuner(2);
    total(tuner, 100, idle);
    ASSERT_EQ(tuner.now(), 2);
    tuner.took(0.1);
    EXPECT_EQ(tuner.now(), 2);
}

TEST(WorkerPool, DoEachPartOnceAndSeeWhatWasDoneBefore) {
    using namespace std::chrono_literals;
    for (int others = 0; others < 4; ++others)
        for (int parts = 1; parts < 10; ++parts) {
            WorkerPool threads(others);
            // Plain numbers: that they are right says that each pass saw the one before.
            std::vector<int> part(parts, 0), by_next(parts, 0);
            for (int pass = 0; pass < 60; ++pass) {
                if (pass == 30) std::this_thread::sleep_for(2ms);  // by then others are asleep
                const auto add = [&](int k) { part[k] += 1 + pass; };
                const auto look = [&](int k) { by_next[k] = part[(k + 1) % parts]; };
                threads.share(parts, add);
                threads.share(parts, look);
                const int expected = (pass + 1) * (pass + 2) / 2;
                ASSERT_EQ(by_next, std::vector(parts, expected)) << others << " others, pass " << pass;
            }
        }
}

TEST(WorkerPool, GiveEachThreadPartsThatFollowEachOther) {
    // Seven blocks of gores for two threads: three and four, the same ones in each pass.
    WorkerPool threads(1);
    std::vector<std::thread::id> by(7);
    const auto note = [&](int k) { by[k] = std::this_thread::get_id(); };
    threads.share(7, note);
    const auto caller = std::this_thread::get_id();
    EXPECT_EQ(std::ranges::count(by, caller), 3);
    EXPECT_TRUE(std::ranges::all_of(by.begin(), by.begin() + 3, [&](auto id) { return id == caller; }));
    EXPECT_TRUE(std::ranges::all_of(by.begin() + 3, by.end(), [&](auto id) { return id == by[3]; }));
}

}  // namespace
}  // namespace twinchute::fullsim
