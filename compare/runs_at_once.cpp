#include "compare/runs_at_once.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <numeric>
#include <thread>

#include "lib/solve/hand_over.hpp"

namespace twinchute::compare {
namespace {

/// How far all runs are together.
class Together {
public:
    Together(std::size_t runs, const std::function<void(const Progress&)>& report)
        : share_(runs, 0.0), report_(report) {}

    std::function<void(const Progress&)> of(std::size_t run) {
        if (!report_) return {};
        return [this, run](const Progress& progress) { update(run, progress); };
    }

    void ended(std::size_t run) {
        if (report_) update(run, {"", 0.0, 1.0});
    }

private:
    void update(std::size_t run, const Progress& progress) {
        const std::lock_guard lock(mutex_);
        share_[run] = progress.share;
        const double all = std::accumulate(share_.begin(), share_.end(), 0.0);
        report_({"several runs", progress.time, all / static_cast<double>(share_.size())});
    }

    std::mutex mutex_;
    std::vector<double> share_;
    const std::function<void(const Progress&)>& report_;
};

}  // namespace

std::vector<RunRecord> run_jobs(std::span<const RunJob> jobs, int threads, const std::stop_token& stop,
                                const std::function<void(const Progress&)>& progress) {
    std::vector<RunRecord> records(jobs.size());
    std::vector<std::exception_ptr> thrown(jobs.size());
    Together together(jobs.size(), progress);
    std::vector<const Fidelity*> all;  // that may fly the rest of a fall
    for (const RunJob& job : jobs)
        if (std::ranges::find(all, job.fidelity) == all.end()) all.push_back(job.fidelity);
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
        for (std::size_t i = next++; i < jobs.size(); i = next++) {
            try {
                Run run{stop, together.of(i)};
                records[i] = run_scene(*jobs[i].fidelity, jobs[i].scene, run, all);
            } catch (...) {
                thrown[i] = std::current_exception();
            }
            together.ended(i);
        }
    };
    {
        const auto count = std::min<std::size_t>(jobs.size(), static_cast<std::size_t>(std::max(1, threads)));
        std::vector<std::jthread> others;
        for (std::size_t i = 1; i < count; ++i)
            others.emplace_back(work);
        work();
    }
    for (const std::exception_ptr& what : thrown)
        if (what) std::rethrow_exception(what);
    return records;
}

}  // namespace twinchute::compare
