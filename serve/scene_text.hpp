// Scenes that come as text, read as if they lay where the opened scene lies.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <nlohmann/json_fwd.hpp>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "lib/scene/scene.hpp"

namespace twinchute::serve {

/// The scene that the page opens.
struct OpenedScene {
    std::string file;                 ///< as messages name it
    std::filesystem::path directory;  ///< where files that texts name are looked for first
    bool of_data = false;             ///< nobody named one: an example, which is not to be changed

    /// Its text as the file is now. Throws SceneError.
    std::string text() const;
};

/// `operand`: a file, "-" for standard input, or nothing for an example. Throws SceneError where it cannot be
/// read.
OpenedScene opened_scene(const std::string& operand);

/// Body of a request that is no JSON, or not what is wanted; what() is for its sender.
class BadBody : public std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// {"text": TOML, "set": ["payload.mass=120 kg", ...], "case": NAME}
struct SceneRequest {
    std::string text;
    std::vector<std::string> overrides;  ///< as of --set
    std::string case_name;               ///< of a series; empty: its first
};

/// Throws BadBody unless the body is an object that is no deeper than a few levels and has no keys but these.
nlohmann::json object_of(const std::string& body, std::initializer_list<std::string_view> keys);
/// Text at a key; `otherwise` where there is none. Throws BadBody.
std::string text_at(const nlohmann::json& object, const char* key, std::string_view otherwise);
/// Texts at a key; none where there is no such key. Throws BadBody, which shows `example`.
std::vector<std::string> texts_at(const nlohmann::json& object, const char* key, std::string_view example);

/// Throws BadBody.
SceneRequest scene_request(const nlohmann::json& object);
SceneRequest scene_request(const std::string& body);  ///< of nothing but the scene

/// One scene, and the names of all cases of its series.
struct ReadScene {
    Scene scene;
    std::vector<std::string> cases;
};

/// Throws SceneError, with the words of the command line, and BadBody for a case that is not there.
ReadScene read(const SceneRequest& request, const OpenedScene& opened);

}  // namespace twinchute::serve
