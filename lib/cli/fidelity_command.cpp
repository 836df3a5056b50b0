#include "lib/cli/fidelity_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "lib/cli/interrupt.hpp"
#include "lib/cli/long_run.hpp"
#include "lib/cli/output_dir.hpp"
#include "lib/cli/record_text.hpp"
#include "lib/cli/scene_command.hpp"
#include "lib/record/record_json.hpp"
#include "lib/record/write_record.hpp"

namespace twinchute {
namespace {

/// A scene, or one of a series, before it runs.
struct Case {
    Case(const Fidelity& fidelity, const Scene& its_scene,
         const std::optional<std::filesystem::path>& directory, bool resumes)
        : scene(its_scene), place(directory_of(scene, directory.value_or(""))) {
        if (!directory) return;
        if (resumes) finished = finished_record(fidelity, scene, place);
        if (finished)
            remove_abandoned(place);  // killed right after its record was written
        else
            long_run.emplace(fidelity, scene, place, resumes);
    }

    const Scene& scene;
    std::filesystem::path place;
    std::optional<RunRecord> finished;
    std::optional<LongRun> long_run;  ///< where it has a directory
};

/// Outcome of a case, and lines about its files.
struct CaseReport {
    RunRecord record;
    std::string more;
};

CaseReport run_case(const Fidelity& fidelity, const std::vector<const Fidelity*>& others, Case& one,
                    const Interrupt& interrupt, int threads, const Arguments& arguments,
                    const RunReports& reports) {
    std::vector<const Fidelity*> all = others;
    all.push_back(&fidelity);
    FileBatch batch;
    FieldFiles fields(batch, one.place);
    ShapeFrames frames;
    Checkpoints checkpoints;
    if (one.long_run) checkpoints = one.long_run->checkpoints(fields);
    CaseReport report{run_watched(fidelity, one.scene, interrupt.token(), arguments.has("quiet"), threads,
                                  one.long_run ? &fields : nullptr, one.long_run ? &frames : nullptr,
                                  std::move(checkpoints), all),
                      ""};
    if (one.long_run) one.long_run->sign(report.record);
    if (one.long_run && report.record.status.code != StatusCode::refused) {
        batch.add(one.place / "run.html", reports.page(report.record, frames));
        add_record(batch, report.record, one.place, frames, csv_head(arguments));
        batch.commit();
    }
    if (one.long_run) one.long_run->ended(report.record);
    report.more = fields_text(fields);
    return report;
}

/// Keeps the histories that a report of a series shows: all those of a hundred cases would fill the memory.
CaseRun case_run(const Scene& scene, RunRecord record) {
    std::erase_if(record.channels, [](const Channel& channel) {
        return channel.name != "time" && channel.name != "force" && channel.name != "speed";
    });
    return {&scene, std::move(record)};
}

ExitCode run_single(const Fidelity& fidelity, DefaultOutput output,
                    const std::vector<const Fidelity*>& others, const RunReports& reports,
                    const Arguments& arguments) {
    choose_units(arguments);
    const std::vector<Scene> scenes = scenes_of(arguments, fields_overrides(arguments, fidelity));
    const int threads = threads_of(arguments);
    for (const Scene& scene : scenes)
        require_physics(scene, fidelity, others);
    if (arguments.has("check")) {
        say_valid(scenes, arguments);
        return ExitCode::done;
    }
    std::optional<std::filesystem::path> directory = arguments.value("out");
    if (!directory && output == DefaultOutput::directory) directory = default_output_dir(arguments.operand);
    if (!directory && arguments.has("plain-csv"))
        throw UsageError("--plain-csv is for the tables of a record (none is written), give --out DIR, too");
    const bool resumes = arguments.has("resume");
    std::vector<Case> cases;  // what cannot be gone on with is known before anything runs
    for (const Scene& scene : scenes)
        cases.emplace_back(fidelity, scene, directory, resumes);
    if (directory) check_output_dir(*directory);
    const Interrupt interrupt;  // until the records are safe
    ExitCode code = ExitCode::done;
    std::vector<std::string> summaries;
    std::vector<CaseRun> series;
    for (Case& one : cases) {
        const CaseReport report =
            one.finished ? CaseReport{*one.finished, "kept      it had ended before; nothing was run\n"}
                         : run_case(fidelity, others, one, interrupt, threads, arguments, reports);
        if (arguments.has("json")) {
            summaries.push_back(summary_json(report.record));
        } else if (!arguments.has("quiet")) {
            print((&one == &cases.front() ? "" : "\n") +
                  record_text(report.record, fidelity.title, output_style()));
            print(resumed_text(report.record));
            if (directory && report.record.status.code != StatusCode::refused)
                print(fmt::format("record    {}\nreport    {}\n",
                                  printable((one.place / "summary.json").string()),
                                  printable((one.place / "run.html").string())));
            print(report.more);
        }
        if (!one.scene.case_name.empty()) series.push_back(case_run(one.scene, report.record));
        code = gravest(code, exit_code(report.record.status.code));
        if (code == ExitCode::interrupted) break;
    }
    if (arguments.has("json")) print(joined_json(scenes, summaries));
    if (series.empty()) return code;
    std::filesystem::path made;
    if (directory && code != ExitCode::interrupted) {  // files are of all cases or not there
        FileBatch batch;
        made = reports.add_series(batch, series, *directory);
        batch.commit();
    }
    if (arguments.has("json") || arguments.has("quiet")) return code;
    print("\n" + reports.series_text(series, output_style()));
    if (!made.empty()) print(fmt::format("\nseries    {}\n", printable(made.string())));
    return code;
}

}  // namespace

Command fidelity_command(const Fidelity& fidelity, std::string summary, DefaultOutput output,
                         std::vector<const Fidelity*> others, RunReports reports) {
    Command command;
    command.name = fidelity.name;
    command.summary = std::move(summary);
    command.operand = "SCENE";
    command.example = fmt::format("twinchute {} data/scenes/c9-inflation.toml", fidelity.name);
    command.options =
        scene_options(output == DefaultOutput::none ? "also write the record there"
                                                    : "write the record there instead of ./<scene file>.out");
    command.options.insert(command.options.begin() + 1, plain_csv_option());
    command.options.insert(command.options.begin() + 2, units_option());
    if (fidelity.gives_fields) command.options.insert(command.options.begin() + 1, fields_option());
    if (fidelity.keeps_checkpoints) command.options.insert(command.options.begin() + 1, resume_option());
    if (fidelity.has_threads) command.options.insert(command.options.begin() + 1, threads_option());
    command.run = [&fidelity, output, others = std::move(others),
                   reports = std::move(reports)](const Arguments& arguments) {
        return run_single(fidelity, output, others, reports, arguments);
    };
    return command;
}

}  // namespace twinchute
