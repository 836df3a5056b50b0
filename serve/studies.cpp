#include "serve/studies.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "lib/cli/command.hpp"
#include "lib/scene/scene_error.hpp"
#include "study/calibrate/calibrate_command.hpp"
#include "study/campaign/campaign_command.hpp"

namespace twinchute::serve {
namespace {

namespace fs = std::filesystem;

/// The scene of a request with more overrides above its own.
study::SceneWith scene_with(SceneRequest request, const OpenedScene& opened) {
    return [request = std::move(request), opened](const std::vector<std::string>& more) {
        SceneRequest varied = request;
        varied.overrides.insert(varied.overrides.end(), more.begin(), more.end());
        return read(varied, opened).scene;
    };
}

std::vector<study::TextFile> files_at(const nlohmann::json& object) {
    constexpr std::string_view what_to_send = "send [{\"name\": \"drop.csv\", \"text\": ...}]";
    const auto list = object.find("files");
    if (list == object.end() || !list->is_array() || list->empty())
        throw BadBody(fmt::format("'files' is no list of tests, {}", what_to_send));
    std::vector<study::TextFile> files;
    for (const nlohmann::json& one : *list) {
        if (!one.is_object()) throw BadBody(fmt::format("'files' holds more than files, {}", what_to_send));
        const std::string name = text_at(one, "name", "");
        if (fs::path(name).filename() != name || name.empty() || name == "." || name == "..")
            throw BadBody(fmt::format("'{}' is no name of a file, {}", name, what_to_send));
        files.push_back({name, text_at(one, "text", "")});
    }
    return files;
}

/// Whether a text is what the opened file holds, so that a scene can be based on it.
bool is_of_file(const std::string& text, const OpenedScene& opened) {
    std::error_code ignored;
    return fs::is_regular_file(opened.file, ignored) && text == opened.text();
}

}  // namespace

AskedStudy asked_calibration(const std::string& body, const OpenedScene& opened, const Models& models,
                             const fs::path& place) {
    const nlohmann::json object = object_of(body, {"text", "set", "files", "vary"});
    const SceneRequest request = scene_request(object);
    const std::vector<study::TextFile> files = files_at(object);
    std::vector<study::Vary> vary;
    for (const std::string& text : texts_at(object, "vary", "parachute.drag_area"))
        vary.push_back(study::read_vary(text));
    ReadScene one = read(request, opened);
    if (!one.cases.empty())
        throw UsageError(
            fmt::format("{}: a series of {} cases where one scene is wanted (tests are of one "
                        "canopy), take out [[case]]",
                        opened.file, one.cases.size()));
    study::require_calibratable(one.scene, models.rom);
    std::vector<study::DropTest> tests = study::read_drop_tests(files);
    std::optional<fs::path> directory;
    if (is_of_file(request.text, opened)) directory = place;
    return {one.scene, study::calibration_work(scene_with(request, opened), one.scene, std::move(tests),
                                               models.rom, std::move(vary), std::move(directory))};
}

AskedStudy asked_campaign(const std::string& body, const OpenedScene& opened, const Models& models) {
    const nlohmann::json object = object_of(body, {"text", "set", "case", "campaign", "name"});
    SceneRequest request = scene_request(object);
    if (!object.contains("campaign")) throw BadBody("'campaign' is absent, send the text of its file");
    ReadScene one = read(request, opened);
    study::CampaignText campaign;
    campaign.text = text_at(object, "campaign", "");
    campaign.name = text_at(object, "name", "campaign.toml");
    campaign.directory = opened.directory;
    campaign.scene_file = fs::path(opened.file).filename().string();
    if (!request.overrides.empty() || !is_of_file(request.text, opened)) campaign.scene_file += ", changed";
    campaign.overrides = std::exchange(request.overrides, {});
    campaign.scene_with = scene_with(std::move(request), opened);
    campaign.threads = page_threads();
    return {std::move(one.scene), study::campaign_work(std::move(campaign), models.rom, models.full)};
}

}  // namespace twinchute::serve
