// The table of keys in words: for `twinchute list keys` and for the docs.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "lib/math/vec.hpp"
#include "lib/scene/keys.hpp"
#include "lib/scene/nearest.hpp"

namespace twinchute {
namespace {

/// Cells of a row as a reader sees them.
std::array<std::string, 6> cells(const Key& key) {
    std::string meaning(key.meaning);
    if (!key.only_with.empty()) {
        const std::string_view selector = selector_of(scene_keys(), key)->path;
        meaning += fmt::format("; only with {} {}", selector.substr(selector.rfind('.') + 1),
                               fmt::join(words_of(key.only_with), " or "));
    }
    if (!key.instead_of.empty())
        meaning += fmt::format("; or {}", fmt::join(words_of(key.instead_of), " or "));
    return {std::string(key.path),
            std::string(key.unit),
            default_text(key),
            range_text(key),
            std::string(user_name(key.user)),
            meaning};
}

constexpr std::array<std::string_view, 6> heads{"key", "unit", "default", "range", "used by", "meaning"};

std::vector<const Key*> all_keys() {
    std::vector<const Key*> keys;
    for (const auto table : {scene_keys(), material_keys()})
        for (const Key& key : table)
            keys.push_back(&key);
    return keys;
}

/// One paragraph in lines of at most `width` columns (0: as long as it is), but for words that are longer;
/// all but the first begin with `indent` spaces.
std::string wrapped(std::string_view text, std::size_t width, std::size_t indent) {
    std::string all, line;
    std::size_t at = text.find_first_not_of(' ');
    line = text.substr(0, at);
    bool empty = true;
    while (at < text.size()) {
        const std::size_t end = std::min(text.find(' ', at), text.size());
        const std::string_view word = text.substr(at, end - at);
        if (!empty && width > 0 && line.size() + 1 + word.size() > width) {
            all += line + "\n";
            line = std::string(indent, ' ');
            empty = true;
        }
        // Runs of spaces are alignment.
        line += empty ? std::string(word)
                      : std::string(at - text.find_last_not_of(' ', at - 1) - 1, ' ') + std::string(word);
        empty = false;
        at = text.find_first_not_of(' ', end);
    }
    return all + line + "\n";
}

double in_degrees(double radians) {
    return radians * 180.0 / pi;
}

}  // namespace

std::string_view user_name(KeyUser user) {
    constexpr std::array<std::string_view, 6> names{"both", "rom", "full", "compare", "size", "campaign"};
    return names[static_cast<std::size_t>(user)];
}

std::string default_text(const Key& key) {
    if (key.need == KeyNeed::required) return "required";
    if (key.need == KeyNeed::optional) return key.fallback.empty() ? "left out" : std::string(key.fallback);
    if (key.unit == "rad") return fmt::format("{:g} deg", in_degrees(plain_number(key.fallback)));
    const bool number = key.is_number() && !key.record_unit().empty();
    return number ? fmt::format("{} {}", key.fallback, key.unit) : std::string(key.fallback);
}

std::string range_text(const Key& key) {
    const std::string words = key.choices ? fmt::format("{}", fmt::join(key.choices(), " | ")) : "";
    switch (key.kind) {
        case KeyKind::word:
            return words;
        case KeyKind::text:
            return "any text";
        case KeyKind::data_file:
            return fmt::format("a file in {}/", key.folder);
        case KeyKind::csv_file:
            return "a CSV file";
        case KeyKind::mesh_file:
            return "a Gmsh file (.msh)";
        case KeyKind::list:
            if (!words.empty()) return "a list of " + words;
            return key.folder.empty() ? "a list of texts" : fmt::format("a list of files in {}/", key.folder);
        case KeyKind::table:
            return "a table";
        case KeyKind::tables:
            return "a list of tables";
        default:
            break;
    }
    // Angles as people think of them; the reader converts either way.
    const bool angle = key.unit == "rad";
    const double low = angle ? in_degrees(key.range.low) : key.range.low;
    const double high = angle ? in_degrees(key.range.high) : key.range.high;
    std::string text = words.empty() ? "" : words + " | ";
    if (low == high) return text + fmt::format("{:g}", low);
    text += std::isfinite(low) ? fmt::format("{} {:g}", key.range.above_low ? ">" : ">=", low) : "";
    if (std::isfinite(low) && std::isfinite(high)) text += " and ";
    text += std::isfinite(high) ? fmt::format("{} {:g}", key.range.below_high ? "<" : "<=", high) : "";
    return text.empty() ? "any" : text + (angle ? " deg" : "");
}

std::string allowed_text(const Key& key) {
    const bool bare = key.record_unit().empty() || key.unit == "rad";  // an angle's range has its unit
    return fmt::format("allowed: {}{}{}", range_text(key), bare ? "" : " ", bare ? "" : key.unit);
}

std::vector<const Key*> keys_below(std::string_view path) {
    std::vector<const Key*> keys;
    for (const Key* key : all_keys()) {
        const std::string_view own = key->path;
        if (path.empty() || own == path || (own.starts_with(path) && own[path.size()] == '.'))
            keys.push_back(key);
    }
    return keys;
}

std::string keys_table(const std::vector<const Key*>& keys) {
    constexpr std::size_t widest = 30;  // of a column: longer cells push the rest of their line alone
    std::vector<std::array<std::string, 6>> rows;
    rows.push_back({});
    std::ranges::copy(heads, rows.back().begin());
    for (const Key* key : keys)
        rows.push_back(cells(*key));
    std::array<std::size_t, 6> widths{};
    for (const auto& row : rows)
        for (std::size_t i = 0; i < row.size(); ++i)
            widths[i] = std::max(widths[i], i == 0 ? row[i].size() : std::min(row[i].size(), widest));
    std::string text;
    for (const auto& row : rows) {
        std::string line;
        for (std::size_t i = 0; i < row.size(); ++i)
            line += fmt::format("{:<{}}  ", row[i], widths[i]);
        line.erase(line.find_last_not_of(' ') + 1);
        text += line + "\n";
    }
    return text;
}

std::string keys_wrapped(const std::vector<const Key*>& keys, std::size_t width) {
    std::string text;
    for (const Key* key : keys) {
        const auto row = cells(*key);
        const std::string unit = row[1].empty() ? "" : fmt::format(" [{}]", row[1]);
        const std::string user = key->user == KeyUser::both ? "" : fmt::format("; {} only", row[4]);
        text += wrapped(row[0] + unit, width, 4);
        text += wrapped(fmt::format("    {}; {}{}", row[2], row[3], user), width, 4);
        if (!row[5].empty()) text += wrapped("    " + row[5], width, 4);
    }
    return text;
}

std::string key_page(const Key& key, std::size_t width) {
    const Key* selector = key.only_with.empty() ? nullptr : selector_of(scene_keys(), key);
    const std::array<std::pair<std::string_view, std::string>, 9> lines{{
        {"meaning", std::string(key.meaning)},
        {"unit", std::string(key.unit)},
        {"default", default_text(key)},
        {"range", range_text(key)},
        {"used by", std::string(user_name(key.user))},
        {"instead of", fmt::format("{}", fmt::join(words_of(key.instead_of), ", "))},
        {"only with",
         selector ? fmt::format("{} = {}", selector->path, fmt::join(words_of(key.only_with), ", ")) : ""},
        {"source", std::string(key.source)},
        {"formerly", std::string(key.formerly)},
    }};
    std::string text = std::string(key.path) + "\n";
    for (const auto& [name, value] : lines)
        if (!value.empty()) text += wrapped(fmt::format("    {:<12}{}", name, value), width, 16);
    return text;
}

}  // namespace twinchute
