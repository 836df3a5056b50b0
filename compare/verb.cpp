#include "compare/verb.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>
#include <thread>
#include <tuple>
#include <utility>

#include "compare/attribute.hpp"
#include "compare/baseline.hpp"
#include "compare/gap.hpp"
#include "compare/ladder_beside.hpp"
#include "compare/records.hpp"
#include "compare/report/gap_json.hpp"
#include "compare/report/terminal.hpp"
#include "compare/report/trend_text.hpp"
#include "compare/report/write_report.hpp"
#include "compare/tolerances.hpp"
#include "lib/cli/interrupt.hpp"
#include "lib/cli/long_run.hpp"
#include "lib/cli/output_dir.hpp"
#include "lib/cli/progress.hpp"
#include "lib/cli/scene_command.hpp"
#include "lib/cli/text.hpp"
#include "lib/record/record_error.hpp"
#include "lib/record/record_json.hpp"

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

/// --why, --seeds and --threads: of the runs with pieces switched.
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
    const unsigned processors = std::max(1u, std::thread::hardware_concurrency());
    why.threads = arguments.has("threads") ? threads_of(arguments) : static_cast<int>(processors);
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
        }
        if (finished) return;
        candidate.emplace(of_candidate, scene, place / of_candidate.name, resumes);
        reference.emplace(of_reference, scene, place / of_reference.name, resumes);
    }

    std::filesystem::path place;
    std::optional<std::pair<RunRecord, RunRecord>> finished;  ///< candidate and reference
    std::optional<LongRun> candidate, reference;              ///< otherwise
};

ExitCode run_compare(const Fidelity& reference, const Fidelity& candidate, const Arguments& arguments) {
    const std::array<const Fidelity*, 2> both{&reference, &candidate};
    std::vector<std::string> overrides = tolerance_overrides(arguments);
    for (const Fidelity* fidelity : both)
        std::ranges::copy(fields_overrides(arguments, *fidelity), std::back_inserter(overrides));
    const std::vector<Scene> scenes = scenes_of(arguments, overrides);
    const int threads = threads_of(arguments);
    const Why why = why_of(arguments);
    for (const Scene& scene : scenes)
        for (const Fidelity* fidelity : both)
            require_physics(scene, *fidelity, both);
    const Baseline baseline(arguments, scenes, reference, candidate);
    if (arguments.has("check")) {
        say_valid(scenes, arguments);
        return ExitCode::done;
    }
    const std::filesystem::path directory =
        arguments.value("out").value_or(default_output_dir(arguments.operand).string());
    std::vector<Case> cases;  // what cannot be gone on with is known before anything runs
    for (const Scene& scene : scenes)
        cases.emplace_back(reference, candidate, scene, directory_of(scene, directory),
                           arguments.has("resume"));
    check_output_dir(directory);
    const Interrupt interrupt;  // until the records are safe
    const bool quiet = arguments.has("quiet");
    ExitCode code = ExitCode::done;
    std::vector<std::string> gaps;
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        const Scene& scene = scenes[i];
        const std::filesystem::path& place = cases[i].place;
        Comparison comparison;
        comparison.reference_title = reference.title;
        comparison.candidate_title = candidate.title;
        FileBatch batch;
        FieldFiles of_candidate(batch, place / candidate.name), of_reference(batch, place / reference.name);
        if (cases[i].finished) {
            std::tie(comparison.candidate, comparison.reference) = *cases[i].finished;
            comparison.candidate_frames = read_frames(place / candidate.name);
            comparison.reference_frames = read_frames(place / reference.name);
        } else {
            // The quick one first: it is there even when the long one is interrupted.
            Checkpoints to_candidate = cases[i].candidate->checkpoints(of_candidate),
                        to_reference = cases[i].reference->checkpoints(of_reference);
            comparison.candidate =
                as_written(run_watched(candidate, scene, interrupt.token(), quiet, threads, &of_candidate,
                                       &comparison.candidate_frames, std::move(to_candidate), both));
            comparison.reference =
                as_written(run_watched(reference, scene, interrupt.token(), quiet, threads, &of_reference,
                                       &comparison.reference_frames, std::move(to_reference), both));
        }
        comparison.gap = measure_gap(comparison.reference, comparison.candidate, scene.tolerances,
                                     command_line_tolerances(comparison.reference));
        if (cases[i].finished) comparison.attribution = attribution_in(place, comparison);
        std::optional<Trend> trend;
        if (baseline.asked()) trend = baseline.trend_of(i, comparison);
        if (why.asked && !comparison.attribution && !interrupt.token().stop_requested())
            comparison.attribution =
                explained(comparison, scene, reference, candidate, why, interrupt, quiet);
        const LadderBeside beside = ladder_there(place, comparison);
        if (cases[i].finished)
            add_gap_files(batch, comparison, place, beside);
        else
            add_report(batch, comparison, place, beside);
        baseline.add_files(batch, trend, comparison, place);
        batch.commit();
        if (cases[i].candidate) cases[i].candidate->ended(comparison.candidate);
        if (cases[i].reference) cases[i].reference->ended(comparison.reference);

        if (arguments.has("json")) {
            gaps.push_back(with_trend(gap_json(comparison), trend, baseline));
        } else if (!quiet) {
            print((i == 0 ? "" : "\n") + terminal_text(comparison, output_style()));
            if (trend) print(trend_terminal(*trend, baseline.directory(), output_style()));
            print(resumed_text(comparison.candidate) + resumed_text(comparison.reference));
            if (cases[i].finished) print("kept      both records, they had ended before; nothing was run\n");
            print(fields_text(of_reference) + fields_text(of_candidate) + ladder_line(beside, place));
            print(fmt::format("report    {}\n", printable((place / "report.html").string())));
        }
        code = gravest(code, exit_code(comparison));
        if (trend && overall_verdict(*trend) == Verdict::exceeded) code = gravest(code, ExitCode::verdict);
        if (why.asked && interrupt.token().stop_requested()) code = gravest(code, ExitCode::interrupted);
        if (code == ExitCode::interrupted) break;
    }
    if (arguments.has("json")) print(joined_json(scenes, gaps));
    return code;
}

}  // namespace

Verb compare_verb(const Fidelity& reference, const Fidelity& candidate) {
    Verb verb;
    verb.name = "compare";
    verb.summary = "run a scene at both fidelities and report the gap";
    verb.operand = "SCENE";
    verb.example = "twinchute compare data/scenes/c9-inflation.toml";
    verb.options = scene_options("write records and report there instead of ./<scene file>.out");
    std::vector<Option> own{
        tolerance_option(reference.name),
        {"why", "",
         "run both models again with pieces of physics switched: what makes which part of the gap"},
        {"seeds", "N",
         fmt::format("of scenes with noise, for --why: scatter over N seeds, {} unless given",
                     AttributionOptions{}.seeds)}};
    const std::vector<Option> of_baseline = baseline_options();
    own.insert(own.end(), of_baseline.begin(), of_baseline.end());
    verb.options.insert(verb.options.begin() + 1, own.begin(), own.end());
    if (reference.gives_fields || candidate.gives_fields)
        verb.options.insert(verb.options.begin() + 2, fields_option());
    if (reference.keeps_checkpoints || candidate.keeps_checkpoints)
        verb.options.insert(verb.options.begin() + 2, resume_option());
    if (reference.has_threads || candidate.has_threads)
        verb.options.insert(verb.options.begin() + 2, threads_option());
    verb.run = [&reference, &candidate](const Arguments& arguments) {
        return run_compare(reference, candidate, arguments);
    };
    return verb;
}

}  // namespace twinchute::compare
