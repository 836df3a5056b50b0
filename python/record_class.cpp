#include "python/record_class.hpp"

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <filesystem>

#include "compare/report/html.hpp"
#include "lib/cli/long_run.hpp"
#include "lib/cli/output_dir.hpp"
#include "lib/cli/record_text.hpp"
#include "lib/record/metrics.hpp"
#include "lib/record/read_record.hpp"
#include "lib/record/record_json.hpp"
#include "lib/record/write_record.hpp"
#include "lib/scene/nearest.hpp"

namespace twinchute::python {
namespace {

struct MetricObject {
    std::string name, key, unit, kind, title, note;
    double value = 0.0;
};

MetricObject metric_of(const Metric& metric) {
    const MetricKey parts = split_metric_key(metric.key);
    return {std::string(parts.name),
            metric.key,
            std::string(parts.unit),
            std::string(metric_kind_name(metric.kind)),
            metric_words(metric.key),
            metric.note,
            metric.value};
}

/// By name, for reading alone.
const py::object& metrics_of(RecordObject& self) {
    if (!self.metrics) {
        py::dict all;
        for (const Metric& metric : self.record->metrics)
            all[py::str(std::string(split_metric_key(metric.key).name))] = metric_of(metric);
        self.metrics = py::module_::import("types").attr("MappingProxyType")(all);
    }
    return self.metrics;
}

/// Why a run has no such metric.
[[noreturn]] void fail_missing(const RunRecord& record, const std::string& name) {
    for (const MissingMetric& missing : record.missing)
        if (name == missing.metric || name == split_metric_key(missing.metric).name)
            throw py::key_error(fmt::format("{}: the run has none ({})", name, missing.why));
    std::vector<std::string_view> known;
    for (const Metric& metric : record.metrics)
        known.push_back(split_metric_key(metric.key).name);
    throw py::key_error(fmt::format("{}: the run has none, {}", name, suggest(name, known)));
}

double value_of(const RecordObject& self, const std::string& name) {
    for (const Metric& metric : self.record->metrics)
        if (name == metric.key || name == split_metric_key(metric.key).name) return metric.value;
    fail_missing(*self.record, name);
}

/// Arrays that look into the record and keep it alive.
py::dict history_of(const RecordObject& self) {
    using Owner = std::shared_ptr<const RunRecord>;
    const py::capsule owner(new Owner(self.record),
                            [](void* pointer) { delete static_cast<Owner*>(pointer); });
    py::dict all;
    for (const Channel& channel : self.record->channels) {
        py::array_t<double> array(static_cast<py::ssize_t>(channel.values.size()), channel.values.data(),
                                  owner);
        array.attr("flags").attr("writeable") = false;
        all[py::str(channel.name)] = std::move(array);
    }
    return all;
}

py::dict units_of(const RecordObject& self) {
    py::dict all;
    for (const Channel& channel : self.record->channels)
        all[py::str(channel.name)] = channel.unit;
    return all;
}

py::object frame_of(const RecordObject& self) {
    py::module_ pandas;
    try {
        pandas = py::module_::import("pandas");
    } catch (py::error_already_set& error) {
        if (!error.matches(PyExc_ImportError)) throw;
        throw py::import_error(
            "frame() needs pandas, which is not installed (Debian: python3-pandas); history has the same "
            "arrays "
            "without it");
    }
    py::object frame = pandas.attr("DataFrame")(history_of(self));
    frame = frame.attr("set_index")("time");
    frame.attr("attrs")["units"] = units_of(self);
    return frame;
}

std::string_view title_of(const RunRecord& record) {
    return record.fidelity == "rom" ? "reduced-order model" : "full aeroelastic model";
}

void write(const RecordObject& self, const std::filesystem::path& directory) {
    const py::gil_scoped_release released;
    check_output_dir(directory);
    const RunRecord& record = *self.record;
    const ShapeFrames frames = self.frames ? *self.frames : ShapeFrames{};
    FileBatch batch;
    batch.add(directory / "run.html",
              compare::record_html(record, frames, title_of(record), record.fidelity == "full"));
    add_record(batch, record, directory, frames);
    batch.commit();
    remove_abandoned(directory);
}

std::string number_text(double value, const std::string& unit) {
    return fmt::format("{:.6g}{}{}", value, unit.empty() ? "" : " ", unit);
}

void bind_parts(py::module_& module) {
    py::class_<MetricObject>(module, "Metric", "A number that a run came to; float() gives its value.")
        .def_readonly("name", &MetricObject::name, "As in a scene's tolerances, e.g. 'peak_force'.")
        .def_readonly("key", &MetricObject::key, "As in summary.json, with the unit, e.g. 'peak_force_N'.")
        .def_readonly("value", &MetricObject::value, "In `unit`.")
        .def_readonly("unit", &MetricObject::unit, "SI, 'g' for standard gravities; empty for ratios.")
        .def_readonly("kind", &MetricObject::kind, "'result', 'input' (repeats what it was told) or 'mixed'.")
        .def_readonly("title", &MetricObject::title, "In words.")
        .def_readonly("note", &MetricObject::note, "Which part is input, where one is.")
        .def("__float__", [](const MetricObject& self) { return self.value; })
        .def("__repr__", [](const MetricObject& self) {
            return fmt::format("<Metric {}: {} ({})>", self.name, number_text(self.value, self.unit),
                               self.kind);
        });
    py::class_<Event>(module, "Event", "Something that happened in a run.")
        .def_readonly("name", &Event::name, "E.g. 'snatch', 'full-open', 'peak-force', 'ground'.")
        .def_readonly("time", &Event::time, "[s] since release.")
        .def_readonly("altitude", &Event::altitude, "[m] of the payload above sea level.")
        .def_readonly("speed", &Event::speed, "[m/s] of the payload over ground.")
        .def("__repr__",
             [](const Event& self) { return fmt::format("<Event {} at {:.6g} s>", self.name, self.time); });
    py::class_<twinchute::Warning>(module, "RunWarning", "What a run says about its own limits.")
        .def_readonly("what", &twinchute::Warning::what, "The problem.")
        .def_readonly("why", &twinchute::Warning::why, "Its reason.")
        .def_readonly("suggestion", &twinchute::Warning::suggestion, "What to do about it.")
        .def("__str__",
             [](const twinchute::Warning& self) {
                 std::string text = self.what;
                 if (!self.why.empty()) text += fmt::format(" ({})", self.why);
                 return self.suggestion.empty() ? text : text + ", " + self.suggestion;
             })
        .def("__repr__",
             [](const twinchute::Warning& self) { return fmt::format("<RunWarning: {}>", self.what); });
}

}  // namespace

void bind_record(py::module_& module) {
    bind_parts(module);
    py::class_<RecordObject>(module, "Record",
                             "What a run came to. record['peak_force'] is the value of a metric.")
        .def_static(
            "load",
            [](const std::filesystem::path& directory) {
                return RecordObject{std::make_shared<const RunRecord>(read_record(directory))};
            },
            py::arg("directory"), "Reads the files of a record. Raises RecordError.")
        .def_property_readonly("metrics", &metrics_of,
                               "Metric by name; what the run does not have is absent.")
        .def("__getitem__", &value_of, py::arg("name"),
             "Value of a metric, by its name ('peak_force') or its key ('peak_force_N'). Raises KeyError, "
             "which says why.")
        .def_property_readonly(
            "history", &history_of,
            "Arrays over time by name, which look into the record: nothing is copied, and they\n"
            "cannot be written to. Units: see `units`.")
        .def_property_readonly("units", &units_of, "SI unit of each array of `history`; empty for ratios.")
        .def("frame", &frame_of,
             "The history as a pandas.DataFrame over time [s], with .attrs['units']. Raises ImportError "
             "without pandas.")
        .def_property_readonly(
            "events", [](const RecordObject& self) { return self.record->events; },
            "Events in the order of their times.")
        .def_property_readonly(
            "warnings", [](const RecordObject& self) { return self.record->warnings; },
            "What the run says about its limits.")
        .def_property_readonly(
            "status",
            [](const RecordObject& self) { return std::string(status_name(self.record->status.code)); },
            "How the run ended, e.g. 'completed', 'squids', 'not_opened'.")
        .def_property_readonly(
            "detail", [](const RecordObject& self) { return self.record->status.detail; },
            "How it ended, in a sentence.")
        .def_property_readonly(
            "fidelity", [](const RecordObject& self) { return self.record->fidelity; }, "'rom' or 'full'.")
        .def_property_readonly(
            "scene_name", [](const RecordObject& self) { return self.record->scene.name; },
            "Name of its scene.")
        .def_property_readonly(
            "summary", [](const RecordObject& self) { return from_json(summary_json(*self.record)); },
            "All of summary.json as a dict: metrics, energy, cost, estimates, left_out, provenance, ...")
        .def("to_dir", &write, py::arg("directory"),
             "Writes the files that the program writes with --out. Raises WriteError, and UsageError for a "
             "directory\n"
             "that holds anything else.")
        .def("__str__",
             [](const RecordObject& self) { return record_text(*self.record, title_of(*self.record), {}); })
        .def("__repr__", [](const RecordObject& self) {
            return fmt::format("<twinchute.Record of '{}' by {}: {}>", self.record->scene.name,
                               self.record->fidelity, status_name(self.record->status.code));
        });
}

}  // namespace twinchute::python
