#include "lib/scene/keys.hpp"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>

namespace twinchute {

bool is_below(std::string_view path, std::string_view table) {
    return table.empty() ||
           (path.size() > table.size() && path[table.size()] == '.' && path.starts_with(table));
}

std::vector<std::string_view> words_of(std::string_view list) {
    std::vector<std::string_view> words;
    while (!list.empty()) {
        const std::size_t bar = std::min(list.find('|'), list.size());
        words.push_back(list.substr(0, bar));
        list.remove_prefix(std::min(bar + 1, list.size()));
    }
    return words;
}

bool Key::goes_with(std::string_view word) const {
    return only_with.empty() || std::ranges::count(words_of(only_with), word) != 0;
}

const Key* selector_of(std::span<const Key> keys, const Key& key) {
    const std::string_view table = key.path.substr(0, key.path.rfind('.') + 1);
    const auto row = std::ranges::find_if(keys, [&](const Key& k) {
        return k.is_selector() && k.path.starts_with(table) &&
               k.path.find('.', table.size()) == std::string_view::npos;
    });
    return row == keys.end() ? nullptr : &*row;
}

bool prescribes_filling(std::string_view path) {
    constexpr std::string_view reefing = "parachute.reefing.", fill_time = "fill_time.";
    if (path.starts_with(reefing)) return path.find(fill_time, reefing.size()) != std::string_view::npos;
    return is_below(path, "parachute.fill_time") || path == "parachute.drag_area_law" ||
           path == "parachute.drag_area_exponent" || path == "parachute.drag_area_table" ||
           path == "parachute.initial_drag_area_ratio" || path == "parachute.initial_phase";
}

namespace {

/// The number of a list's member: without sign or leading zero.
bool is_member(std::string_view word) {
    return !word.empty() && word.size() <= 3 && word.front() != '0' &&
           std::ranges::all_of(word, [](char c) { return c >= '0' && c <= '9'; });
}

const Key* plain_row(std::span<const Key> keys, std::string_view path) {
    const auto row = std::ranges::find(keys, path, &Key::path);
    return row == keys.end() ? nullptr : &*row;
}

}  // namespace

std::string row_path(std::span<const Key> keys, std::string_view path) {
    std::string row;
    while (!path.empty()) {
        const std::size_t dot = std::min(path.find('.'), path.size());
        const std::string_view word = path.substr(0, dot);
        path.remove_prefix(std::min(dot + 1, path.size()));
        if (is_member(word))
            if (const Key* list = plain_row(keys, row); list && list->has_members()) continue;
        row += row.empty() ? "" : ".";
        row += word;
    }
    return row;
}

const Key* find_key(std::span<const Key> keys, std::string_view path) {
    const bool has_number = path.find_first_of("123456789") != std::string_view::npos;
    return has_number ? plain_row(keys, row_path(keys, path)) : plain_row(keys, path);
}

const Key* find_successor(std::span<const Key> keys, std::string_view path) {
    const std::string retired = row_path(keys, path);
    const auto row = std::ranges::find_if(keys, [&](const Key& key) {
        return std::ranges::count(words_of(key.formerly), std::string_view(retired)) > 0;
    });
    return row == keys.end() ? nullptr : &*row;
}

std::string beside(std::string_view row, std::string_view like) {
    std::string path(row);
    for (std::size_t at = 0; (at = like.find('.', at)) != std::string_view::npos; ++at) {
        const std::string_view rest = like.substr(at + 1);
        const std::string_view number = rest.substr(0, rest.find('.'));
        const std::string_view list = like.substr(0, at + 1);
        if (is_member(number) && std::string_view(path).starts_with(list))
            path.insert(list.size(), std::string(number) + ".");
    }
    return path;
}

double plain_number(std::string_view fallback) {
    double value = std::nan("");
    std::from_chars(fallback.data(), fallback.data() + fallback.size(), value);
    assert(std::isfinite(value));
    return value;
}

}  // namespace twinchute
