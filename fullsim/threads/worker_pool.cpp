#include "fullsim/threads/worker_pool.hpp"

#include <hwy/cache_control.h>
#include <chrono>

namespace twinchute::fullsim {
namespace {

/// Until the number is no longer `old`. Between two passes of a step lie microseconds, a tenth of a
/// millisecond on a mesh of 40 000 triangles; to be woken takes as long.
void wait_until_not(const std::atomic<unsigned>& number, unsigned old) {
    constexpr std::chrono::microseconds patience(500);
    constexpr int looks = 1000;  // 10 to 60 us
    const auto began = std::chrono::steady_clock::now();
    do {
        for (int k = 0; k < looks; ++k) {
            if (number.load(std::memory_order_acquire) != old) return;
            hwy::Pause();
        }
    } while (std::chrono::steady_clock::now() - began < patience);
    number.wait(old);
}

void tell(std::atomic<unsigned>& number, unsigned value) {
    number.store(value);
    number.notify_all();  // asks the kernel only if somebody sleeps
}

}  // namespace

WorkerPool::WorkerPool(int others) : done_(others) {
    for (int k = 0; k < others; ++k)
        others_.emplace_back([this, k] { stand_ready(k); });
}

WorkerPool::~WorkerPool() {
    begin({});
    for (std::thread& other : others_)
        other.join();
}

void WorkerPool::begin(const Job& job) {
    const unsigned number = begun_.jobs.load(std::memory_order_relaxed) + 1;
    begun_.last = job;
    tell(begun_.jobs, number);
    if (job.work) do_share(0);
    for (const Done& done : done_)
        wait_until_not(done.jobs, number - 1);
}

void WorkerPool::stand_ready(int other) {
    for (unsigned number = 1;; ++number) {
        wait_until_not(begun_.jobs, number - 1);
        const bool end = !begun_.last.work;
        if (!end) do_share(1 + other);
        tell(done_[other].jobs, number);
        if (end) return;
    }
}

void WorkerPool::do_share(int thread) const {
    const Job& job = begun_.last;
    const int threads = 1 + static_cast<int>(others_.size());
    const auto first_of = [&](int t) { return job.parts * t / threads; };
    for (int part = first_of(thread); part < first_of(thread + 1); ++part)
        job.work(job.of, part);
}

}  // namespace twinchute::fullsim
