#include "lib/math/lanes.hpp"

namespace twinchute {

std::string_view lane_instruction_set() {
#if defined(__AVX2__)
    return "AVX2";
#elif defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? "AVX2, chosen at start" : "SSE2";
#elif defined(__x86_64__)
    return "SSE2";
#elif defined(__aarch64__)
    return "NEON";
#else
    return "generic";
#endif
}

}  // namespace twinchute
