#include "lib/scene/scene_error.hpp"

#include <fmt/format.h>

#include <utility>

namespace twinchute {
namespace {

std::string complaint_text(const std::string& key, const std::string& problem, const std::string& why,
                           const std::string& suggestion) {
    std::string text;
    if (!key.empty()) text += key + ": ";
    text += problem;
    if (!why.empty()) text += " (" + why + ")";
    if (!suggestion.empty()) text += ", " + suggestion;
    return text;
}

std::string message(const SourcePlace& place, const std::string& complaint) {
    std::string text = place.file;
    if (place.line > 0) text += fmt::format(":{}:{}", place.line, place.column);
    if (!text.empty()) text += ": ";
    return text + complaint;
}

}  // namespace

SceneError::SceneError(SourcePlace place, std::string key, std::string problem, std::string why,
                       std::string suggestion)
    : SceneError(place, key, complaint_text(key, problem, why, suggestion), "") {}

SceneError::SceneError(SourcePlace place, std::string key, std::string complaint, const std::string& part)
    : std::runtime_error(message(place, part.empty() ? complaint : part + ": " + complaint)),
      place_(std::move(place)),
      key_(std::move(key)),
      complaint_(part.empty() ? std::move(complaint) : part + ": " + complaint) {}

SceneError SceneError::within(const std::string& part) const {
    return {place_, key_, complaint_, part};
}

}  // namespace twinchute
