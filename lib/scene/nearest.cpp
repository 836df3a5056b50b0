#include "lib/scene/nearest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <numeric>

namespace twinchute {
namespace {

char lower(char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
}

/// Levenshtein's distance, two rows of the usual table.
std::size_t edits(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 1; i <= a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t replaced = diagonal + (lower(a[i - 1]) == lower(b[j - 1]) ? 0 : 1);
            diagonal = row[j];
            row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
        }
    }
    return row[b.size()];
}

}  // namespace

std::string_view nearest(std::string_view word, std::span<const std::string_view> candidates) {
    std::string_view best;
    std::size_t fewest = 0;
    for (const std::string_view candidate : candidates) {
        const std::size_t count = edits(word, candidate);
        const std::size_t limit = std::max<std::size_t>(1, std::max(word.size(), candidate.size()) / 3);
        if (count <= limit && (best.empty() || count < fewest)) {
            best = candidate;
            fewest = count;
        }
    }
    return best;
}

std::string joined(const std::vector<std::string_view>& words) {
    return fmt::format("{}", fmt::join(words, ", "));
}

std::string suggest(std::string_view word, const std::vector<std::string_view>& candidates) {
    if (const auto near = nearest(word, candidates); !near.empty())
        return fmt::format("did you mean '{}'?", near);
    return candidates.empty() ? "there is none" : "known: " + joined(candidates);
}

std::string suggest_key(std::string_view path, const std::vector<std::string_view>& keys) {
    const auto last = [](std::string_view key) { return key.substr(key.rfind('.') + 1); };
    constexpr std::size_t most = 3;
    std::vector<std::string_view> meant;
    if (const auto near = nearest(path, keys); !near.empty()) {
        meant = {near};
    } else {
        std::vector<std::string_view> names;
        std::ranges::transform(keys, std::back_inserter(names), last);
        const std::string_view name = nearest(last(path), names);
        std::ranges::copy_if(keys, std::back_inserter(meant),
                             [&](std::string_view key) { return !name.empty() && last(key) == name; });
    }
    if (meant.empty() || meant.size() > most) return "`twinchute list keys` shows all of them";
    return fmt::format("did you mean '{}'?", fmt::join(meant, "' or '"));
}

}  // namespace twinchute
