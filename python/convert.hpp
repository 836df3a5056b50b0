// Values between Python and the toolkit.
#pragma once

#include <pybind11/pybind11.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace twinchute::python {

namespace py = pybind11;

/// A number, text, list or dict as TOML in one line, numbers to the last bit. `key`: whose value it is, for
/// messages. Throws TypeError.
std::string toml_of(const py::handle& value, const std::string& key);

/// A dict as the text of a scene file; its own keys may be paths with dots.
std::string toml_text_of(const py::dict& dict);

/// Overrides of a scene, as --set takes them: those of `overrides` (a dict, or None), then those of `set`.
std::vector<std::string> overrides_of(const py::object& overrides, const std::vector<std::string>& set);

/// Python objects of a JSON text, as json.loads makes them.
py::object from_json(const std::string& text);

/// None where there is no value.
template <class T>
py::object or_none(const std::optional<T>& value) {
    return value ? py::cast(*value) : py::none();
}

/// None where it is empty.
inline py::object or_none(const std::string& text) {
    return text.empty() ? py::object(py::none()) : py::object(py::str(text));
}

}  // namespace twinchute::python
