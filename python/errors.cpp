#include "python/errors.hpp"

#include <fmt/format.h>

#include "lib/cli/command.hpp"
#include "lib/record/record_error.hpp"
#include "lib/record/write_error.hpp"
#include "lib/scene/scene_error.hpp"
#include "lib/scene/units.hpp"
#include "python/convert.hpp"
#include "python/record_class.hpp"
#include "python/scene_class.hpp"

namespace twinchute::python {
namespace {

py::object new_error(const char* name, const std::string& text) {
    return py::module_::import("twinchute").attr(name)(text);
}

void raise(const py::object& error) {
    PyErr_SetObject(py::type::of(error).ptr(), error.ptr());
}

void set_place(const py::object& error, const std::string& file, int line, int column) {
    const bool known = line > 0;
    error.attr("file") = or_none(file);
    error.attr("line") = known ? py::object(py::int_(line)) : py::object(py::none());
    error.attr("column") = known ? py::object(py::int_(column)) : py::object(py::none());
}

void raise_scene_error(const SceneError& error) {
    std::string text = error.what();
    int line = error.place().line;
    // Lines of a dict are those of a text that nobody sees.
    const std::string unseen = fmt::format("{}:{}:{}: ", dict_name, line, error.place().column);
    if (error.place().file == dict_name) {
        if (text.starts_with(unseen)) text = fmt::format("{}: {}", dict_name, text.substr(unseen.size()));
        line = 0;
    }
    const py::object raised = new_error("SceneError", text);
    set_place(raised, error.place().file, line, error.place().column);
    raised.attr("key") = or_none(error.key());
    raised.attr("problem") = error.problem();
    raised.attr("why") = or_none(error.why());
    raised.attr("suggestion") = or_none(error.suggestion());
    raise(raised);
}

void raise_record_error(const RecordError& error) {
    const py::object raised = new_error("RecordError", error.what());
    set_place(raised, error.place().file, error.place().line, error.place().column);
    raise(raised);
}

}  // namespace

void translate_errors() {
    py::register_exception_translator([](std::exception_ptr thrown) {
        try {
            if (thrown) std::rethrow_exception(thrown);
        } catch (const SceneError& error) {
            raise_scene_error(error);
        } catch (const RecordError& error) {
            raise_record_error(error);
        } catch (const UsageError& error) {
            raise(new_error("UsageError", error.what()));
        } catch (const UnitError& error) {
            raise(new_error("UsageError", error.what()));
        } catch (const WriteError& error) {
            raise(new_error("WriteError", error.what()));
        }
    });
}

void require_success(const RecordObject& record) {
    const RunStatus& status = record.record->status;
    if (!is_numerical_failure(status.code)) return;
    const std::string text =
        fmt::format("{}: {}: {}{}{}", record.record->scene.file, record.record->fidelity,
                    status_name(status.code), status.detail.empty() ? "" : ": ", status.detail);
    const py::object error = py::module_::import("twinchute").attr("RunError")(text, record);
    raise(error);
    throw py::error_already_set();
}

}  // namespace twinchute::python
