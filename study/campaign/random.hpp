// Random numbers by place: each is a function of seed, index and dimension, and of nothing that was drawn
// before. Philox4x32-10 (Salmon, Moraes, Dror, Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC 2011).
#pragma once

#include <cstdint>

namespace twinchute::study {

/// Streams that must not meet.
enum class RandomStream : std::uint32_t {
    sample,
    shift,
    permutation,
    bootstrap,
    groups,
    examples,
    test,
    subsets,
    gusts
};

/// 64 random bits.
std::uint64_t random_bits(std::uint64_t seed, std::uint64_t index, std::uint32_t dimension,
                          RandomStream stream);

/// A number in (0, 1), never an end of it, from 52 of the bits.
inline double unit_number(std::uint64_t bits) {
    return (static_cast<double>(bits >> 12) + 0.5) * 0x1p-52;
}

}  // namespace twinchute::study
