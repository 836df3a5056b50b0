// Loops over arrays that the compiler vectorises, as wide as the processor is.
#pragma once

/// Before a function of such loops: compiled for any x86-64, for AVX2 and for AVX-512, and the right one is
/// chosen when the program starts. The bits are the same in all, since nothing is contracted or reassociated.
/// Everything such a function calls has to be inlined to take part. (Not under a sanitizer, see
/// TWINCHUTE_FOR_EACH_CPU.)
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__AVX2__) && \
    !defined(__SANITIZE_ADDRESS__)
#define TWINCHUTE_WIDE_LOOPS __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define TWINCHUTE_WIDE_LOOPS
#endif
