#include "lib/scene/read_scene.hpp"

#include "lib/math/sha256.hpp"
#include "lib/scene/assemble.hpp"
#include "lib/scene/data_files.hpp"
#include "lib/scene/document.hpp"
#include "lib/scene/values.hpp"

namespace twinchute {
namespace {

/// Puts the design that a document names under it: keys in the scene win.
void add_design(Document& document, const std::filesystem::path& directory) {
    const auto design = document.entries.find("parachute.design");
    if (design == document.entries.end()) return;
    const auto* name = std::get_if<std::string>(&design->second.value);
    if (!name) return;  // the wrong type is refused with the other values
    const auto path =
        data_file("parachutes", *name, "parachute.design", design->second.value_place, directory);
    Document below = read_document(read_text_file(path), path.string(),
                                   {design_keys(), "parachute.", InputOrigin::design, "parachute.design"});
    below.file = document.file;
    overlay(below, document);
    document = std::move(below);
}

}  // namespace

Scene read_scene_text(std::string_view text, const std::string& name, const std::filesystem::path& directory,
                      const std::vector<std::string>& overrides) {
    const DocumentKind kind{scene_keys()};
    Document document = read_document(text, name, kind);
    for (const std::string& assignment : overrides)
        overlay(document, read_override(assignment, kind));
    add_design(document, directory);

    const Values values(document, kind);
    Scene scene = assemble_scene(values, directory);
    check_scene(scene, values);
    scene.file = name;
    scene.sha256 = sha256_hex(text);
    return scene;
}

Scene read_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
    return read_scene_text(read_text_file(file), file.string(), file.parent_path(), overrides);
}

}  // namespace twinchute
