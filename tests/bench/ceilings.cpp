#include <benchmark/benchmark.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "tests/bench/bench.hpp"

namespace twinchute::bench {
namespace {

template <int doubles>
using Pack [[gnu::vector_size(doubles * sizeof(double))]] = double;

/// Independent chains, enough to hide a latency of 4 cycles on two units, few enough for 16 registers.
constexpr int chains = 12;
constexpr double shrink = 0.999, grow = 1e-3;  // x -> x shrink + grow stays near 1
constexpr int rounds = 10000;

#if defined(__x86_64__)
__attribute__((target("avx2,fma"))) double multiply_add_avx2() {
    __m256d x[chains];
    for (int k = 0; k < chains; ++k)
        x[k] = _mm256_set1_pd(1.0 + 1e-3 * k);
    const __m256d a = _mm256_set1_pd(shrink), b = _mm256_set1_pd(grow);
    for (int n = 0; n < rounds; ++n)
        for (int k = 0; k < chains; ++k)
            x[k] = _mm256_fmadd_pd(x[k], a, b);
    __m256d sum = x[0];
    for (int k = 1; k < chains; ++k)
        sum = _mm256_add_pd(sum, x[k]);
    return _mm256_cvtsd_f64(sum);
}

__attribute__((target("avx512f"))) double multiply_add_avx512() {
    __m512d x[chains];
    for (int k = 0; k < chains; ++k)
        x[k] = _mm512_set1_pd(1.0 + 1e-3 * k);
    const __m512d a = _mm512_set1_pd(shrink), b = _mm512_set1_pd(grow);
    for (int n = 0; n < rounds; ++n)
        for (int k = 0; k < chains; ++k)
            x[k] = _mm512_fmadd_pd(x[k], a, b);
    __m512d sum = x[0];
    for (int k = 1; k < chains; ++k)
        sum = _mm512_add_pd(sum, x[k]);
    return _mm512_cvtsd_f64(sum);
}
#endif

/// Without fused instructions: a multiplication and an addition, which counts as two operations all the same.
double multiply_add_anywhere() {
    using Pair = Pack<2>;
    Pair x[chains];
    for (int k = 0; k < chains; ++k)
        x[k] = Pair{1.0 + 1e-3 * k, 1.0};
    for (int n = 0; n < rounds; ++n)
        for (int k = 0; k < chains; ++k)
            x[k] = x[k] * shrink + grow;
    Pair sum = x[0];
    for (int k = 1; k < chains; ++k)
        sum += x[k];
    return sum[0];
}

/// Reads all of it once; count is a multiple of 64. Inlined into callers for one instruction set each.
template <int width>
[[gnu::always_inline]] inline double sum_of(const double* data, std::size_t count) {
    using Register = Pack<width>;
    constexpr std::size_t at_once = 8;
    Register sum[at_once] = {};
    for (std::size_t i = 0; i < count; i += at_once * width)
        for (std::size_t k = 0; k < at_once; ++k) {
            Register read;
            std::memcpy(&read, data + i + k * width, sizeof(read));
            sum[k] += read;
        }
    double all = 0.0;
    for (const Register& one : sum)
        all += one[0];
    return all;
}

#if defined(__x86_64__)
__attribute__((target("avx512f"))) double sum_avx512(const double* data, std::size_t count) {
    return sum_of<8>(data, count);
}
__attribute__((target("avx2"))) double sum_avx2(const double* data, std::size_t count) {
    return sum_of<4>(data, count);
}
#endif
double sum_anywhere(const double* data, std::size_t count) {
    return sum_of<2>(data, count);
}

using Sum = double (*)(const double*, std::size_t);

/// The widest that this processor has.
Sum widest_sum() {
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx512f")) return &sum_avx512;
    if (__builtin_cpu_supports("avx2")) return &sum_avx2;
#endif
    return &sum_anywhere;
}

void register_multiply_add(const char* instructions, double (*kernel)(), int width) {
    const std::string name = std::string("ceiling/multiply-add/") + instructions;
    benchmark::RegisterBenchmark(name.c_str(), [kernel, width](benchmark::State& state) {
        for (auto _ : state)
            benchmark::DoNotOptimize(kernel());
        const double operations = 2.0 * rounds * chains * width;
        state.counters["GFLOP_per_s"] =
            benchmark::Counter(1e-9 * operations, benchmark::Counter::kIsIterationInvariantRate);
    });
}

/// Sizes [B] of the caches of one core, and of the last one.
struct Caches {
    std::size_t first = 32 << 10, second = 256 << 10, last = 32 << 20;  // where the system does not say
};

Caches caches() {
    Caches found;
    // Virtual machines may list none, yet say how large the first two are.
    const auto said = [](int name, std::size_t otherwise) {
        const long size = ::sysconf(name);
        return size > 0 ? static_cast<std::size_t>(size) : otherwise;
    };
#if defined(__GLIBC__)
    found.first = said(_SC_LEVEL1_DCACHE_SIZE, found.first);
    found.second = said(_SC_LEVEL2_CACHE_SIZE, found.second);
#endif
    for (const auto& cache : benchmark::CPUInfo::Get().caches) {
        if (cache.type == "Instruction") continue;
        const auto size = static_cast<std::size_t>(cache.size);
        if (cache.level == 1) found.first = size;
        if (cache.level == 2) found.second = size;
        found.last = std::max(found.last, size);
    }
    return found;
}

/// [B] to read that no cache holds, but no more than an eighth of the memory.
std::size_t beyond_caches() {
    const std::size_t memory = static_cast<std::size_t>(::sysconf(_SC_PHYS_PAGES)) *
                               static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
    return std::min(4 * caches().last, memory / 8);
}

benchmark::Counter gigabytes(double bytes) {
    return {1e-9 * bytes, benchmark::Counter::kIsIterationInvariantRate};
}

/// A cache line, so that no read crosses from one to the next.
struct alignas(64) Line {
    double value[8];
};

/// Some of what lies in a cache of so many bytes.
void register_read(const char* name, std::size_t bytes, std::size_t cache) {
    benchmark::RegisterBenchmark(name, [bytes, cache](benchmark::State& state) {
        const std::vector<Line> lines(bytes / 512 * 8, Line{{1.0}});
        const std::size_t count = 8 * lines.size();
        const Sum sum = widest_sum();
        for (auto _ : state)
            benchmark::DoNotOptimize(sum(lines.front().value, count));
        state.counters["GB_per_s"] = gigabytes(sizeof(double) * static_cast<double>(count));
        state.counters["kB"] = 1e-3 * static_cast<double>(bytes);
        state.counters["kB_of_cache"] = 1e-3 * static_cast<double>(cache);
    });
}

void copy_memory(benchmark::State& state) {
    const std::vector<double> from(beyond_caches() / 2 / sizeof(double), 1.0);
    std::vector<double> to(from.size(), 0.0);
    for (auto _ : state) {
        std::memcpy(to.data(), from.data(), sizeof(double) * from.size());
        benchmark::ClobberMemory();
    }
    // Read and written; what a processor reads in order to write it is not counted.
    state.counters["GB_per_s"] = gigabytes(2.0 * sizeof(double) * static_cast<double>(from.size()));
}

}  // namespace

void register_ceilings() {
    register_multiply_add("any", &multiply_add_anywhere, 2);
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
        register_multiply_add("AVX2", &multiply_add_avx2, 4);
    if (__builtin_cpu_supports("avx512f")) register_multiply_add("AVX-512", &multiply_add_avx512, 8);
#endif
    const Caches cache = caches();
    register_read("ceiling/read/L1", cache.first / 2, cache.first);
    register_read("ceiling/read/L2", cache.second / 2, cache.second);
    register_read("ceiling/read/L3", cache.last / 4, cache.last);
    register_read("ceiling/read/memory", beyond_caches(), 0);
    benchmark::RegisterBenchmark("ceiling/copy/memory", &copy_memory);
}

}  // namespace twinchute::bench
