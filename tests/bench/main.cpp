// The benchmarks. `cmake --preset bench && cmake --build --preset bench` runs all of them; the options of
// this program are Google Benchmark's.
#include <benchmark/benchmark.h>

#include "fullsim/storage/gore_batched/kernels.hpp"
#include "lib/record/run_record.hpp"
#include "tests/bench/bench.hpp"

int main(int argc, char** argv) {
    using namespace twinchute;
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    const Provenance made = current_provenance();
    benchmark::AddCustomContext("commit", made.commit);
    benchmark::AddCustomContext("compiler", made.compiler);
    benchmark::AddCustomContext("flags", made.flags);
    benchmark::AddCustomContext("cpu", made.host_cpu);
    benchmark::AddCustomContext("instruction_set", std::string(fullsim::gore_kernels().instruction_set));
    bench::register_ceilings();
    bench::register_elements();
    bench::register_methods();
    bench::register_runs();
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
    return 0;
}
