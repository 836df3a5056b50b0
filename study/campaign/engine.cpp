#include "study/campaign/engine.hpp"

#include <algorithm>
#include <exception>
#include <limits>
#include <mutex>
#include <thread>

namespace twinchute::study {

void Engine::make_row(Design& design, Scene& scene, std::uint64_t run, std::span<double> row) const {
    const std::span<double> values = row.subspan(1, columns.inputs),
                            metrics = row.subspan(columns.first_metric());
    std::ranges::fill(metrics, std::numeric_limits<double>::quiet_NaN());
    design.values(run, values);
    Run asked{stop, {}};
    try {
        sampler.put(scene, values);
        if (fidelity.metrics) {
            row[0] = static_cast<double>(fidelity.metrics(scene, asked, columns.metrics, metrics).code);
            return;
        }
        const RunRecord record = fidelity.run(scene, asked);
        row[0] = static_cast<double>(record.status.code);
        for (std::size_t i = 0; i < metrics.size(); ++i)
            if (const auto value = record.metric(columns.metrics[i])) metrics[i] = *value;
    } catch (const SceneError&) {
        row[0] = static_cast<double>(refused_inputs);
        scene = sampler.blank();
    }
}

bool Engine::make_chunk(Design& design, Scene& scene, std::uint64_t first, std::span<double> rows) const {
    const std::size_t width = 1 + columns.inputs + columns.metrics.size();
    for (std::size_t i = 0; i < rows.size() / width; ++i) {
        if (stop.stop_requested()) return false;
        make_row(design, scene, first + i, rows.subspan(i * width, width));
    }
    return !stop.stop_requested();
}

bool Engine::run(const RunStore& store, std::uint64_t runs) const {
    const std::uint64_t chunks = store.chunks_of(runs);
    std::atomic<std::uint64_t> next{shard};
    std::atomic<bool> ended{false};
    std::mutex lock;
    std::exception_ptr thrown;
    const auto work = [&] {
        try {
            Design design(spec);
            Scene scene = sampler.blank();
            RunStore::Rows rows;
            while (!ended) {
                const std::uint64_t chunk = next.fetch_add(shards);
                if (chunk >= chunks) return;
                const std::uint64_t count = store.rows_of(chunk, runs);
                if (RunStore::Rows there = store.read(chunk, count); !there.empty()) {
                    const std::scoped_lock guard(lock);
                    if (made) made(there);
                    continue;
                }
                rows.assign(count * store.columns(), 0.0);
                if (!make_chunk(design, scene, chunk * store.identity().chunk, rows)) {
                    ended = true;
                    return;
                }
                store.write(chunk, rows);
                const std::scoped_lock guard(lock);
                if (made) made(rows);
            }
        } catch (...) {
            const std::scoped_lock guard(lock);
            if (!thrown) thrown = std::current_exception();
            ended = true;
        }
    };
    {
        std::vector<std::jthread> workers;
        for (int i = 1; i < threads; ++i)
            workers.emplace_back(work);
        work();
    }
    if (thrown) std::rethrow_exception(thrown);
    return !ended;
}

}  // namespace twinchute::study
