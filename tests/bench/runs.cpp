#include <benchmark/benchmark.h>
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <string>
#include <vector>

#include "fullsim/run/run_fullsim.hpp"
#include "lib/scene/read_scene.hpp"
#include "lib/solve/stopwatch.hpp"
#include "rom/run_rom.hpp"
#include "tests/bench/bench.hpp"

namespace twinchute::bench {
namespace {

/// How far a run had come at one of its reports of progress.
struct Mark {
    double time;  ///< [s] simulated
    double cpu;   ///< [s] of this process
    double step;
};

/// Between the marks around this simulated time [s].
Mark at(const std::vector<Mark>& marks, double time) {
    const auto after = std::ranges::lower_bound(marks, time, {}, &Mark::time);
    if (after == marks.begin()) return marks.front();
    if (after == marks.end()) return marks.back();
    const Mark& a = after[-1];
    const Mark& b = *after;
    const double share = (time - a.time) / (b.time - a.time);
    return {time, a.cpu + share * (b.cpu - a.cpu), a.step + share * (b.step - a.step)};
}

/// A whole run, and what each stage of it took: between the events that part the stages.
void measure_full(benchmark::State& bench, const char* file) {
    const Scene scene = read_scene(path_of(file));
    for (auto _ : bench) {
        std::vector<Mark> marks;
        const Stopwatch watch;
        Run run;
        run.progress = [&](const Progress& p) { marks.push_back({p.time, watch.cpu(), 0.0}); };
        const RunRecord record = fullsim::run_fullsim(scene, run);
        if (record.status.code != StatusCode::completed) {
            bench.SkipWithError(record.status.detail.c_str());
            break;
        }
        const double cpu = watch.cpu(), steps = static_cast<double>(record.cost.steps);
        // Reports come at equal numbers of steps, of which half an interval is left at the end on average.
        const double interval = steps / (static_cast<double>(marks.size()) - 0.5);
        for (std::size_t k = 0; k < marks.size(); ++k)
            marks[k].step = static_cast<double>(k) * interval;
        marks.push_back({record.find_channel("time")->values.back(), cpu, steps});

        bench.counters["steps"] = steps;
        bench.counters["cpu_s"] = cpu;
        bench.counters["wall_s"] = watch.wall();
        bench.counters["us_per_step"] = 1e6 * cpu / steps;
        bench.counters["ns_per_element_step"] = 1e9 * cpu / static_cast<double>(record.cost.element_steps);
        const std::pair<const char*, const char*> ends[] = {{"deployment", "snatch"},
                                                            {"springs", "switch"},
                                                            {"ramp", "finite-elements-alone"},
                                                            {"flight", nullptr}};
        Mark begin{};
        for (const auto& [stage, event] : ends) {
            const Event* met = event ? record.find_event(event) : nullptr;
            if (event && !met) continue;  // a stage that this run does not have
            const Mark end = met ? at(marks, met->time) : marks.back();
            const std::string name = stage;
            bench.counters[name + "_steps"] = end.step - begin.step;
            bench.counters[name + "_cpu_s"] = end.cpu - begin.cpu;
            bench.counters[name + "_us_per_step"] = 1e6 * (end.cpu - begin.cpu) / (end.step - begin.step);
            begin = end;
        }
    }
}

void measure_rom(benchmark::State& bench, const char* file) {
    const Scene scene = read_scene(path_of(file));
    Run run;
    Cost cost;
    double integration = std::numeric_limits<double>::infinity();  // without the record around it
    for (auto _ : bench) {
        cost = rom::run_rom(scene, run).cost;
        integration = std::min(integration, cost.wall_s);
    }
    bench.counters["steps"] = static_cast<double>(cost.steps);
    bench.counters["integration_us"] = 1e6 * integration;
}

void measure_reading(benchmark::State& bench, const char* file) {
    for (auto _ : bench)
        benchmark::DoNotOptimize(read_scene(path_of(file)));
}

/// A process from its start to its end, many times over.
void measure_start(benchmark::State& bench, std::vector<std::string> words) {
    std::vector<char*> arguments;
    for (std::string& word : words)
        arguments.push_back(word.data());
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t quiet;
    posix_spawn_file_actions_init(&quiet);
    posix_spawn_file_actions_addopen(&quiet, 1, "/dev/null", 1 /* O_WRONLY */, 0);
    std::vector<double> seconds;
    for (auto _ : bench) {
        const auto start = std::chrono::steady_clock::now();
        pid_t child = 0;
        int status = 0;
        if (::posix_spawn(&child, arguments[0], &quiet, nullptr, arguments.data(), environ) != 0 ||
            ::waitpid(child, &status, 0) != child || status != 0) {
            bench.SkipWithError("the program did not run to its end");
            break;
        }
        seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
        bench.SetIterationTime(seconds.back());
    }
    posix_spawn_file_actions_destroy(&quiet);
    if (seconds.empty()) return;
    std::ranges::sort(seconds);
    bench.counters["min_ms"] = 1e3 * seconds.front();
    bench.counters["median_ms"] = 1e3 * seconds[seconds.size() / 2];
}

void register_start(const char* name, std::vector<std::string> words) {
    constexpr int starts = 300;
    benchmark::RegisterBenchmark(name, &measure_start, std::move(words))
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond)
        ->Iterations(starts)
        ->Repetitions(1);
}

}  // namespace

void register_runs() {
    for (const auto& [name, file] :
         {std::pair{"run/full/c9-inflation", c9_inflation}, std::pair{"run/full/crane-drop", crane_drop}})
        benchmark::RegisterBenchmark(name, &measure_full, file)
            ->Unit(benchmark::kSecond)
            ->Iterations(1)
            ->Repetitions(3);
    for (const auto& [name, file] :
         {std::pair{"run/rom/c9-inflation", c9_inflation}, std::pair{"run/rom/crane-drop", crane_drop}})
        benchmark::RegisterBenchmark(name, &measure_rom, file)->Unit(benchmark::kMicrosecond);
    benchmark::RegisterBenchmark("run/read-scene/c9-inflation", &measure_reading, c9_inflation)
        ->Unit(benchmark::kMicrosecond);
    register_start("start/version", {TWINCHUTE_PROGRAM, "--version"});
    register_start("start/rom-check", {TWINCHUTE_PROGRAM, "rom", path_of(c9_inflation), "--check"});
    register_start("start/rom", {TWINCHUTE_PROGRAM, "rom", path_of(c9_inflation)});
}

}  // namespace twinchute::bench
