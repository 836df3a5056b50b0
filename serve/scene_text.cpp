#include "serve/scene_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "lib/scene/data_files.hpp"
#include "lib/scene/nearest.hpp"
#include "lib/scene/read_scene.hpp"
#include "lib/scene/scene_error.hpp"

namespace twinchute::serve {
namespace {

constexpr std::string_view example = "c9-inflation";  // where nobody names a scene
constexpr int deepest = 4;                            // levels of an object that is asked for

}  // namespace

std::string OpenedScene::text() const {
    return file == stdin_name ? stdin_text() : read_text_file(file);
}

OpenedScene opened_scene(const std::string& operand) {
    OpenedScene opened;
    if (operand == "-") {
        opened.file = stdin_name;
    } else if (operand.empty()) {
        const auto file = find_data_file("scenes", example, {});
        if (!file)
            throw SceneError({}, "", fmt::format("there is no scene '{}' in the data", example),
                             "it is not installed", "name a scene, or set TWINCHUTE_DATA");
        opened = {file->string(), file->parent_path(), true};
    } else {
        opened = {operand, std::filesystem::path(operand).parent_path(), false};
    }
    static_cast<void>(opened.text());
    return opened;
}

nlohmann::json object_of(const std::string& body, std::initializer_list<std::string_view> keys) {
    nlohmann::json object;
    try {
        object = nlohmann::json::parse(body, [](int depth, nlohmann::json::parse_event_t, nlohmann::json&) {
            if (depth > deepest)
                throw BadBody(fmt::format("the body is deeper than {} levels, send less", deepest));
            return true;
        });
    } catch (const nlohmann::json::exception& error) {
        throw BadBody(fmt::format("the body is not JSON ({}), correct it", error.what()));
    }
    if (!object.is_object()) throw BadBody("the body is no object, send {\"text\": ...}");
    for (const auto& [key, value] : object.items())
        if (std::ranges::count(keys, key) == 0)
            throw BadBody(
                fmt::format("'{}' is not known here, {}", key, suggest(key, {keys.begin(), keys.end()})));
    return object;
}

std::string text_at(const nlohmann::json& object, const char* key, std::string_view otherwise) {
    const auto found = object.find(key);
    if (found == object.end()) return std::string(otherwise);
    if (!found->is_string()) throw BadBody(fmt::format("'{}' is not text, send a string", key));
    return found->get<std::string>();
}

std::vector<std::string> texts_at(const nlohmann::json& object, const char* key, std::string_view example) {
    std::vector<std::string> texts;
    const auto list = object.find(key);
    if (list == object.end()) return texts;
    if (!list->is_array()) throw BadBody(fmt::format("'{}' is no list, send [\"{}\"]", key, example));
    for (const nlohmann::json& one : *list) {
        if (!one.is_string())
            throw BadBody(fmt::format("'{}' holds more than text, send [\"{}\"]", key, example));
        texts.push_back(one.get<std::string>());
    }
    return texts;
}

SceneRequest scene_request(const nlohmann::json& object) {
    if (!object.contains("text")) throw BadBody("'text' is absent, send that of a scene");
    SceneRequest request{text_at(object, "text", ""), texts_at(object, "set", "payload.mass=120 kg"),
                         text_at(object, "case", "")};
    for (std::string& text : request.overrides)
        text.insert(0, "--set ");
    return request;
}

SceneRequest scene_request(const std::string& body) {
    return scene_request(object_of(body, {"text", "set", "case"}));
}

ReadScene read(const SceneRequest& request, const OpenedScene& opened) {
    std::vector<Scene> scenes =
        read_scenes_text(request.text, opened.file, opened.directory, request.overrides, Bases::beneath);
    std::vector<std::string> cases;
    for (const Scene& scene : scenes)
        if (!scene.case_name.empty()) cases.push_back(scene.case_name);
    auto chosen = scenes.begin();
    if (!request.case_name.empty()) {
        chosen = std::ranges::find(scenes, request.case_name, &Scene::case_name);
        if (chosen == scenes.end())
            throw BadBody(fmt::format("there is no case '{}', {}", request.case_name,
                                      suggest(request.case_name, {cases.begin(), cases.end()})));
    }
    return {std::move(*chosen), std::move(cases)};
}

}  // namespace twinchute::serve
