#include "python/scene_class.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>

#include "lib/cli/command.hpp"
#include "lib/scene/data_files.hpp"
#include "lib/scene/nearest.hpp"
#include "lib/scene/read_scene.hpp"
#include "lib/scene/write_scene.hpp"

namespace twinchute::python {

SceneObject::SceneObject(SceneSource source, std::vector<std::string> overrides)
    : source_(std::make_shared<const SceneSource>(std::move(source))), overrides_(std::move(overrides)) {
    read();
    if (!is_series()) chosen_ = 0;
}

void SceneObject::read() {
    scenes_ = std::make_shared<const std::vector<Scene>>(
        read_scenes_text(source_->text, source_->name, source_->directory, overrides_));
}

std::shared_ptr<const Scene> SceneObject::shared() const {
    if (!chosen_)
        throw UsageError(
            fmt::format("{}: a series of {} cases where one scene is wanted, choose one of them, e.g. "
                        "scene.case('{}')",
                        source_->name, all().size(), all().front().case_name));
    return {scenes_, &all()[*chosen_]};
}

SceneObject SceneObject::of_case(const std::string& name) const {
    const auto found = std::ranges::find(all(), name, &Scene::case_name);
    if (!is_series() || found == all().end()) {
        std::vector<std::string_view> known;
        for (const Scene& scene : all())
            if (is_series()) known.push_back(scene.case_name);
        throw UsageError(fmt::format(
            "{}: there is no case '{}'{}", source_->name, name,
            is_series() ? ", " + suggest(name, known) : " (the scene is no series), use it as it is"));
    }
    SceneObject one = *this;
    one.chosen_ = static_cast<std::size_t>(found - all().begin());
    return one;
}

SceneObject SceneObject::with(const std::vector<std::string>& more) const {
    SceneObject other = *this;
    other.overrides_.insert(other.overrides_.end(), more.begin(), more.end());
    other.read();
    return other;
}

study::SceneWith SceneObject::reader() const {
    return [source = source_, overrides = overrides_,
            chosen = chosen_.value()](const std::vector<std::string>& more) {
        std::vector<std::string> all = overrides;
        all.insert(all.end(), more.begin(), more.end());
        return read_scenes_text(source->text, source->name, source->directory, all).at(chosen);
    };
}

namespace {

SceneObject load(const std::filesystem::path& path, const py::object& overrides,
                 const std::vector<std::string>& set) {
    return {{read_text_file(path), path.string(), path.parent_path()}, overrides_of(overrides, set)};
}

SceneObject from_dict(const py::dict& values, const std::filesystem::path& directory) {
    return {{toml_text_of(values), dict_name, directory}, {}};
}

py::tuple case_names(const SceneObject& self) {
    py::list names;
    for (const Scene& scene : self.all())
        if (self.is_series()) names.append(scene.case_name);
    return py::tuple(names);
}

py::dict inputs(const SceneObject& self) {
    py::dict all;
    for (const Input& input : self.scene().inputs)
        all[py::str(input.key)] =
            std::visit([](const auto& value) { return py::object(py::cast(value)); }, input.value);
    return all;
}

}  // namespace

void bind_scene(py::module_& module) {
    py::class_<SceneObject>(module, "Scene",
                            "A drop: what falls, from where, through what air, until when.\n\n"
                            "Quantities are numbers in SI or text with a unit, as in a scene file.")
        .def_static("load", &load, py::arg("path"), py::arg("overrides") = py::none(),
                    py::arg("set") = std::vector<std::string>{},
                    "Reads a scene file.\n\n"
                    "overrides: values by key, e.g. {'payload.mass': '160 kg'}; numbers are SI.\n"
                    "set: the same as the program's --set, e.g. [\"payload.mass='160 kg'\"].\n"
                    "Raises SceneError.")
        .def_static("from_dict", &from_dict, py::arg("values"),
                    py::arg("directory") = std::filesystem::path("."),
                    "Makes a scene of a dict with the tables and keys of a scene file.\n\n"
                    "directory: where files that it names are looked for first.\n"
                    "Raises SceneError, whose line and column are None.")
        .def(
            "set",
            [](SceneObject& self, const std::string& key, const py::object& value) {
                py::dict one;
                one[py::str(key)] = value;
                self = self.with(overrides_of(one, {}));
            },
            py::arg("key"), py::arg("value"),
            "Gives a key another value, in this scene: a number in SI or text with a unit.\n\n"
            "Raises SceneError, and then the scene is as before.")
        .def(
            "with_values",
            [](const SceneObject& self, const py::dict& values) {
                return self.with(overrides_of(values, {}));
            },
            py::arg("values"),
            "A scene with other values, by key; this one stays as it is. Raises SceneError.")
        .def("case", &SceneObject::of_case, py::arg("name"), "One case of a series. Raises UsageError.")
        .def_property_readonly("cases", &case_names,
                               "Names of the cases of a series; empty for a single scene.")
        .def_property_readonly(
            "name",
            [](const SceneObject& self) {
                return self.is_chosen() ? self.scene().name : self.all().front().name;
            },
            "Name of the scene; of a series that of its first case.")
        .def_property_readonly(
            "file", [](const SceneObject& self) { return self.source().name; },
            "File that it was read from; '<dict>' where it was made of one.")
        .def_property_readonly("inputs", &inputs, "Effective values by key, in SI, defaults included.")
        .def(
            "to_toml", [](const SceneObject& self) { return write_scene(self.scene()); },
            "The scene as the text of a scene file, every key written out, in SI and to the last bit.")
        .def("__eq__",
             [](const SceneObject& self, const SceneObject& other) {
                 if (self.is_chosen() != other.is_chosen()) return false;
                 return self.is_chosen() ? same_scene(self.scene(), other.scene())
                                         : std::ranges::equal(self.all(), other.all(), &same_scene);
             })
        .def("__eq__", [](const SceneObject&, const py::object&) { return false; })
        .def("__repr__",
             [](const SceneObject& self) {
                 const std::string name = py::repr(py::str(self.all().front().name));
                 return self.is_chosen()
                            ? fmt::format("<twinchute.Scene {}>",
                                          py::repr(py::str(self.scene().name)).cast<std::string>())
                            : fmt::format("<twinchute.Scene, a series of {}, first {}>", self.all().size(),
                                          name);
             })
        .def(py::pickle(
            [](const SceneObject& self) {
                return py::make_tuple(
                    self.source().text, self.source().name, self.source().directory.string(),
                    self.overrides(),
                    self.is_series() && self.is_chosen() ? self.scene().case_name : std::string());
            },
            [](const py::tuple& state) {
                SceneObject scene({state[0].cast<std::string>(), state[1].cast<std::string>(),
                                   state[2].cast<std::string>()},
                                  state[3].cast<std::vector<std::string>>());
                const auto name = state[4].cast<std::string>();
                return name.empty() ? scene : scene.of_case(name);
            }))
        .attr("__hash__") = py::none();
}

}  // namespace twinchute::python
