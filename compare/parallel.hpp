// Independent pieces of work on several threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <thread>
#include <vector>

namespace twinchute::compare {

/// Threads that this machine runs at once; 1 where it does not say.
inline int processors() {
    return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

/// Calls work(i) for i = 0 ... count - 1, on `threads` threads at most, and throws what the first of them
/// that failed threw. What the pieces write must not be shared.
template <class Work>
void in_parallel(std::size_t count, int threads, const Work& work) {
    std::vector<std::exception_ptr> errors(count);
    std::atomic<std::size_t> next{0};
    const auto take = [&] {
        for (std::size_t i = next++; i < count; i = next++) {
            try {
                work(i);
            } catch (...) {
                errors[i] = std::current_exception();
            }
        }
    };
    {
        std::vector<std::jthread> others;
        const auto most = std::min<std::size_t>(count, static_cast<std::size_t>(std::max(threads, 1)));
        for (std::size_t i = 1; i < most; ++i)
            others.emplace_back(take);
        take();
    }
    for (const std::exception_ptr& error : errors)
        if (error) std::rethrow_exception(error);
}

}  // namespace twinchute::compare
