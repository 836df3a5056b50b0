// A scene, or the cases of a series, with what it was read from: so that it can be read again with other
// values.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lib/scene/scene.hpp"
#include "python/convert.hpp"
#include "study/varied_scene.hpp"

namespace twinchute::python {

/// File of a scene that is a dict, in messages and records.
inline constexpr const char* dict_name = "<dict>";

struct SceneSource {
    std::string text, name;
    std::filesystem::path directory;  ///< where files that it names are looked for
};

class SceneObject {
public:
    /// Throws SceneError.
    SceneObject(SceneSource source, std::vector<std::string> overrides);

    /// The scene, or the case that was chosen of a series. Throws UsageError where none was.
    const Scene& scene() const { return *shared(); }
    /// For a run without the interpreter's lock, in which another thread may give this object other values.
    std::shared_ptr<const Scene> shared() const;
    const std::vector<Scene>& all() const { return *scenes_; }
    bool is_series() const { return !all().front().case_name.empty(); }
    bool is_chosen() const { return chosen_.has_value(); }
    const SceneSource& source() const { return *source_; }
    const std::vector<std::string>& overrides() const { return overrides_; }

    /// Throws UsageError for a case that is not there.
    SceneObject of_case(const std::string& name) const;
    /// The scene with more overrides; this one stays as it is. Throws SceneError.
    SceneObject with(const std::vector<std::string>& more) const;
    /// For who reads it again and again; outlives this object.
    study::SceneWith reader() const;

private:
    void read();

    std::shared_ptr<const SceneSource> source_;
    std::vector<std::string> overrides_;
    std::shared_ptr<const std::vector<Scene>> scenes_;
    std::optional<std::size_t> chosen_;
};

void bind_scene(py::module_& module);

}  // namespace twinchute::python
