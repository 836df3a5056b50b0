#include "study/campaign/random.hpp"

#include <Random123/philox.h>

namespace twinchute::study {

std::uint64_t random_bits(std::uint64_t seed, std::uint64_t index, std::uint32_t dimension,
                          RandomStream stream) {
    const auto low = [](std::uint64_t word) { return static_cast<std::uint32_t>(word); };
    const auto high = [](std::uint64_t word) { return static_cast<std::uint32_t>(word >> 32); };
    const r123::Philox4x32 generator;
    const r123::Philox4x32::key_type key{{low(seed), high(seed)}};
    const r123::Philox4x32::ctr_type counter{
        {low(index), high(index), dimension, static_cast<std::uint32_t>(stream)}};
    const auto drawn = generator(counter, key);
    return drawn[0] | static_cast<std::uint64_t>(drawn[1]) << 32;
}

}  // namespace twinchute::study
