#include "compare/compare_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <iterator>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>
#include <tuple>
#include <utility>

#include "compare/attribute.hpp"
#include "compare/baseline.hpp"
#include "compare/drop_test_option.hpp"
#include "compare/gap.hpp"
#include "compare/ladder_beside.hpp"
#include "compare/parallel.hpp"
#include "compare/records.hpp"
#include "compare/report/gap_json.hpp"
#include "compare/report/terminal.hpp"
#include "compare/report/trend_text.hpp"
#include "compare/report/write_report.hpp"
#include "compare/series.hpp"
#include "compare/tolerances.hpp"
#include "lib/cli/interrupt.hpp"
#include "lib/cli/long_run.hpp"
#include "lib/cli/output_dir.hpp"
#include "lib/cli/progress.hpp"
#include "lib/cli/scene_command.hpp"
#include "lib/cli/text.hpp"
#include "lib/record/record_error.hpp"
#include "lib/record/record_json.hpp"
#include "lib/solve/stopwatch.hpp"

namespace twinchute::compare {
namespace {

/// For standard output: the gap, and the trend in it where one was asked for. gap.json is without, since a
/// report is made of records alone.
std::string with_trend(const std::string& gap, const std::optional<Trend>& trend, const Baseline& baseline) {
    if (!trend) return gap;
    auto json = nlohmann::ordered_json::parse(gap);
    json["trend"] = trend_json(*trend, baseline.directory());
    return json_text(json);
}

/// --why, --seeds and --threads: of the runs with effects switched.
struct Why {
    bool asked = false;
    int seeds = AttributionOptions{}.seeds, threads = 1;
};

Why why_of(const Arguments& arguments) {
    Why why;
    why.asked = arguments.has("why");
    if (arguments.has("seeds") && !why.asked)
        throw UsageError("--seeds is for the runs of --why, give both, e.g. --why --seeds 3");
    why.seeds = whole_number(arguments, "seeds", why.seeds, 1000, 3);
    why.threads = arguments.has("threads") ? threads_of(arguments) : processors();
    return why;
}

Attribution explained(const Comparison& comparison, const Scene& scene, const Fidelity& reference,
                      const Fidelity& candidate, const Why& why, const Interrupt& interrupt, bool quiet) {
    ProgressLine line("why", !quiet && progress_is_seen());
    return attribute(comparison, scene, reference, candidate,
                     {why.seeds, why.threads, interrupt.token(), line.reporter()});
}

/// Runs are not lost for a ladder that is broken.
LadderBeside ladder_there(const std::filesystem::path& place, const Comparison& comparison) {
    const std::array<std::string_view, 2> fidelities{comparison.candidate.fidelity,
                                                     comparison.reference.fidelity};
    try {
        return ladder_beside(place, comparison.reference, fidelities);
    } catch (const RecordError& error) {
        return {{}, error.what()};
    }
}

/// A scene, or one of a series, before it runs.
struct Case {
    Case(const Fidelity& of_reference, const Fidelity& of_candidate, const Scene& scene,
         std::filesystem::path its_place, bool resumes)
        : place(std::move(its_place)) {
        std::error_code ignored;
        if (resumes && std::filesystem::exists(place / "gap.json", ignored)) {
            auto one = finished_record(of_candidate, scene, place / of_candidate.name),
                 other = finished_record(of_reference, scene, place / of_reference.name);
            if (one && other) finished.emplace(std::move(*one), std::move(*other));
            if (finished)
                for (const Fidelity* of : {&of_candidate, &of_reference})
                    remove_abandoned(place / of->name);
        }
        if (finished) return;
        candidate.emplace(of_candidate, scene, place / of_candidate.name, resumes);
        reference.emplace(of_reference, scene, place / of_reference.name, resumes);
    }

    std::filesystem::path place;
    std::optional<std::pair<RunRecord, RunRecord>> finished;  ///< candidate and reference
    std::optional<LongRun> candidate, reference;              ///< otherwise
};

/// Result of a case.
struct CaseOutcome {
    std::string text, gap;  ///< for standard output: for reading, and as JSON
    ExitCode code = ExitCode::done;
    std::optional<SeriesCase> row;
};

/// All cases of a command: one scene, or a series, several at once where each has a processor of its own.
class Comparing {
public:
    Comparing(const Fidelity& reference, const Fidelity& candidate, const Arguments& arguments,
              const std::vector<Scene>& scenes, const Baseline& baseline,
              std::optional<DropTestHistories> test, const Why& why, std::filesystem::path directory)
        : reference_(reference),
          candidate_(candidate),
          arguments_(arguments),
          scenes_(scenes),
          baseline_(baseline),
          test_(std::move(test)),
          why_(why),
          directory_(std::move(directory)),
          threads_(threads_of(arguments)),
          quiet_(arguments.has("quiet")) {
        // Cases that cannot be resumed are refused before anything runs.
        for (const Scene& scene : scenes_)
            cases_.emplace_back(reference, candidate, scene, directory_of(scene, directory_),
                                arguments.has("resume"));
        check_output_dir(directory_);
    }

    ExitCode run() {
        const Stopwatch watch;
        const int at_once = cases_at_once();
        std::vector<CaseOutcome> outcomes(scenes_.size());
        {
            std::atomic<std::size_t> ended{0};
            std::mutex lock;
            ProgressLine line("series", at_once > 1 && !quiet_ && progress_is_seen());
            const auto report = line.reporter();
            in_parallel(scenes_.size(), at_once, [&](std::size_t i) {
                if (interrupt_.token().stop_requested()) return;
                outcomes[i] = one(i, at_once > 1);
                const auto share = static_cast<double>(++ended) / static_cast<double>(scenes_.size());
                const std::lock_guard guard(lock);
                if (report) report({scenes_[i].case_name, 0.0, share});
                if (at_once == 1) show(outcomes[i], i);
            });
        }
        ExitCode code = interrupt_.token().stop_requested() ? ExitCode::interrupted : ExitCode::done;
        std::vector<std::string> gaps;
        for (std::size_t i = 0; i < outcomes.size(); ++i) {
            if (at_once > 1) show(outcomes[i], i);
            if (arguments_.has("json") && !outcomes[i].gap.empty()) gaps.push_back(outcomes[i].gap);
            code = gravest(code, outcomes[i].code);
        }
        add_whole_series(outcomes, watch.wall());
        if (arguments_.has("json")) print(joined_json(scenes_, gaps));
        return code;
    }

private:
    /// Runs with effects switched and threads of a run have their own ways to use the processors.
    int cases_at_once() const {
        if (scenes_.size() == 1 || why_.asked || arguments_.has("threads")) return 1;
        return processors();
    }

    /// In the order of the cases, those that were run.
    void show(const CaseOutcome& outcome, std::size_t i) const {
        if (quiet_ || arguments_.has("json") || outcome.text.empty()) return;
        print((i == 0 ? "" : "\n") + outcome.text);
    }

    Comparison both(std::size_t i, bool quiet, FieldFiles& of_candidate, FieldFiles& of_reference) {
        const Scene& scene = scenes_[i];
        Case& of = cases_[i];
        const std::array<const Fidelity*, 2> fidelities{&reference_, &candidate_};
        Comparison comparison;
        comparison.reference_title = reference_.title;
        comparison.candidate_title = candidate_.title;
        comparison.test = test_;
        if (of.finished) {
            std::tie(comparison.candidate, comparison.reference) = *of.finished;
            comparison.candidate_frames = read_frames(of.place / candidate_.name);
            comparison.reference_frames = read_frames(of.place / reference_.name);
        } else {
            // The quick one first: it is there even when the long one is interrupted.
            Checkpoints to_candidate = of.candidate->checkpoints(of_candidate),
                        to_reference = of.reference->checkpoints(of_reference);
            comparison.candidate =
                as_written(run_watched(candidate_, scene, interrupt_.token(), quiet, threads_, &of_candidate,
                                       &comparison.candidate_frames, std::move(to_candidate), fidelities));
            comparison.reference =
                as_written(run_watched(reference_, scene, interrupt_.token(), quiet, threads_, &of_reference,
                                       &comparison.reference_frames, std::move(to_reference), fidelities));
        }
        comparison.gap = measure_gap(comparison.reference, comparison.candidate, scene.tolerances,
                                     command_line_tolerances(comparison.reference));
        if (of.finished) comparison.attribution = attribution_in(of.place, comparison);
        return comparison;
    }

    CaseOutcome one(std::size_t i, bool among_others) {
        Case& of = cases_[i];
        FileBatch batch;
        FieldFiles of_candidate(batch, of.place / candidate_.name),
            of_reference(batch, of.place / reference_.name);
        Comparison comparison = both(i, quiet_ || among_others, of_candidate, of_reference);
        if (of.candidate) of.candidate->sign(comparison.candidate);
        if (of.reference) of.reference->sign(comparison.reference);
        std::optional<Trend> trend;
        if (baseline_.asked()) trend = baseline_.trend_of(i, comparison);
        if (why_.asked && !comparison.attribution && !interrupt_.token().stop_requested())
            comparison.attribution =
                explained(comparison, scenes_[i], reference_, candidate_, why_, interrupt_, quiet_);
        const LadderBeside beside = ladder_there(of.place, comparison);
        if (of.finished)
            add_gap_files(batch, comparison, of.place, beside, trend ? &*trend : nullptr);
        else
            add_report(batch, comparison, of.place, beside, trend ? &*trend : nullptr, csv_head(arguments_));
        baseline_.add_files(batch, trend, comparison, of.place);
        batch.commit();
        if (of.candidate) of.candidate->ended(comparison.candidate);
        if (of.reference) of.reference->ended(comparison.reference);
        remove_abandoned(of.place);  // of the comparison itself

        CaseOutcome outcome;
        outcome.row = series_case(scenes_[i], comparison);
        outcome.row->page = scenes_[i].case_name + "/report.html";
        if (arguments_.has("json")) outcome.gap = with_trend(gap_json(comparison), trend, baseline_);
        outcome.text = terminal_text(comparison, output_style());
        if (trend) outcome.text += trend_terminal(*trend, baseline_.directory(), output_style());
        outcome.text += resumed_text(comparison.candidate) + resumed_text(comparison.reference);
        if (of.finished) outcome.text += "kept      both records, they had ended before; nothing was run\n";
        outcome.text += fields_text(of_reference) + fields_text(of_candidate) + ladder_line(beside, of.place);
        outcome.text += fmt::format("report    {}\n", printable((of.place / "report.html").string()));
        outcome.code = exit_code(comparison);
        if (trend && overall_verdict(*trend) == Verdict::exceeded)
            outcome.code = gravest(outcome.code, ExitCode::verdict);
        return outcome;
    }

    /// Table and plot of a series whose every case has been run.
    void add_whole_series(const std::vector<CaseOutcome>& outcomes, double seconds) const {
        if (scenes_.front().case_name.empty()) return;
        CaseSeries series = series_of(scenes_.front());
        series.reference_title = reference_.title;
        series.candidate_title = candidate_.title;
        series.wall_s = seconds;
        for (const CaseOutcome& outcome : outcomes) {
            if (!outcome.row) return;
            series.cases.push_back(*outcome.row);
        }
        FileBatch batch;
        const std::filesystem::path page = add_series(batch, series, directory_);
        batch.commit();
        if (!quiet_ && !arguments_.has("json"))
            print(fmt::format("\n{}\nseries    {}\n", series_terminal(series, output_style()),
                              printable(page.string())));
    }

    const Fidelity &reference_, &candidate_;
    const Arguments& arguments_;
    const std::vector<Scene>& scenes_;
    const Baseline& baseline_;
    const std::optional<DropTestHistories> test_;
    const Why& why_;
    const std::filesystem::path directory_;
    const int threads_;
    const bool quiet_;
    std::vector<Case> cases_;
    const Interrupt interrupt_;  // until the records are safe
};

ExitCode run_compare(const Fidelity& reference, const Fidelity& candidate, const Arguments& arguments) {
    const std::array<const Fidelity*, 2> both{&reference, &candidate};
    std::vector<std::string> overrides = tolerance_overrides(arguments);
    for (const Fidelity* fidelity : both)
        std::ranges::copy(fields_overrides(arguments, *fidelity), std::back_inserter(overrides));
    choose_units(arguments);
    const std::vector<Scene> scenes = scenes_of(arguments, overrides);
    const Why why = why_of(arguments);
    for (const Scene& scene : scenes)
        for (const Fidelity* fidelity : both)
            require_physics(scene, *fidelity, both);
    const Baseline baseline(arguments, scenes, reference, candidate);
    std::optional<DropTestHistories> test = test_of(arguments);
    if (arguments.has("check")) {
        say_valid(scenes, arguments);
        return ExitCode::done;
    }
    return Comparing(reference, candidate, arguments, scenes, baseline, std::move(test), why,
                     arguments.value("out").value_or(default_output_dir(arguments.operand).string()))
        .run();
}

}  // namespace

Command compare_command(const Fidelity& reference, const Fidelity& candidate) {
    Command command;
    command.name = "compare";
    command.summary = "run a scene at both fidelities and report the gap";
    command.operand = "SCENE";
    command.example = "twinchute compare data/scenes/c9-inflation.toml";
    command.options = scene_options("write records and report there instead of ./<scene file>.out");
    std::vector<Option> own{
        tolerance_option(reference.name),
        {"why", "", "run both models again with physics effects switched: what makes which part of the gap"},
        {"seeds", "N",
         fmt::format("of scenes with noise, for --why: scatter over N seeds, {} unless given",
                     AttributionOptions{}.seeds)}};
    for (Option& option : drop_test_options())
        own.push_back(std::move(option));
    const std::vector<Option> of_baseline = baseline_options();
    own.insert(own.end(), of_baseline.begin(), of_baseline.end());
    command.options.insert(command.options.begin() + 1, own.begin(), own.end());
    command.options.insert(command.options.begin() + 2, plain_csv_option());
    command.options.insert(command.options.begin() + 3, units_option());
    if (reference.gives_fields || candidate.gives_fields)
        command.options.insert(command.options.begin() + 2, fields_option());
    if (reference.keeps_checkpoints || candidate.keeps_checkpoints)
        command.options.insert(command.options.begin() + 2, resume_option());
    if (reference.has_threads || candidate.has_threads)
        command.options.insert(command.options.begin() + 2, threads_option());
    command.run = [&reference, &candidate](const Arguments& arguments) {
        return run_compare(reference, candidate, arguments);
    };
    return command;
}

}  // namespace twinchute::compare
