#include "lib/scene/scene_error.hpp"

#include <fmt/format.h>

#include <utility>

namespace twinchute {
namespace {

std::string message(const SourcePlace& place, const std::string& key, const std::string& problem,
                    const std::string& why, const std::string& suggestion) {
    std::string text = place.file;
    if (place.line > 0) text += fmt::format(":{}:{}", place.line, place.column);
    if (!text.empty()) text += ": ";
    if (!key.empty()) text += key + ": ";
    text += problem;
    if (!why.empty()) text += " (" + why + ")";
    if (!suggestion.empty()) text += ", " + suggestion;
    return text;
}

}  // namespace

SceneError::SceneError(SourcePlace place, std::string key, std::string problem, std::string why,
                       std::string suggestion)
    : std::runtime_error(message(place, key, problem, why, suggestion)),
      place_(std::move(place)),
      key_(std::move(key)) {}

}  // namespace twinchute
