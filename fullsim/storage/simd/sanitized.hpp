// Whether addresses are checked, by the macro TWINCHUTE_SANITIZED: kernels then take long to compile, and a
// step many times as long. `is_sanitized` says it to tests, which then look at less.
#pragma once

#if defined(__SANITIZE_ADDRESS__)
#define TWINCHUTE_SANITIZED
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define TWINCHUTE_SANITIZED
#endif
#endif

namespace twinchute {
#ifdef TWINCHUTE_SANITIZED
inline constexpr bool is_sanitized = true;
#else
inline constexpr bool is_sanitized = false;
#endif
}  // namespace twinchute
