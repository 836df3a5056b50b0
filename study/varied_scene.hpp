// A scene with other values of a few keys, thousands of times.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "lib/scene/keys.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::study {

/// Reads the scene with more overrides, each "key=value".
using SceneWith = std::function<Scene(const std::vector<std::string>& more)>;

/// Values of keys go straight into a scene that was read once, where that gives what reading gives: found out
/// at the first value of each. Otherwise the scene is read again each time.
class VariedScene {
public:
    /// `probe`: a value of each key, other than the scene's own. Throws SceneError.
    VariedScene(SceneWith scene_with, std::vector<std::string> keys, const std::vector<double>& probe);
    VariedScene(SceneWith scene_with, std::vector<std::string> keys, const std::vector<KeyValue>& probe);

    /// Throws SceneError for values that are out of range or do not fit together, where it reads.
    Scene at(std::span<const double> values) const;
    /// The scene at these values by reading, with all that a record says of its inputs. Throws SceneError.
    Scene read(std::span<const double> values) const;
    Scene read(std::span<const KeyValue> values) const;
    bool is_quick() const { return quick_; }

    /// The scene as it was read, without inputs and warnings.
    const Scene& base() const { return base_; }
    /// Puts values into a copy of base(), as often as one likes. Each key's own range is checked, not how
    /// keys fit together, unless the scene has to be read again. Throws SceneError.
    void put(Scene& scene, std::span<const KeyValue> values) const;
    /// Whether putting gives what reading gives at these values as well; reads for good where not, and where
    /// reading refuses more than the range of a key. Throws SceneError where it refuses.
    bool check(const std::vector<KeyValue>& values);
    /// Checks at corners between two values of each key: each two keys meet at all four pairs of theirs. How
    /// keys fit together is seen where they go apart.
    void check_corners(const std::vector<KeyValue>& low, const std::vector<KeyValue>& high);

private:
    struct Setter {
        KeyRange range;
        std::function<void(Scene&, const KeyValue&)> set;
        bool takes(const KeyValue& value) const;  ///< by its own range
    };
    std::optional<std::vector<Setter>> setters() const;

    SceneWith scene_with_;
    std::vector<std::string> keys_;
    Scene base_;
    std::vector<Setter> setters_;
    bool quick_ = false;
};

}  // namespace twinchute::study
