#include "lib/scene/read_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <utility>

#include "lib/math/sha256.hpp"
#include "lib/scene/assemble.hpp"
#include "lib/scene/canopy_types.hpp"
#include "lib/scene/data_files.hpp"
#include "lib/scene/document.hpp"
#include "lib/scene/values.hpp"

namespace twinchute {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view diameter_key = "parachute.nominal_diameter";

/// [m] D0 of a design; nothing where it has none. Its other sizes belong to it, so that it is checked even
/// where the scene has another one.
std::optional<double> diameter_of(const Document& design) {
    const auto entry = design.entries.find(std::string(diameter_key));
    if (entry == design.entries.end()) return std::nullopt;
    const auto diameter = quantity(design, diameter_key);
    if (!diameter || !entry->second.key->range.contains(*diameter))
        throw SceneError(entry->second.value_place, "nominal_diameter", "is not a diameter in range",
                         allowed_text(*entry->second.key), "correct the value or its unit");
    return diameter;
}

/// Puts the design that a document names under it: keys in the scene win.
void add_design(Document& document) {
    const auto design = document.entries.find("parachute.design");
    if (design == document.entries.end()) return;
    const auto* name = std::get_if<std::string>(&design->second.value);
    if (!name) return;  // the wrong type is refused with the other values
    const fs::path& directory = design->second.directory;
    const auto path =
        data_file("parachutes", *name, "parachute.design", design->second.value_place, directory);
    Document below =
        read_document(read_text_file(path), path.string(),
                      {design_keys(), "parachute.", InputOrigin::design, "parachute.design", directory});
    if (document.entries.contains(std::string(diameter_key))) document.design_diameter = diameter_of(below);
    below.file = document.file;
    overlay(below, document);
    document.entries = std::move(below.entries);
    document.tables = std::move(below.tables);
    document.warnings = std::move(below.warnings);
    document.overridden = std::move(below.overridden);
}

/// Directories in which bases may lie; none: anywhere.
using Fence = std::vector<fs::path>;

Fence fence_of(Bases bases, const fs::path& directory) {
    if (bases == Bases::anywhere) return {};
    Fence fence = data_directories(directory);
    for (fs::path& place : fence)
        place = fs::weakly_canonical(fs::absolute(place));
    return fence;
}

/// Refuses a path that leaves the fence before it looks whether anything is there.
void refuse_outside(const Fence& fence, const Entry& base, const fs::path& file) {
    if (fence.empty()) return;
    const fs::path whole = fs::weakly_canonical(fs::absolute(file));
    const bool inside = std::ranges::any_of(
        fence, [&](const fs::path& place) { return std::ranges::mismatch(place, whole).in1 == place.end(); });
    if (!inside)
        throw SceneError(base.value_place, "base", "leaves the directory of the scene",
                         fmt::format("this scene may name files beneath {} and scenes of the data alone",
                                     fence.front().string()),
                         "copy the file there and name it by its path from there");
}

/// The file that `base` names: seen from the file it stands in, or among the scenes of the data.
fs::path base_file(const Entry& base, const Fence& fence) {
    const auto* name = std::get_if<std::string>(&base.value);
    if (!name)
        throw SceneError(base.value_place, "base", "a number where text belongs", "",
                         "name the file of a scene");
    std::error_code ignored;
    const fs::path beside = base.directory / *name;
    refuse_outside(fence, base, beside);
    if (fs::is_regular_file(beside, ignored)) return beside;
    if (const auto file = find_table_file(*name, base.directory)) return *file;
    if (is_data_name(*name))
        for (const fs::path& place : data_directories(base.directory))
            if (fs::path file = place / "scenes" / *name; fs::is_regular_file(file, ignored)) return file;
    throw SceneError(base.value_place, "base", fmt::format("there is no scene '{}'", *name),
                     "looked beside this file and in the scenes of the data", "check the path");
}

/// Puts the scene that a document is based on under it, and what that one is based on under both.
/// `chain`: the files that led here, this one last.
void add_base(Document& document, std::vector<fs::path> chain, const Fence& fence) {
    const auto entry = document.entries.find("base");
    if (entry == document.entries.end()) return;
    const Entry base = entry->second;
    const fs::path file = base_file(base, fence);
    std::error_code ignored;
    const bool round =
        std::ranges::any_of(chain, [&](const fs::path& seen) { return fs::equivalent(seen, file, ignored); });
    chain.push_back(file);
    if (round) {
        std::vector<std::string> names;
        for (const fs::path& link : chain)
            names.push_back(link.filename().string());
        throw SceneError(base.value_place, "base", "goes round in a circle",
                         fmt::format("{}", fmt::join(names, " -> ")),
                         "base a scene on one that does not lead back to it");
    }
    Document below = read_document(read_text_file(file), file.string(),
                                   {scene_keys(), "", InputOrigin::given, "", file.parent_path()});
    add_base(below, std::move(chain), fence);
    overlay(below, document);
    below.file = document.file;
    if (!document.cases.empty()) below.cases = std::move(document.cases);
    document = std::move(below);
}

Document read_whole(std::string_view text, const std::string& name, const fs::path& directory, Bases bases) {
    Document document = read_document(text, name, {scene_keys(), "", InputOrigin::given, "", directory});
    add_base(document, {name}, fence_of(bases, directory));
    return document;
}

std::vector<Document> read_overrides(const std::vector<std::string>& overrides, const fs::path& directory) {
    std::vector<Document> layers;
    for (const std::string& assignment : overrides)
        layers.push_back(read_override(assignment, {scene_keys(), "", InputOrigin::given, "", directory}));
    return layers;
}

/// The document as it would be with one of its further parachutes alone.
Document alone(const Document& document, const Document& parachute) {
    Document one = document;
    std::erase_if(one.entries, [](const auto& item) { return item.first.starts_with("parachute."); });
    std::erase_if(one.tables, [](const auto& item) { return item.first.starts_with("parachute"); });
    for (const auto& [path, entry] : parachute.entries)
        one.entries.insert_or_assign(path, entry);
    for (const auto& [path, place] : parachute.tables)
        one.tables.insert_or_assign(path, place);
    one.warnings = parachute.warnings;
    return one;
}

/// With several parachutes a key of "the" parachute would be one of the first.
void refuse_nameless(const Document& layer, const Document& document) {
    if (document.parachutes.empty() || layer.file == document.file) return;
    for (const auto& [path, entry] : layer.entries)
        if (path.starts_with("parachute."))
            throw SceneError(entry.key_place, path, "the scene has several parachutes",
                             fmt::format("there are {}", document.parachutes.size() + 1),
                             "write parachute.NAME." + path.substr(std::string_view("parachute.").size()));
}

/// Refuses a filling that the scene itself both prescribes and predicts.
void refuse_two_fillings(const Document& document) {
    if (!predicts_filling(document)) return;
    const std::string& model = std::get<std::string>(document.entries.at("parachute.filling.model").value);
    for (const auto& [path, entry] : document.entries)
        if (prescribes_filling(path))
            throw SceneError(entry.key_place, path, "is not used",
                             fmt::format("parachute.filling is '{}': how it fills is a result", model),
                             "take it out, or write filling = \"prescribed\"");
}

/// With what its design and its canopy type give.
Document with_design(Document document) {
    refuse_two_fillings(document);
    add_design(document);
    add_canopy_type(document);
    return document;
}

Scene finished(Document document, const std::vector<Document>& overrides) {
    for (const Document& layer : overrides) {
        refuse_nameless(layer, document);
        overlay(document, layer);
    }
    const DocumentKind kind{scene_keys()};
    std::vector<Document> others;
    for (const Document& parachute : document.parachutes)
        others.push_back(with_design(alone(document, parachute)));
    document = with_design(std::move(document));
    std::vector<Values> values;
    values.emplace_back(document, kind);
    Scene scene = assemble_scene(values.front());
    if (!others.empty()) name_inputs(scene.inputs, scene.parachutes.front().name);
    for (const Document& other : others)
        add_parachute(scene, values.emplace_back(other, kind));
    check_scene(scene, values);
    others.push_back(std::move(document));
    for (const Document& one : others)
        scene.warnings.insert(scene.warnings.end(), one.warnings.begin(), one.warnings.end());
    return scene;
}

}  // namespace

std::vector<Scene> read_scenes_text(std::string_view text, const std::string& name, const fs::path& directory,
                                    const std::vector<std::string>& overrides, Bases bases) {
    const Document document = read_whole(text, name, directory, bases);
    const std::vector<Document> layers = read_overrides(overrides, directory);
    std::vector<Scene> scenes;
    if (document.cases.empty()) scenes.push_back(finished(document, layers));
    for (const DocumentCase& one : document.cases) {
        Document with_case = document;
        overlay(with_case, one.set);
        try {
            Scene& scene = scenes.emplace_back(finished(std::move(with_case), layers));
            scene.case_name = one.name;
            if (!one.set.entries.contains("name")) scene.name += ", " + one.name;
        } catch (const SceneError& error) {
            throw error.within(case_title(one.name));
        }
    }
    for (Scene& scene : scenes) {
        scene.file = name;
        scene.sha256 = sha256_hex(text);
    }
    return scenes;
}

std::vector<Scene> read_scenes(const fs::path& file, const std::vector<std::string>& overrides) {
    if (file == "-") return read_scenes_text(stdin_text(), std::string(stdin_name), {}, overrides);
    return read_scenes_text(read_text_file(file), file.string(), file.parent_path(), overrides);
}

Scene read_scene_text(std::string_view text, const std::string& name, const fs::path& directory,
                      const std::vector<std::string>& overrides, Bases bases) {
    std::vector<Scene> scenes = read_scenes_text(text, name, directory, overrides, bases);
    if (!scenes.front().case_name.empty())
        throw SceneError({name, 1, 1}, "case",
                         fmt::format("a series of {} where a single scene is wanted", scenes.size()), "",
                         "take out [[case]] or choose one of them");
    return std::move(scenes.front());
}

Scene read_scene(const fs::path& file, const std::vector<std::string>& overrides) {
    return read_scene_text(read_text_file(file), file.string(), file.parent_path(), overrides);
}

std::map<std::string, Tolerance> read_tolerances(const std::vector<std::string>& overrides) {
    const DocumentKind kind{{find_key(scene_keys(), "compare.tolerance"), 1}, "", InputOrigin::given, "", {}};
    Document document;
    for (const std::string& assignment : overrides)
        overlay(document, read_override(assignment, kind));
    return Values(document, kind).tolerances();
}

}  // namespace twinchute
