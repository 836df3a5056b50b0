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
    /// Parts of the complaint; empty where it has none.
    const std::string& problem() const { return complaint_.problem; }
    const std::string& why() const { return complaint_.why; }
    const std::string& suggestion() const { return complaint_.suggestion; }

    /// Repeats the complaint for one part of a scene: "file:line:column: part: key: ...".
    SceneError within(const std::string& part) const;

private:
    struct Complaint {
        std::string problem, why, suggestion;
        std::string parts;  ///< of the scene, outermost first: "case 'x': "
        std::string text(const std::string& key) const;
    };
    SceneError(SourcePlace place, std::string key, Complaint complaint);

    SourcePlace place_;
    std::string key_;
    Complaint complaint_;
};

}  // namespace twinchute
