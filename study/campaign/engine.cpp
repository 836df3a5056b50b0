#include "study/campaign/engine.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <future>
#include <limits>
#include <mutex>
#include <thread>
#include <utility>

namespace twinchute::study {
namespace {

/// Calls work() on so many threads. What one of them throws ends the others, and is thrown here.
void work_on(int threads, std::atomic<bool>& ended, const std::function<void()>& work) {
    std::mutex lock;
    std::exception_ptr thrown;
    const auto guarded = [&] {
        try {
            work();
        } catch (...) {
            const std::scoped_lock guard(lock);
            if (!thrown) thrown = std::current_exception();
            ended = true;
        }
    };
    {
        std::vector<std::jthread> workers;
        for (int i = 1; i < threads; ++i)
            workers.emplace_back(guarded);
        guarded();
    }
    if (thrown) std::rethrow_exception(thrown);
}

}  // namespace

void Engine::find_inputs(Design& design, std::uint64_t run, std::span<double> values) const {
    if (scores.empty()) return design.values(run, values);
    // A last batch that is not full repeats its last run.
    const std::uint64_t place = std::min(run, scores.size() / columns.inputs - 1);
    design.values_at(scores.subspan(place * columns.inputs, columns.inputs), values);
}

void Engine::count_unopened(std::span<double> row) const {
    const auto column = columns.of("unopened_parachutes");
    const bool ended = row[0] == static_cast<double>(StatusCode::completed) ||
                       row[0] == static_cast<double>(StatusCode::stopped_by_event);
    if (column && ended && std::isnan(row[*column])) row[*column] = 0.0;
}

void Engine::make_row(Design& design, Scene& scene, std::uint64_t run, std::span<double> row) const {
    const std::span<double> values = row.subspan(1, columns.inputs),
                            metrics = row.subspan(columns.first_metric());
    std::ranges::fill(metrics, std::numeric_limits<double>::quiet_NaN());
    find_inputs(design, run, values);
    Run asked{stop, {}};
    try {
        sampler.put(scene, values);
        if (fidelity.metrics) {
            row[0] = static_cast<double>(fidelity.metrics(scene, asked, columns.metrics, metrics).code);
            return count_unopened(row);
        }
        const RunRecord record = fidelity.run(scene, asked);
        row[0] = static_cast<double>(record.status.code);
        for (std::size_t i = 0; i < metrics.size(); ++i)
            if (const auto value = record.metric(columns.metrics[i])) metrics[i] = *value;
        count_unopened(row);
    } catch (const SceneError&) {
        row[0] = static_cast<double>(refused_inputs);
        scene = sampler.blank();
    }
}

/// All scenes of a batch, those behind the end of `rows` as well: a run's bits hang on its batch alone.
void Engine::make_batch(Worker& worker, std::uint64_t first, std::span<double> rows) const {
    const std::size_t width = columns.first_metric() + columns.metrics.size(), lanes = fidelity.batch;
    std::vector<double> inputs(lanes * columns.inputs);
    std::vector<char> refused(lanes);
    worker.scenes.resize(lanes, sampler.blank());
    for (std::size_t l = 0; l < lanes; ++l) {
        const std::span<double> values = std::span(inputs).subspan(l * columns.inputs, columns.inputs);
        find_inputs(worker.design, first + l, values);
        try {
            sampler.put(worker.scenes[l], values);
        } catch (const SceneError&) {
            refused[l] = 1;
            worker.scenes[l] = sampler.blank();
        }
    }
    worker.values.resize(lanes * columns.metrics.size());
    std::vector<StatusCode> statuses(lanes);
    Run asked{stop, {}};
    fidelity.metrics_of_batch(worker.scenes, asked, columns.metrics, worker.values, statuses);
    for (std::size_t l = 0; l < lanes && (l + 1) * width <= rows.size(); ++l) {
        const std::span<double> row = rows.subspan(l * width, width);
        row[0] = static_cast<double>(refused[l] ? refused_inputs : statuses[l]);
        std::ranges::copy(std::span(inputs).subspan(l * columns.inputs, columns.inputs), row.begin() + 1);
        const auto metrics = row.subspan(columns.first_metric());
        if (refused[l])
            std::ranges::fill(metrics, std::numeric_limits<double>::quiet_NaN());
        else
            std::ranges::copy(std::span(worker.values).subspan(l * metrics.size(), metrics.size()),
                              metrics.begin());
        count_unopened(row);
    }
}

bool Engine::make_batches(Worker& worker, std::uint64_t first, std::span<double> rows) const {
    const std::size_t width = columns.first_metric() + columns.metrics.size(), batch = fidelity.batch * width;
    for (std::size_t at = 0; at < rows.size(); at += batch) {
        if (stop.stop_requested()) return false;
        make_batch(worker, first + at / width, rows.subspan(at, std::min(batch, rows.size() - at)));
    }
    return !stop.stop_requested();
}

bool Engine::make_chunk(Worker& worker, std::uint64_t first, std::span<double> rows) const {
    if (in_batches) return make_batches(worker, first, rows);
    const std::size_t width = columns.first_metric() + columns.metrics.size();
    for (std::size_t i = 0; i < rows.size() / width; ++i) {
        if (stop.stop_requested()) return false;
        make_row(worker.design, worker.scene, first + i, rows.subspan(i * width, width));
    }
    return !stop.stop_requested();
}

bool Engine::run(const RunStore& store, std::uint64_t runs) const {
    const std::uint64_t chunks = store.chunks_of(runs);
    std::atomic<std::uint64_t> next{shard};
    std::atomic<bool> ended{false};
    std::mutex lock;
    work_on(threads, ended, [&] {
        Worker worker{Design(spec), sampler.blank(), {}, {}};
        RunStore::Rows rows;
        std::future<void> written;
        while (!ended) {
            const std::uint64_t chunk = next.fetch_add(shards);
            if (chunk >= chunks) break;
            const std::uint64_t count = store.rows_of(chunk, runs);
            if (RunStore::Rows there = store.read(chunk, count); !there.empty()) {
                const std::scoped_lock guard(lock);
                if (made) made(there);
                continue;
            }
            const auto start = std::chrono::steady_clock::now();
            rows.assign(count * store.columns(), 0.0);
            if (!make_chunk(worker, chunk * store.identity().chunk, rows)) {
                ended = true;
                break;
            }
            // A flush to disk takes as long as a chunk: the next one is made meanwhile.
            if (written.valid()) written.get();
            {
                const std::scoped_lock guard(lock);
                if (cost) {
                    cost->seconds +=
                        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
                    cost->runs += count;
                }
                if (made) made(rows);
            }
            written = std::async(std::launch::async, [&store, chunk, kept = std::exchange(rows, {})] {
                store.write(chunk, kept);
            });
        }
        if (written.valid()) written.get();
    });
    return !ended;
}

bool Engine::run_at_scores(std::span<double> rows) const {
    const std::size_t width = columns.first_metric() + columns.metrics.size();
    const std::size_t runs = rows.size() / width, part = std::max<std::size_t>(1, fidelity.batch);
    std::atomic<std::size_t> next{0};
    std::atomic<bool> ended{false};
    work_on(threads, ended, [&] {
        Worker worker{Design(spec), sampler.blank(), {}, {}};
        while (!ended) {
            const std::size_t first = next.fetch_add(part);
            if (first >= runs) break;
            const std::size_t count = std::min(part, runs - first);
            if (!make_chunk(worker, first, rows.subspan(first * width, count * width))) ended = true;
        }
    });
    return !ended;
}

}  // namespace twinchute::study
