// One document over another: a scene over its design and its base, a case and --set over a scene.
#include <fmt/format.h>

#include <utility>

#include "lib/scene/document.hpp"

namespace twinchute {

std::string case_title(std::string_view name) {
    return fmt::format("case '{}'", name);
}

std::string_view shown_path(std::string_view path, std::string_view prefix) {
    return path.starts_with(prefix) ? path.substr(prefix.size()) : path;
}

void imply_models(Document& document) {
    std::map<std::string, Entry> implied;
    const auto place = [](const Entry& entry) {
        return std::pair(entry.key_place.line, entry.key_place.column);
    };
    for (const auto& [path, entry] : document.entries) {
        if (entry.key->only_with.empty()) continue;
        const std::string model(selector_of(scene_keys(), *entry.key)->path);
        // How a parachute is deployed is always said.
        if (!model.ends_with(".model") || document.entries.contains(model)) continue;
        const auto before = implied.find(model);
        if (before != implied.end() && place(before->second) <= place(entry)) continue;
        Entry& added = implied[model] = entry;
        added.key = find_key(scene_keys(), model);
        added.value = std::string(words_of(entry.key->only_with).front());  // the first of several that fit
        added.source.clear();
    }
    document.entries.merge(implied);
}

void overlay(Document& lower, const Document& upper) {
    for (const auto& [path, entry] : upper.entries) {
        for (const std::string_view other : words_of(entry.key->instead_of))
            lower.entries.erase(std::string(other));
        const auto* chosen = std::get_if<std::string>(&entry.value);
        if (!entry.key->is_selector() || !chosen) continue;
        const std::string table = path.substr(0, path.rfind('.') + 1);
        std::erase_if(lower.entries, [&](const auto& below) {
            return below.first.starts_with(table) && !below.second.key->goes_with(*chosen);
        });
    }
    for (const auto& [path, entry] : upper.entries)
        lower.entries.insert_or_assign(path, entry);
    for (const auto& [path, place] : upper.tables)
        lower.tables.insert_or_assign(path, place);
}

}  // namespace twinchute
