// The one exception that bad input throws.
#pragma once

#include <stdexcept>
#include <string>

namespace twinchute {

/// Where in a file something stands; line and column count from 1, 0 means unknown.
struct SourcePlace {
    std::string file;
    int line = 0;
    int column = 0;
};

/// Bad input: what() reads "file:line:column: key: problem (why), suggestion".
class SceneError : public std::runtime_error {
public:
    SceneError(SourcePlace place, std::string key, std::string problem, std::string why,
               std::string suggestion);

    const SourcePlace& place() const { return place_; }
    const std::string& key() const { return key_; }

    /// Repeats the complaint for one part of a scene: "file:line:column: part: key: ...".
    SceneError within(const std::string& part) const;

private:
    SceneError(SourcePlace place, std::string key, std::string complaint, const std::string& part);

    SourcePlace place_;
    std::string key_;
    std::string complaint_;  ///< what() after the place
};

}  // namespace twinchute
