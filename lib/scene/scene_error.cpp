#include "lib/scene/scene_error.hpp"

#include <fmt/format.h>

#include <utility>

namespace twinchute {
namespace {

std::string message(const SourcePlace& place, const std::string& complaint) {
    std::string text = place.file;
    if (place.line > 0) text += fmt::format(":{}:{}", place.line, place.column);
    if (!text.empty()) text += ": ";
    return text + complaint;
}

}  // namespace

std::string SceneError::Complaint::text(const std::string& key) const {
    std::string text = parts;
    if (!key.empty()) text += key + ": ";
    text += problem;
    if (!why.empty()) text += " (" + why + ")";
    if (!suggestion.empty()) text += ", " + suggestion;
    return text;
}

SceneError::SceneError(SourcePlace place, std::string key, std::string problem, std::string why,
                       std::string suggestion)
    : SceneError(std::move(place), std::move(key),
                 Complaint{std::move(problem), std::move(why), std::move(suggestion), ""}) {}

SceneError::SceneError(SourcePlace place, std::string key, Complaint complaint)
    : std::runtime_error(message(place, complaint.text(key))),
      place_(std::move(place)),
      key_(std::move(key)),
      complaint_(std::move(complaint)) {}

SceneError SceneError::within(const std::string& part) const {
    Complaint complaint = complaint_;
    complaint.parts.insert(0, part + ": ");
    return {place_, key_, std::move(complaint)};
}

}  // namespace twinchute
