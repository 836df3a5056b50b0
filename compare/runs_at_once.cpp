#include "compare/runs_at_once.hpp"

#include <algorithm>
#include <mutex>
#include <numeric>

#include "compare/parallel.hpp"
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
    Together together(jobs.size(), progress);
    std::vector<const Fidelity*> all;  // that may fly the rest of a fall
    for (const RunJob& job : jobs)
        if (std::ranges::find(all, job.fidelity) == all.end()) all.push_back(job.fidelity);
    in_parallel(jobs.size(), threads, [&](std::size_t i) {
        Run run{stop, together.of(i)};
        records[i] = run_scene(*jobs[i].fidelity, jobs[i].scene, run, all);
        together.ended(i);
    });
    return records;
}

}  // namespace twinchute::compare
