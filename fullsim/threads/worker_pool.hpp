// Threads that stand ready between the passes of a step. A pass takes microseconds, for which a region of
// OpenMP costs too much: 1.2 us to begin and end together, of which a number that one thread writes and the
// other watches needs 0.6 (docs/cost.md). Who waits for long goes to sleep.
#pragma once

#include <atomic>
#include <memory>
#include <thread>
#include <vector>

namespace twinchute::fullsim {

class WorkerPool {
public:
    /// So many beside the one that calls.
    explicit WorkerPool(int others);
    WorkerPool(const WorkerPool&) = delete;
    WorkerPool& operator=(const WorkerPool&) = delete;
    ~WorkerPool();

    /// work(part) for all of them, each thread some that follow each other, the caller the first; ends when
    /// all are done. It must not throw.
    template <class Work>
    void share(int parts, const Work& work) {
        begin({[](const void* of, int part) { (*static_cast<const Work*>(of))(part); }, &work, parts});
    }

private:
    struct Job {
        void (*work)(const void* of, int part) = nullptr;  // null: the end
        const void* of = nullptr;
        int parts = 0;
    };
    /// Each on lines of its own: a number that others watch costs whoever writes beside it. What goes with it
    /// comes with it.
    struct alignas(128) Begun {
        std::atomic<unsigned> jobs = 0;
        Job last;
    };
    struct alignas(128) Done {
        std::atomic<unsigned> jobs = 0;
    };

    void begin(const Job& job);
    void stand_ready(int other);
    void do_share(int thread) const;

    Begun begun_;
    std::vector<Done> done_;  // by each other thread
    std::vector<std::thread> others_;
};

}  // namespace twinchute::fullsim
