// Random numbers that are the same on every platform for the same seed.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

namespace twinchute::test {

class Random {
public:
    explicit Random(std::uint64_t seed) : random_(seed) {}

    std::uint64_t bits() { return random_(); }
    double share() { return static_cast<double>(random_() >> 11) * 0x1p-53; }
    bool random_bool(double probability) { return share() < probability; }
    std::size_t below(std::size_t count) { return static_cast<std::size_t>(random_() % count); }
    template <class List>
    const auto& one_of(const List& list) {
        return list[below(list.size())];
    }

    /// Between two numbers, neither of them included.
    double number_in(double low, double high) {
        // Over several decades, as engineers' numbers spread, where a range has room for it.
        const double least = std::max(low, 1e-5 * high);
        if (low >= 0.0 && high > 100.0 * least) return least * std::pow(high / least, share());
        return low + (high - low) * (0.001 + 0.998 * share());
    }

private:
    std::mt19937_64 random_;
};

}  // namespace twinchute::test
