#include "python/convert.hpp"

#include <fmt/format.h>

namespace twinchute::python {
namespace {

/// Text as a TOML string in one line.
std::string toml_string(std::string_view text) {
    std::string out = "\"";
    for (const char c : text) {
        const auto code = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\')
            out += {'\\', c};
        else if (code < 0x20 || code == 0x7f)
            out += fmt::format("\\u{:04x}", code);
        else
            out += c;
    }
    return out + "\"";
}

std::string list_of(const py::handle& list, const std::string& key) {
    std::string out;
    for (const py::handle item : list)
        out += (out.empty() ? "[" : ", ") + toml_of(item, key);
    return (out.empty() ? "[" : out) + "]";
}

std::string table_of(const py::dict& dict, const std::string& key) {
    std::string out;
    for (const auto& [name, value] : dict) {
        const std::string word = py::str(name);
        out += (out.empty() ? "{ " : ", ") + toml_string(word) + " = " + toml_of(value, key + "." + word);
    }
    return out.empty() ? "{}" : out + " }";
}

bool is_bare(std::string_view key) {
    return !key.empty() &&
           key.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.") ==
               std::string_view::npos;
}

}  // namespace

std::string toml_of(const py::handle& value, const std::string& key) {
    if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
    if (py::isinstance<py::str>(value)) return toml_string(value.cast<std::string>());
    if (py::isinstance<py::dict>(value)) return table_of(py::reinterpret_borrow<py::dict>(value), key);
    if (py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value)) return list_of(value, key);
    if (PyIndex_Check(value.ptr())) {  // int, and whole numbers of numpy
        const auto number = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
        if (!number) {
            PyErr_Clear();
            return list_of(value, key);  // an array
        }
        return py::str(number);
    }
    if (py::hasattr(value, "__fspath__"))
        return toml_string(py::str(value.attr("__fspath__")()).cast<std::string>());
    if (py::hasattr(value, "__float__") && !py::hasattr(value, "__len__")) {
        const double number = py::float_(py::reinterpret_borrow<py::object>(value));
        return fmt::format("{}", number);
    }
    throw py::type_error(
        fmt::format("{}: a {} is no value of a scene (numbers, text, lists and dicts are), give a number "
                    "in SI or text with a unit",
                    key, py::str(py::type::of(value).attr("__name__")).cast<std::string>()));
}

std::string toml_text_of(const py::dict& dict) {
    std::string text;
    for (const auto& [name, value] : dict) {
        const std::string key = py::str(name);
        text += fmt::format("{} = {}\n", is_bare(key) ? key : toml_string(key), toml_of(value, key));
    }
    return text;
}

std::vector<std::string> overrides_of(const py::object& overrides, const std::vector<std::string>& set) {
    std::vector<std::string> all;
    if (!overrides.is_none())
        for (const auto& [name, value] : overrides.cast<py::dict>()) {
            const std::string key = py::str(name);
            all.push_back(fmt::format("--set {}={}", key, toml_of(value, key)));
        }
    for (const std::string& text : set)
        all.push_back("--set " + text);
    return all;
}

py::object from_json(const std::string& text) {
    return py::module_::import("json").attr("loads")(text);
}

}  // namespace twinchute::python
