// "Did you mean ...?"
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace twinchute {

/// The candidate with the fewest edits (Levenshtein, ASCII case ignored) to `word`; empty when
/// even that one differs in more than a third of its letters. The first of equals wins.
std::string_view nearest(std::string_view word, std::span<const std::string_view> candidates);

/// "did you mean 'x'?", or "known: a, b, c" when nothing is near.
std::string suggest(std::string_view word, const std::vector<std::string_view>& candidates);

/// "did you mean 'x' or 'y'?" of keys with dots: the nearest whole one, else up to three whose last part is,
/// or is nearest to, that of `path`; else where all are shown.
std::string suggest_key(std::string_view path, const std::vector<std::string_view>& keys);

/// "a, b, c".
std::string joined(const std::vector<std::string_view>& words);

}  // namespace twinchute
