#include "lib/exchange/imported_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "lib/cli/command.hpp"
#include "lib/math/vec.hpp"
#include "lib/scene/data_files.hpp"

namespace twinchute::exchange {
namespace {

/// Bytes of the UTF-8 character that begins here; 0: none does.
std::size_t character_at(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const unsigned char lead = byte(0);
    if (lead < 0x80) return 1;
    const std::size_t length = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
    if (lead < 0xc2 || lead > 0xf4 || text.size() < length) return 0;
    for (std::size_t i = 1; i < length; ++i)
        if ((byte(i) & 0xc0) != 0x80) return 0;
    const unsigned char second = byte(1);
    const bool overlong = (lead == 0xe0 && second < 0xa0) || (lead == 0xf0 && second < 0x90);
    const bool beyond = (lead == 0xed && second >= 0xa0) || (lead == 0xf4 && second >= 0x90);
    const bool control = lead == 0xc2 && second < 0xa0;
    return overlong || beyond || control ? 0 : length;
}

/// A value of --set as TOML: as it stands where it is TOML's, else in quotes, as a shell hands "150 kg" over.
std::string as_toml(std::string_view value) {
    const bool quoted = std::string_view("\"'{[").find(value.front()) != std::string_view::npos;
    const bool plain = value.find_first_not_of("0123456789+-.eE_") == std::string_view::npos;
    return quoted || plain || value == "true" || value == "false" ? std::string(value) : toml_string(value);
}

std::string full_path(const ImportedTable& table, std::string_view key) {
    return table.path.empty() ? std::string(key) : fmt::format("{}.{}", table.path, key);
}

/// Whether a key and one that an assignment names say the same, or stand in each other's place.
bool is_same(const std::string& path, const std::string& assigned) {
    static constexpr std::array<std::pair<std::string_view, std::string_view>, 4> instead{
        {{"height", "altitude"},
         {"speed", "airspeed"},
         {"drag_area", "drag_coefficient"},
         {"atmosphere", "atmosphere.model"}}};
    if (path == assigned || assigned.starts_with(path + ".")) return true;
    const std::size_t filling = path.find(".fill_time.");
    if (filling != std::string::npos && assigned.starts_with(path.substr(0, filling + 11))) return true;
    return std::ranges::any_of(instead, [&](const auto& pair) {
        const auto swapped = [&](std::string_view from, std::string_view to) {
            return path.ends_with(from) &&
                   path.substr(0, path.size() - from.size()) + std::string(to) == assigned;
        };
        return swapped("." + std::string(pair.first), "." + std::string(pair.second)) ||
               swapped("." + std::string(pair.second), "." + std::string(pair.first));
    });
}

void set_key(ImportedScene& scene, std::string_view assignment) {
    const std::size_t equals = assignment.find('=');
    std::string_view key = assignment.substr(0, equals);
    while (key.ends_with(' '))
        key.remove_suffix(1);
    std::string_view value = equals == std::string_view::npos ? "" : assignment.substr(equals + 1);
    value.remove_prefix(std::min(value.find_first_not_of(' '), value.size()));
    const bool named = !key.empty() && key.find_first_not_of(
                                           "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                           "0123456789_-.") == std::string_view::npos;
    if (!named || value.empty() || value.find_first_of("\r\n") != std::string_view::npos)
        throw UsageError(fmt::format("--set: '{}' is not key=value, write e.g. --set payload.mass='1.2 kg'",
                                     one_line(assignment)));
    const std::string path(key);
    ImportedTable* home = nullptr;  // the longest table that the key lies below
    for (ImportedTable& table : scene.tables) {
        const bool below =
            table.path.empty() ? path.find('.') == std::string::npos : path.starts_with(table.path + ".");
        if (below && (!home || table.path.size() > home->path.size())) home = &table;
    }
    if (!home && path.find('.') != std::string::npos && !path.starts_with("parachute.")) {
        const std::string head = path.substr(0, path.find('.'));
        home = &scene.table(head, fmt::format("[{}]", head));
    }
    if (!home) {
        std::string known;
        for (const ImportedTable& table : scene.tables)
            if (table.path.starts_with("parachute")) known += (known.empty() ? "" : ", ") + table.path;
        throw UsageError(
            fmt::format("--set: '{}' lies in no table of this scene (its parachutes are {}), "
                        "name one of these",
                        path, known));
    }
    for (const ImportedKey& one : home->keys)
        if (one.value.starts_with('{') && path.starts_with(full_path(*home, one.key) + "."))
            throw UsageError(fmt::format(
                "--set: '{}' is one key of a table that stands as a whole here, give all of it, e.g. "
                "--set {}='{}'",
                path, full_path(*home, one.key), one.value));
    std::erase_if(home->keys, [&](const ImportedKey& one) {
        return full_path(*home, one.key) != path && is_same(full_path(*home, one.key), path);
    });
    const std::string below = home->path.empty() ? path : path.substr(home->path.size() + 1);
    const auto at = std::ranges::find(home->keys, below, &ImportedKey::key);
    ImportedKey& row = at != home->keys.end() ? *at : home->keys.emplace_back();
    row = {below, as_toml(value), "given by --set"};
}

}  // namespace

void ImportedTable::add(std::string key, double si, std::string_view unit, std::string comment) {
    add(std::move(key), toml_quantity(si, unit), std::move(comment));
}

ImportedTable& ImportedScene::table(std::string_view path, std::string_view head) {
    const auto at = std::ranges::find(tables, path, &ImportedTable::path);
    if (at != tables.end()) return *at;
    return tables.emplace_back(ImportedTable{std::string(head), std::string(path), {}});
}

std::string one_line(std::string_view text) {
    std::string out;
    while (!text.empty()) {
        const std::size_t length = character_at(text);
        const bool shown = length > 1 || (length == 1 && text[0] >= 0x20 && text[0] != 0x7f);
        if (shown)
            out += text.substr(0, length);
        else if (text[0] == '\n' || text[0] == '\t' || text[0] == '\r')
            out += ' ';
        else
            out += '?';
        text.remove_prefix(std::max<std::size_t>(length, 1));
    }
    const std::size_t first = out.find_first_not_of(' ');
    if (first == std::string::npos) return {};
    return out.substr(first, out.find_last_not_of(' ') - first + 1);
}

std::string toml_string(std::string_view text) {
    std::string out = "\"";
    for (const char c : one_line(text)) {
        if (c == '"' || c == '\\') out += '\\';
        out += c;
    }
    return out + "\"";
}

std::string toml_quantity(double si, std::string_view unit) {
    const std::string number = fmt::format("{:.6g}", si);
    return unit.empty() ? number : fmt::format("\"{} {}\"", number, unit);
}

std::string parachute_name(std::string_view foreign, const std::vector<std::string>& taken) {
    std::string name = file_stem_of(foreign);
    std::ranges::replace(name, '.', '-');  // a key is split at dots
    std::ranges::transform(name, name.begin(), [](char c) {
        return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    });
    const auto both_dashes = [](char a, char b) { return a == '-' && b == '-'; };
    name.erase(std::unique(name.begin(), name.end(), both_dashes), name.end());
    constexpr std::size_t longest = 32;  // names of presets hold sizes and masses
    if (name.size() > longest) {
        const std::size_t dash = name.rfind('-', longest);
        name.resize(dash == std::string::npos || dash == 0 ? longest : dash);
    }
    while (name.ends_with('-'))
        name.pop_back();
    name.erase(0, std::min(name.find_first_not_of('-'), name.size()));
    // A number would name a parachute by its place in the scene.
    if (name.empty() || name.find_first_not_of("0123456789") == std::string::npos) name = "parachute-" + name;
    while (name.ends_with('-'))
        name.pop_back();
    std::string unique = name;
    for (int k = 2; std::ranges::count(taken, unique) != 0; ++k)
        unique = fmt::format("{}-{}", name, k);
    return unique;
}

void set_keys(ImportedScene& scene, const std::vector<std::string>& assignments) {
    for (const std::string& assignment : assignments)
        set_key(scene, assignment);
}

std::vector<std::string> missing_values(const ImportedScene& scene) {
    std::vector<std::string> missing;
    for (const ImportedTable& table : scene.tables)
        for (const ImportedKey& key : table.keys)
            if (key.value.empty())
                missing.push_back(fmt::format("{} ({})", full_path(table, key.key), key.comment));
    return missing;
}

std::string scene_text(const ImportedScene& scene, std::string_view file, std::string_view wind_table) {
    std::string text =
        fmt::format("{} from {}, written by {}.\n", import_mark, one_line(file), one_line(scene.program));
    if (!scene.taken.empty()) text += fmt::format("# {}\n", one_line(scene.taken));
    const auto list = [&](std::string_view head, const std::vector<std::string>& entries) {
        if (entries.empty()) return;
        text += fmt::format("#\n# {}:\n", head);
        for (const std::string& entry : entries)
            text += fmt::format("#   - {}\n", one_line(entry));
    };
    list("Assumed", scene.assumptions);
    list("Not taken over", scene.left_out);
    if (scene.stated_landing_speed)
        text += fmt::format("#\n# {} states a landing at {:.4g} m/s {} ({}).\n", one_line(scene.program),
                            *scene.stated_landing_speed,
                            scene.stated_over_ground ? "over ground" : "downward", one_line(scene.stated_by));
    text += '\n';
    for (const ImportedTable& table : scene.tables) {
        if (!table.head.empty()) text += fmt::format("\n{}\n", table.head);
        for (const std::string& note : table.notes)
            text += fmt::format("# {}\n", one_line(note));
        for (const ImportedKey& key : table.keys)
            text += fmt::format("{} = {}{}\n", key.key, key.value,
                                key.comment.empty() ? "" : "  # " + one_line(key.comment));
        if (table.path == "environment" && !wind_table.empty())
            text += fmt::format("wind = {{ table = {} }}\n", toml_string(wind_table));
    }
    return text;
}

std::string wind_table_text(const std::vector<WindLevel>& levels) {
    std::string text = "altitude,speed,from\nm,m/s,deg\n";
    for (const WindLevel& level : levels)
        text += fmt::format("{:.6g},{:.6g},{:.6g}\n", level.altitude, level.speed, level.from * 180.0 / pi);
    return text;
}

}  // namespace twinchute::exchange
