#include "lib/record/metric_key.hpp"

#include <algorithm>
#include <array>

namespace twinchute {
namespace {

struct Suffix {
    std::string_view suffix, unit;
};

// Longer ones first: "_N_s" also ends in "_s".
constexpr std::array suffixes{
    Suffix{"_m_s", "m/s"}, Suffix{"_N_s", "N s"}, Suffix{"_N_m", "N/m"}, Suffix{"_N", "N"},
    Suffix{"_s", "s"},     Suffix{"_m", "m"},     Suffix{"_g", "g"},
};

}  // namespace

MetricKey split_metric_key(std::string_view key) {
    for (const auto& [suffix, unit] : suffixes) {
        if (key.size() > suffix.size() && key.ends_with(suffix)) {
            return {key.substr(0, key.size() - suffix.size()), unit};
        }
    }
    return {key, {}};
}

std::string metric_words(std::string_view key) {
    std::string words(split_metric_key(key).name);
    std::ranges::replace(words, '_', ' ');
    return words;
}

}  // namespace twinchute
