// For which instruction sets kernels are compiled, and which of them a machine can run. Included before
// hwy/foreach_target.h, once; for the inner loops of a layout alone.
//
// Highway is used for its headers alone: its own dispatch needs its library, and that times the processor's
// clock for some milliseconds whenever a program starts.
#pragma once

#include "fullsim/storage/simd/instruction_sets.hpp"
#include "fullsim/storage/simd/sanitized.hpp"

#include <string_view>
#include <vector>

// Where a processor has AVX-512, its gains over AVX-512 with later additions are none here. Under sanitizers
// a set takes long to compile: two have all lines between them.
#ifdef TWINCHUTE_SANITIZED
#define TWINCHUTE_SPARED (HWY_AVX3 | HWY_SSE4)
#else
#define TWINCHUTE_SPARED 0
#endif
#define HWY_DISABLED_TARGETS \
    (HWY_AVX3_DL | HWY_SSSE3 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | TWINCHUTE_SPARED)

#include <hwy/detect_targets.h>

namespace twinchute::fullsim {

/// As it stands in a record.
constexpr std::string_view instruction_set_name(long long hwy_target) {
    switch (hwy_target) {
        case HWY_AVX3:
            return "AVX-512";
        case HWY_AVX2:
            return "AVX2";
        case HWY_SSE4:
            return "SSE4";
        case HWY_NEON:
            return "NEON";
        default:
            return "generic";
    }
}

}  // namespace twinchute::fullsim

#if (HWY_TARGETS & HWY_AVX3) != 0 && HWY_STATIC_TARGET != HWY_AVX3
#define TWINCHUTE_WITH_AVX3(here)                                                   \
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512cd") &&  \
        __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") && \
        __builtin_cpu_supports("avx512vl"))                                         \
        found.push_back(N_AVX3::here());
#else
#define TWINCHUTE_WITH_AVX3(here)
#endif
#if (HWY_TARGETS & HWY_AVX2) != 0 && HWY_STATIC_TARGET != HWY_AVX2
#define TWINCHUTE_WITH_AVX2(here)                                                                           \
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi") && \
        __builtin_cpu_supports("bmi2"))                                                                     \
        found.push_back(N_AVX2::here());
#else
#define TWINCHUTE_WITH_AVX2(here)
#endif
#if (HWY_TARGETS & HWY_SSE4) != 0 && HWY_STATIC_TARGET != HWY_SSE4
#define TWINCHUTE_WITH_SSE4(here) \
    if (__builtin_cpu_supports("sse4.2")) found.push_back(N_SSE4::here());
#else
#define TWINCHUTE_WITH_SSE4(here)
#endif

/// Collects the results of `here`, a function of the namespace of each instruction set, for those that this
/// machine has and that are no wider than wanted: the widest first, last the baseline that everything is
/// compiled for. Within twinchute::fullsim, where HWY_ONCE holds. Throws SceneError (up_to).
#define TWINCHUTE_SETS_OF_THIS_MACHINE(Kernels, here)  \
    [] {                                               \
        std::vector<Kernels> found;                    \
        TWINCHUTE_WITH_AVX3(here)                      \
        TWINCHUTE_WITH_AVX2(here)                      \
        TWINCHUTE_WITH_SSE4(here)                      \
        found.push_back(HWY_NAMESPACE::here());        \
        return up_to(wanted_instruction_set(), found); \
    }()
