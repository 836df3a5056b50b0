#include "python/studies.hpp"

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <filesystem>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>

#include "fullsim/fidelity.hpp"
#include "lib/cli/command.hpp"
#include "lib/cli/output_dir.hpp"
#include "lib/cli/scene_command.hpp"
#include "lib/record/metrics.hpp"
#include "lib/record/record_json.hpp"
#include "lib/scene/nearest.hpp"
#include "lib/solve/hand_over.hpp"
#include "python/runs.hpp"
#include "python/scene_class.hpp"
#include "rom/fidelity.hpp"
#include "rom/size/size.hpp"
#include "study/calibrate/calibrate_command.hpp"
#include "study/calibrate/calibration.hpp"
#include "study/calibrate/calibration_files.hpp"
#include "study/campaign/campaign_command.hpp"
#include "study/many_runs.hpp"
#include "study/size/size_command.hpp"
#include "study/size/size_text.hpp"

namespace twinchute::python {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> as_words(const py::object& one_or_more) {
    std::vector<std::string> all;
    const auto add = [&all](const py::handle& item) {
        all.push_back(py::str(py::module_::import("os").attr("fspath")(item)));
    };
    if (py::isinstance<py::list>(one_or_more) || py::isinstance<py::tuple>(one_or_more))
        for (const py::handle item : one_or_more)
            add(item);
    else if (!one_or_more.is_none())
        add(one_or_more);
    return all;
}

// --- size -----------------------------------------------------------------------------------

struct SizingObject {
    Scene scene;
    rom::Sized sized;

    bool meets() const { return sized.best() != nullptr && sized.best()->meets(); }
    py::object sized_scene() const {
        if (!meets()) return py::none();
        return py::cast(SceneObject(
            {study::sized_scene_text(scene, *sized.best()), "<sized>", scene.file.parent_path()}, {}));
    }
};

std::shared_ptr<SizingObject> run_size(const SceneObject& scene) {
    const auto made = std::make_shared<SizingObject>(SizingObject{scene.scene(), {}});
    study::require_sizable(made->scene);
    watch(py::none(), [&](const Watched& watched) {
        try {
            made->sized = rom::size_scene(made->scene, watched.stop);
        } catch (const rom::Interrupted&) {
            return;  // what asked for it is thrown
        }
    });
    return made;
}

void bind_size(py::module_& module) {
    py::class_<SizingObject, std::shared_ptr<SizingObject>>(module, "Sizing",
                                                            "A parachute that meets limits.")
        .def_property_readonly("meets", &SizingObject::meets, "Whether the limits can be met.")
        .def_property_readonly("scene", &SizingObject::sized_scene,
                               "The sized scene; None where the limits cannot be met.")
        .def_property_readonly(
            "summary",
            [](const SizingObject& self) {
                return from_json(json_text(study::size_json(self.scene, self.sized)));
            },
            "What `twinchute size --json` prints, as a dict.")
        .def("__str__",
             [](const SizingObject& self) { return study::size_text(self.scene, self.sized, {}); });
    module.def(
        "size", &run_size, py::arg("scene"),
        "Finds the diameter, release speed or reefing that meets the limits in the scene's table `size`.\n\n"
        "Raises UsageError for a scene without limits.");
}

// --- calibrate ------------------------------------------------------------------------------

struct CalibrationObject {
    Scene scene;
    study::SceneWith scene_with;
    std::vector<study::DropTest> tests;  // outlive the calibration
    study::Calibration calibration = {};
};

std::shared_ptr<CalibrationObject> run_calibrate(const SceneObject& scene, const py::object& to,
                                                 const std::vector<std::string>& vary) {
    const Fidelity& rom = rom::rom_fidelity();
    const auto made =
        std::make_shared<CalibrationObject>(CalibrationObject{scene.scene(), scene.reader(), {}, {}});
    study::require_calibratable(made->scene, rom);
    study::CalibrationSettings settings;
    for (const std::string& text : vary)
        settings.vary.push_back(study::read_vary(text));
    for (const std::string& name : as_words(to))
        made->tests.push_back(study::read_drop_test(name, made->scene));
    if (made->tests.empty())
        throw UsageError("calibrate: no test is given (inputs are fitted to it), e.g. to='drop.csv'");
    watch(py::none(), [&](const Watched& watched) {
        settings.stop = watched.stop;
        made->calibration = study::calibrate(made->scene_with, made->tests, rom, settings);
    });
    return made;
}

void write_directory(CalibrationObject& self, const fs::path& directory) {
    if (self.scene.file == dict_name)
        throw UsageError(
            "to_dir: the scene is a dict (the calibrated scene names the file that it is based on), write "
            "scene.to_toml() to a file and calibrate that");
    const py::gil_scoped_release released;
    check_output_dir(directory);
    write_calibration(self.calibration, self.scene_with, self.scene, self.tests, directory);
}

/// Estimate, standard deviation and 95 % interval of each input.
py::dict parameters_of(const CalibrationObject& self) {
    py::dict all;
    for (const study::Parameter& p : self.calibration.parameters) {
        py::dict one;
        one["estimate"] = p.estimate;
        one["low"] = p.interval.low;
        one["high"] = p.interval.high;
        one["identified"] = p.identified;
        one["why"] = or_none(p.why);
        all[py::str(p.label())] = std::move(one);
    }
    return all;
}

void bind_calibrate(py::module_& module) {
    py::class_<CalibrationObject, std::shared_ptr<CalibrationObject>>(module, "Calibration",
                                                                      "Inputs of a scene from tests.")
        .def_property_readonly(
            "parameters", &parameters_of,
            "By key: a dict with estimate, and low and high of the 95 % interval, in SI; `identified`,\n"
            "and `why` where it is not.")
        .def_property_readonly(
            "consistent", [](const CalibrationObject& self) { return self.calibration.is_consistent(); },
            "False where model and tests do not go together; `summary` says why.")
        .def_property_readonly(
            "summary",
            [](const CalibrationObject& self) {
                return from_json(calibration_json(self.calibration, self.scene, self.tests));
            },
            "All of calibration.json as a dict.")
        .def("to_dir", &write_directory, py::arg("directory"),
             "Writes calibrated.toml, the report and calibration.json, as `twinchute calibrate --out`.")
        .def("__str__", [](const CalibrationObject& self) {
            return calibration_text(self.calibration, self.scene, self.tests, {});
        });
    module.def("calibrate", &run_calibrate, py::arg("scene"), py::arg("to"),
               py::arg("vary") = std::vector<std::string>{},
               "Fits inputs of the scene to tests.\n\n"
               "to: a file or several: CSV, TOML that describes a test, or the directory of a record.\n"
               "vary: inputs to fit, 'KEY' or 'KEY=LO..HI'; by default those of `twinchute calibrate`.\n"
               "Raises SceneError, RecordError, UsageError.");
}

// --- campaign -------------------------------------------------------------------------------

/// The command handles signals while it runs, as a program of its own would; then they are Python's again.
class SignalsOfPython {
public:
    SignalsOfPython() {
        for (std::size_t i = 0; i < signals.size(); ++i)
            sigaction(signals[i], nullptr, &kept_[i]);
    }
    ~SignalsOfPython() {
        for (std::size_t i = 0; i < signals.size(); ++i)
            sigaction(signals[i], &kept_[i], nullptr);
    }
    SignalsOfPython(const SignalsOfPython&) = delete;
    SignalsOfPython& operator=(const SignalsOfPython&) = delete;

private:
    static constexpr std::array signals{SIGINT, SIGTERM};
    std::array<struct sigaction, signals.size()> kept_{};
};

ExitCode run_alone(const Command& command, const Arguments& arguments) {
    static std::mutex one_at_a_time;
    const py::gil_scoped_release released;
    const std::scoped_lock guard(one_at_a_time);
    const SignalsOfPython signals;
    return command.run(arguments);
}

/// The results of a campaign, with the place of its files.
py::object run_campaign(const fs::path& file, const std::optional<fs::path>& out, const py::object& threads,
                        const py::object& overrides, bool resume, bool export_csv) {
    const Command command = study::campaign_command(rom::rom_fidelity(), fullsim::full_fidelity());
    const fs::path directory = out.value_or(default_output_dir(file));
    Arguments arguments;
    arguments.operand = file.string();
    arguments.operands = {file.string()};
    arguments.options["out"] = {directory.string()};
    arguments.options["threads"] = {std::to_string(threads_of(threads))};
    arguments.options["quiet"] = {""};
    if (resume) arguments.options["resume"] = {""};
    if (export_csv) arguments.options["export"] = {"csv"};
    for (const std::string& text : overrides_of(overrides, {}))
        arguments.options["set"].push_back(text.substr(std::string_view("--set ").size()));
    if (run_alone(command, arguments) == ExitCode::interrupted) {
        PyErr_SetNone(PyExc_KeyboardInterrupt);
        throw py::error_already_set();
    }
    const auto path = py::module_::import("pathlib").attr("Path")(directory.string());
    return from_json((path / py::str("campaign.json"))
                         .attr("read_text")(py::arg("encoding") = "utf-8")
                         .cast<std::string>());
}

void bind_campaign(py::module_& module) {
    module.def(
        "campaign", &run_campaign, py::arg("file"), py::arg("out") = py::none(),
        py::arg("threads") = py::none(), py::arg("overrides") = py::none(), py::arg("resume") = false,
        py::arg("export_csv") = false,
        "Runs a campaign, as `twinchute campaign FILE --out DIRECTORY`, and returns campaign.json as a "
        "dict.\n\n"
        "out: ./<campaign file>.out unless given. threads: None: as many as there are processors.\n"
        "overrides: of the scene that varies, by key. resume: goes on with the runs that are there.\n"
        "export_csv: also writes all runs as runs.csv. Ctrl-C ends it, and the runs made so far stay.");
}

// --- batches --------------------------------------------------------------------------------

/// The key in a record of a metric by its name or its key.
std::string metric_key(const RunRecord& nominal, const std::string& name) {
    std::vector<std::string_view> known;
    for (const Metric& metric : nominal.metrics) {
        const std::string_view own = split_metric_key(metric.key).name;
        if (name == metric.key || name == own) return metric.key;
        known.push_back(own);
    }
    for (const MetricRow& row : metric_rows())
        if (name == row.key || name == row.name) return std::string(row.key);
    throw UsageError(fmt::format("metrics: there is no '{}', {}", name, suggest(name, known)));
}

using Column = py::array_t<double, py::array::c_style | py::array::forcecast>;

py::array_t<double> as_array(const std::vector<double>& values) {
    return py::array_t<double>(static_cast<py::ssize_t>(values.size()), values.data());
}

py::tuple run_batch(const SceneObject& scene, const std::vector<std::pair<std::string, Column>>& inputs,
                    const std::vector<std::string>& metrics, const py::object& threads) {
    const Fidelity &rom = rom::rom_fidelity(), &full = fullsim::full_fidelity();
    const std::array others{&full};
    require_physics(scene.scene(), rom, others);
    if (!scene.scene().then.empty())
        throw UsageError(
            "stop.then: batches do not hand over (they give metrics of single runs), stop at \"ground\"");
    study::ManyInputs many;
    for (const auto& [key, column] : inputs) {
        many.keys.push_back(key);
        many.values.emplace_back(column.data(), column.data() + column.size());
    }
    const int most = threads_of(threads);
    Run run;
    const RunRecord nominal = run_scene(rom, scene.scene(), run, others);
    std::vector<std::string> keys;
    for (const std::string& name : metrics)
        keys.push_back(metric_key(nominal, name));
    study::ManyRuns made;
    const study::SceneWith reader = scene.reader();
    watch(py::none(), [&](const Watched& watched) {
        made = study::run_many(reader, many, keys, rom, most, watched.stop);
    });
    py::dict columns, units;
    for (std::size_t m = 0; m < metrics.size(); ++m) {
        columns[py::str(metrics[m])] = as_array(made.metrics[m]);
        units[py::str(metrics[m])] = std::string(split_metric_key(keys[m]).unit);
    }
    py::array_t<std::uint8_t> codes(static_cast<py::ssize_t>(made.statuses.size()));
    std::ranges::transform(made.statuses, codes.mutable_data(),
                           [](StatusCode code) { return static_cast<std::uint8_t>(code); });
    return py::make_tuple(columns, codes, units, or_none(made.refusal));
}

void bind_batch(py::module_& module) {
    py::list statuses;
    for (int code = 0; status_name(static_cast<StatusCode>(code)) != "unknown"; ++code)
        statuses.append(std::string(status_name(static_cast<StatusCode>(code))));
    module.attr("statuses") = py::tuple(statuses);
    module.def("rom_batch", &run_batch, py::arg("scene"), py::arg("inputs"), py::arg("metrics"),
               py::arg("threads"));
}

}  // namespace

void bind_studies(py::module_& module) {
    bind_size(module);
    bind_calibrate(module);
    bind_campaign(module);
    bind_batch(module);
}

}  // namespace twinchute::python
