#include "python/runs.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <array>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <filesystem>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "compare/attribute.hpp"
#include "compare/gap.hpp"
#include "compare/report/gap_json.hpp"
#include "compare/report/terminal.hpp"
#include "compare/report/write_report.hpp"
#include "compare/tolerances.hpp"
#include "fullsim/fidelity.hpp"
#include "lib/cli/output_dir.hpp"
#include "lib/cli/scene_command.hpp"
#include "lib/record/field_files.hpp"
#include "lib/record/record_json.hpp"
#include "lib/record/write_record.hpp"
#include "lib/solve/hand_over.hpp"
#include "python/errors.hpp"
#include "python/record_class.hpp"
#include "python/scene_class.hpp"
#include "rom/fidelity.hpp"

namespace twinchute::python {
namespace {

namespace fs = std::filesystem;
using compare::Comparison;

const std::array<const Fidelity*, 2>& fidelities() {
    static const std::array<const Fidelity*, 2> both{&fullsim::full_fidelity(), &rom::rom_fidelity()};
    return both;
}

struct ProgressObject {
    std::string stage;
    double time = 0.0, share = 0.0;
};

/// The latest report of a run, from its thread to that of Python.
class Mailbox {
public:
    void post(const Progress& progress) {
        const std::scoped_lock guard(lock_);
        latest_ = ProgressObject{std::string(progress.stage), progress.time, progress.share};
    }
    std::optional<ProgressObject> take() {
        const std::scoped_lock guard(lock_);
        return std::exchange(latest_, std::nullopt);
    }

private:
    std::mutex lock_;
    std::optional<ProgressObject> latest_;
};

RecordObject run_rom(const SceneObject& scene) {
    const std::shared_ptr<const Scene> kept = scene.shared();
    const Scene& one = *kept;
    require_physics(one, rom::rom_fidelity(), fidelities());
    RecordObject object;
    {
        const py::gil_scoped_release released;
        Run run;
        object.record =
            std::make_shared<const RunRecord>(run_scene(rom::rom_fidelity(), one, run, fidelities()));
    }
    require_success(object);
    return object;
}

/// Writes what a run leaves behind where `out` names a directory for it.
void run_full_of(const Scene& scene, int threads, const std::optional<fs::path>& out, const Watched& watched,
                 RecordObject& object) {
    FileBatch batch;
    FieldFiles fields(batch, out.value_or(""));
    ShapeFrames frames;
    Run run{watched.stop, watched.progress};
    run.threads = threads;
    run.frames = [&frames](ShapeFrames shape) { frames = std::move(shape); };
    if (out) run.fields = [&fields](const VtuGrid& frame) { fields.add(frame); };
    object.record =
        std::make_shared<const RunRecord>(run_scene(fullsim::full_fidelity(), scene, run, fidelities()));
    if (out) {
        fields.finish();
        add_record(batch, *object.record, *out, frames);
        batch.commit();
    }
    object.frames = std::make_shared<const ShapeFrames>(std::move(frames));
}

/// Fields are written while a run goes on, or not at all.
void require_place_for_fields(const Scene& scene) {
    if (scene.full.fields_rate)
        throw UsageError(fmt::format(
            "{}: full.fields_rate: there is no directory for the fields (they are written while it "
            "runs), give full(..., out=DIRECTORY)",
            scene.file.string()));
}

RecordObject run_full(const SceneObject& scene, const py::object& progress, const py::object& threads,
                      const std::optional<fs::path>& out) {
    const std::shared_ptr<const Scene> kept = scene.shared();
    const Scene& one = *kept;
    require_physics(one, fullsim::full_fidelity(), fidelities());
    if (out)
        check_output_dir(*out);
    else
        require_place_for_fields(one);
    const int most = threads_of(threads);
    RecordObject object;
    watch(progress, [&](const Watched& watched) { run_full_of(one, most, out, watched, object); });
    require_success(object);
    return object;
}

// --- compare --------------------------------------------------------------------------------

struct GapObject {
    std::string name, title, unit, verdict, tolerance, note;
    std::optional<double> rom, full, difference, relative;
};

std::optional<double> value_of(const std::optional<compare::SideValue>& side) {
    return side ? std::optional(side->value) : std::nullopt;
}

GapObject gap_of(const compare::MetricGap& gap) {
    return {std::string(gap.row->name),
            std::string(gap.row->title),
            std::string(gap.row->unit),
            std::string(verdict_name(gap.verdict)),
            gap.tolerance ? tolerance_text(*gap.tolerance, gap.row->unit) : std::string(),
            gap.note,
            value_of(gap.candidate),
            value_of(gap.reference),
            gap.difference,
            gap.relative};
}

py::object within(const std::string& verdict) {
    using compare::Verdict;
    if (verdict == verdict_name(Verdict::within)) return py::bool_(true);
    if (verdict == verdict_name(Verdict::exceeded) || verdict == verdict_name(Verdict::missing))
        return py::bool_(false);
    return py::none();
}

struct ComparisonObject {
    std::shared_ptr<const Comparison> comparison;

    std::string verdict() const { return std::string(verdict_name(overall_verdict(*comparison))); }
    RecordObject record(RunRecord Comparison::*side, ShapeFrames Comparison::*frames) const {
        const Comparison& c = *comparison;
        return {std::shared_ptr<const RunRecord>(comparison, &(c.*side)),
                std::shared_ptr<const ShapeFrames>(comparison, &(c.*frames))};
    }
};

ComparisonObject run_compare(const SceneObject& scene, const py::object& progress, const py::object& threads,
                             bool why, int seeds) {
    const std::shared_ptr<const Scene> kept = scene.shared();
    const Scene& one = *kept;
    const Fidelity &full = *fidelities()[0], &rom = *fidelities()[1];
    for (const Fidelity* fidelity : fidelities())
        require_physics(one, *fidelity, fidelities());
    require_place_for_fields(one);
    const int most = threads_of(threads);
    const auto made = std::make_shared<Comparison>();
    watch(progress, [&](const Watched& watched) {
        const auto record_by = [&](const Fidelity& fidelity, ShapeFrames& frames) {
            Run run{watched.stop, watched.progress};
            run.threads = most;
            run.frames = [&frames](ShapeFrames shape) { frames = std::move(shape); };
            return as_written(run_scene(fidelity, one, run, fidelities()));
        };
        made->reference_title = full.title;
        made->candidate_title = rom.title;
        made->candidate = record_by(rom, made->candidate_frames);
        made->reference = record_by(full, made->reference_frames);
        made->gap = compare::measure_gap(made->reference, made->candidate, one.tolerances,
                                         compare::command_line_tolerances(made->reference));
        if (why)
            made->attribution =
                attribute(*made, one, full, rom, {seeds, most, watched.stop, watched.progress});
    });
    const ComparisonObject object{made};
    require_success(object.record(&Comparison::candidate, &Comparison::candidate_frames));
    require_success(object.record(&Comparison::reference, &Comparison::reference_frames));
    return object;
}

void bind_compare(py::module_& module) {
    py::class_<GapObject>(module, "Gap", "One metric of both models, and how far apart they are.")
        .def_readonly("name", &GapObject::name, "E.g. 'peak_force'.")
        .def_readonly("title", &GapObject::title, "In words.")
        .def_readonly("unit", &GapObject::unit, "SI, 'g' for standard gravities; empty for ratios.")
        .def_readonly("rom", &GapObject::rom, "In `unit`; None where the run has none.")
        .def_readonly("full", &GapObject::full, "In `unit`; None where the run has none.")
        .def_readonly("difference", &GapObject::difference, "rom - full, in `unit`.")
        .def_readonly("relative", &GapObject::relative,
                      "The difference over |full|; None where both are round-off.")
        .def_property_readonly(
            "tolerance", [](const GapObject& self) { return or_none(self.tolerance); },
            "E.g. '5 %' or '500 N', or None.")
        .def_readonly("verdict", &GapObject::verdict,
                      "'within', 'exceeded', 'missing', 'not reached' or 'not judged'.")
        .def_property_readonly(
            "within", [](const GapObject& self) { return within(self.verdict); },
            "True, False, or None: not judged.")
        .def_readonly("note", &GapObject::note, "E.g. that only one side has it.")
        .def("__repr__", [](const GapObject& self) {
            const auto text = [](const std::optional<double>& value) {
                return value ? fmt::format("{:.6g}", *value) : "-";
            };
            return fmt::format("<Gap {}: rom {}, full {} {} ({})>", self.name, text(self.rom),
                               text(self.full), self.unit, self.verdict);
        });
    py::class_<ComparisonObject>(module, "Comparison", "One scene by both models, and the gap between them.")
        .def_property_readonly(
            "rom",
            [](const ComparisonObject& self) {
                return self.record(&Comparison::candidate, &Comparison::candidate_frames);
            },
            "Record of the reduced-order model.")
        .def_property_readonly(
            "full",
            [](const ComparisonObject& self) {
                return self.record(&Comparison::reference, &Comparison::reference_frames);
            },
            "Record of the full model.")
        .def_property_readonly(
            "gaps",
            [](const ComparisonObject& self) {
                py::dict all;
                for (const compare::MetricGap& gap : self.comparison->gap.metrics)
                    all[py::str(std::string(gap.row->name))] = gap_of(gap);
                return all;
            },
            "Gap by metric.")
        .def_property_readonly("verdict", &ComparisonObject::verdict, "'within', 'exceeded' or 'not judged'.")
        .def_property_readonly(
            "within", [](const ComparisonObject& self) { return within(self.verdict()); },
            "Whether all judged metrics are within their tolerances; None where none is judged.")
        .def_property_readonly(
            "cost_ratio", [](const ComparisonObject& self) { return self.comparison->gap.cost_ratio; },
            "Wall time of the full model over that of the reduced-order model.")
        .def_property_readonly(
            "summary", [](const ComparisonObject& self) { return from_json(gap_json(*self.comparison)); },
            "All of gap.json as a dict: metrics, histories, cost, and the attribution where it was asked "
            "for.")
        .def(
            "to_dir",
            [](const ComparisonObject& self, const fs::path& directory) {
                const py::gil_scoped_release released;
                check_output_dir(directory);
                write_report(*self.comparison, directory);
            },
            py::arg("directory"),
            "Writes both records and the report, as `twinchute compare --out`. Raises WriteError.")
        .def("__str__", [](const ComparisonObject& self) { return terminal_text(*self.comparison, {}); })
        .def("__repr__", [](const ComparisonObject& self) {
            return fmt::format("<twinchute.Comparison of '{}': {}>", self.comparison->reference.scene.name,
                               self.verdict());
        });
}

}  // namespace

void watch(const py::object& progress, const std::function<void(const Watched&)>& work) {
    std::stop_source stop;
    Mailbox mailbox;
    std::mutex lock;
    std::condition_variable ended;
    bool done = false;
    std::exception_ptr thrown;                    // by the work
    std::optional<py::error_already_set> raised;  // by a signal or the callback
    const auto look = [&] {
        if (raised) return;
        try {
            if (PyErr_CheckSignals() != 0) throw py::error_already_set();
            const auto news = mailbox.take();
            if (news && !progress.is_none()) progress(*news);
        } catch (py::error_already_set& error) {
            raised.emplace(std::move(error));
            stop.request_stop();
        }
    };
    {
        const py::gil_scoped_release released;
        const std::jthread worker([&] {
            try {
                work({stop.get_token(), [&mailbox](const Progress& report) { mailbox.post(report); }});
            } catch (...) {
                thrown = std::current_exception();
            }
            const std::scoped_lock guard(lock);
            done = true;
            ended.notify_one();
        });
        constexpr std::chrono::milliseconds pause(50);
        std::unique_lock waiting(lock);
        while (!ended.wait_for(waiting, pause, [&] { return done; })) {
            waiting.unlock();
            {
                const py::gil_scoped_acquire acquired;
                look();
            }
            waiting.lock();
        }
    }
    look();
    if (raised) throw std::move(*raised);
    if (thrown) std::rethrow_exception(thrown);
}

int threads_of(const py::object& threads) {
    if (threads.is_none()) return static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    const int number = threads.cast<int>();
    if (number < 1 || number > 1024)
        throw UsageError(fmt::format(
            "threads={} is not understood (a whole number from 1 to 1024 is wanted), e.g. threads=2",
            number));
    return number;
}

void bind_runs(py::module_& module) {
    py::class_<ProgressObject>(module, "Progress", "How far a run has come.")
        .def_readonly("stage", &ProgressObject::stage, "E.g. 'inflation'.")
        .def_readonly("time", &ProgressObject::time, "[s] simulated, since release.")
        .def_readonly("share", &ProgressObject::share, "Of the run, an estimate in 0..1.")
        .def("__repr__", [](const ProgressObject& self) {
            return fmt::format("<Progress {} at {:.4g} s, {:.0f} %>", self.stage, self.time,
                               100.0 * self.share);
        });
    module.def("rom", &run_rom, py::arg("scene"),
               "Runs the reduced-order model.\n\nRaises RunError where the numbers fail, UsageError for "
               "physics it lacks.");
    module.def(
        "full", &run_full, py::arg("scene"), py::arg("progress") = py::none(), py::arg("threads") = 1,
        py::arg("out") = py::none(),
        "Runs the full model.\n\n"
        "progress: called with a Progress now and then, in the calling thread; what it raises ends the run.\n"
        "threads: at most; None: as many as there are processors. The answer is the same.\n"
        "out: directory for the record, with the fields that full.fields_rate asks for.\n"
        "Other threads of Python go on meanwhile; Ctrl-C ends the run. Raises RunError where the numbers "
        "fail.");
    bind_compare(module);
    module.def("compare", &run_compare, py::arg("scene"), py::arg("progress") = py::none(),
               py::arg("threads") = 1, py::arg("why") = false,
               py::arg("seeds") = compare::AttributionOptions{}.seeds,
               "Runs both models and measures the gap.\n\n"
               "why: runs both again with physics effects switched, for the attribution in `summary`.\n"
               "seeds: of scenes with noise, for why: scatter over so many. The others as in full().");
}

}  // namespace twinchute::python
