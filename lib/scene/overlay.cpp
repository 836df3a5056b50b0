// One document over another: a scene over its design and its base, a case and --set over a scene.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "lib/scene/document.hpp"
#include "lib/scene/nearest.hpp"
#include "lib/scene/units.hpp"

namespace twinchute {

std::string case_title(std::string_view name) {
    return fmt::format("case '{}'", name);
}

std::optional<double> quantity(const Document& document, std::string_view path) {
    const auto found = document.entries.find(std::string(path));
    if (found == document.entries.end()) return std::nullopt;
    if (const auto* number = std::get_if<double>(&found->second.value)) return *number;
    if (const auto* whole = std::get_if<std::int64_t>(&found->second.value))
        return static_cast<double>(*whole);
    const auto* text = std::get_if<std::string>(&found->second.value);
    if (text == nullptr) return std::nullopt;
    try {
        return to_si(*text, found->second.key->unit);
    } catch (const UnitError&) {
        return std::nullopt;
    }
}

std::string_view shown_path(std::string_view path, std::string_view prefix) {
    return path.starts_with(prefix) ? path.substr(prefix.size()) : path;
}

void imply_models(Document& document) {
    for (Document& parachute : document.parachutes)
        imply_models(parachute);
    for (auto& [name, parachute] : document.named_parachutes)
        imply_models(parachute);
    std::map<std::string, Entry> implied;
    const auto place = [](const Entry& entry) {
        return std::pair(entry.key_place.line, entry.key_place.column);
    };
    for (const auto& [path, entry] : document.entries) {
        if (entry.key->only_with.empty()) continue;
        const std::string model = beside(selector_of(scene_keys(), *entry.key)->path, path);
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

namespace {

/// The parachute of a document that a name or a number means: the first is the document itself. One without a
/// name has that of the default.
Document& parachute_of(Document& document, const std::string& name, const Document& asked) {
    std::vector<std::string_view> names;
    std::vector<Document*> nameless;
    for (std::size_t k = 0; k <= document.parachutes.size(); ++k) {
        Document& one = k == 0 ? document : document.parachutes[k - 1];
        if (name == fmt::format("{}", k + 1)) return one;
        const auto entry = one.entries.find("parachute.name");
        if (entry == one.entries.end()) {
            nameless.push_back(&one);
        } else if (const auto* text = std::get_if<std::string>(&entry->second.value)) {
            if (*text == name) return one;
            names.push_back(*text);
        }
    }
    if (nameless.size() == 1 && name == find_key(scene_keys(), "parachute.name")->fallback)
        return *nameless.front();
    throw SceneError(
        asked.tables.at("parachute"), "parachute." + name, "unknown key, and no parachute has that name",
        fmt::format("the scene has {}", document.parachutes.size() + 1),
        names.empty() ? "write e.g. parachute.1.mass, or the name of a parachute" : suggest(name, names));
}

}  // namespace

bool predicts_filling(const Document& document) {
    const auto model = document.entries.find("parachute.filling.model");
    if (model == document.entries.end()) return false;
    const auto* word = std::get_if<std::string>(&model->second.value);
    return word && *word != "prescribed";
}

namespace {

/// A filling is prescribed or predicted: what is laid above decides.
void choose_filling(Document& lower, const Document& upper) {
    const auto prescribes = [](const auto& entry) { return prescribes_filling(entry.first); };
    if (predicts_filling(upper)) {
        for (const auto& [path, entry] : lower.entries)
            if (prescribes_filling(path) && entry.origin == InputOrigin::design)
                lower.overridden.push_back(path);
        std::erase_if(lower.entries, prescribes);
    } else if (std::ranges::any_of(upper.entries, prescribes)) {
        std::erase_if(lower.entries,
                      [](const auto& entry) { return is_below(entry.first, "parachute.filling"); });
    }
}

}  // namespace

void overlay(Document& lower, const Document& upper) {
    choose_filling(lower, upper);
    for (std::size_t k = 0; k < upper.parachutes.size(); ++k) {
        if (k == lower.parachutes.size()) lower.parachutes.emplace_back().file = lower.file;
        overlay(lower.parachutes[k], upper.parachutes[k]);
    }
    for (const std::string& list : upper.lists) {
        const auto is_below = [&](const auto& item) { return item.first.starts_with(list + "."); };
        std::erase_if(lower.entries, is_below);
        std::erase_if(lower.tables, is_below);
    }
    for (const auto& [path, entry] : upper.entries) {
        for (const std::string_view other : words_of(entry.key->instead_of))
            lower.entries.erase(beside(other, path));
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
    lower.warnings.insert(lower.warnings.end(), upper.warnings.begin(), upper.warnings.end());
    for (const auto& [name, parachute] : upper.named_parachutes)
        overlay(parachute_of(lower, name, parachute), parachute);
}

}  // namespace twinchute
