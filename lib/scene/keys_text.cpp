// The table of keys in words: for `twinchute list keys` and for the docs.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/math/vec.hpp"
#include "lib/scene/keys.hpp"
#include "lib/scene/nearest.hpp"

namespace twinchute {
namespace {

/// What a reader sees of a row.
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

/// The table of the scene that a key stands in: "payload", "" for the top.
std::string_view section(std::string_view path) {
    const auto dot = path.find('.');
    return dot == std::string_view::npos ? std::string_view{} : path.substr(0, dot);
}

std::vector<const Key*> all_keys() {
    std::vector<const Key*> keys;
    for (const auto table : {scene_keys(), material_keys()})
        for (const Key& key : table)
            keys.push_back(&key);
    return keys;
}

double in_degrees(double radians) {
    return radians * 180.0 / pi;
}

std::string escaped(std::string text) {
    for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2)
        text.insert(at, "\\");
    return text;
}

}  // namespace

std::string_view user_name(KeyUser user) {
    switch (user) {
        case KeyUser::both:
            return "both";
        case KeyUser::rom:
            return "rom";
        case KeyUser::full:
            return "full";
        case KeyUser::compare:
            return "compare";
        case KeyUser::size:
            return "size";
    }
    return "";
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
            return words.empty() ? fmt::format("a list of files in {}/", key.folder) : "a list of " + words;
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

std::string keys_table() {
    std::vector<std::array<std::string, 6>> rows;
    rows.push_back({});
    std::ranges::copy(heads, rows.back().begin());
    for (const Key* key : all_keys())
        rows.push_back(cells(*key));
    std::array<std::size_t, 6> widths{};
    for (const auto& row : rows)
        for (std::size_t i = 0; i < row.size(); ++i)
            widths[i] = std::max(widths[i], row[i].size());
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

std::string keys_markdown() {
    std::string text, current = "none yet";
    for (const Key* key : all_keys()) {
        if (section(key->path) != current && !(section(key->path).empty() && key->kind == KeyKind::table)) {
            current = section(key->path);
            const bool material = current == "fabric" || current == "cord";
            const std::string head = current.empty() ? "Top of the file"
                                     : material      ? fmt::format("`materials/*.toml`, kind `{}`", current)
                                     : current == "parachute" ? "`[[parachute]]`"
                                                              : fmt::format("`[{}]`", current);
            text += fmt::format("{}### {}\n\n", text.empty() ? "" : "\n", head);
            text += "| key | unit | default | range | used by | meaning | source |\n";
            text += "| --- | --- | --- | --- | --- | --- | --- |\n";
        }
        const auto row = cells(*key);
        text += fmt::format("| `{}` ", row[0]);
        for (std::size_t i = 1; i < row.size(); ++i)
            text += fmt::format("| {} ", escaped(row[i]));
        text += fmt::format("| {} |\n", escaped(std::string(key->source)));
    }
    return text;
}

}  // namespace twinchute
