#include "study/campaign/campaign_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <filesystem>
#include <thread>

#ifdef TWINCHUTE_HAS_CAMPAIGN
#include "compare/gap.hpp"
#include "compare/parallel.hpp"
#include "compare/report/write_report.hpp"
#include "lib/cli/interrupt.hpp"
#include "lib/cli/output_dir.hpp"
#include "lib/cli/progress.hpp"
#include "lib/cli/record_text.hpp"
#include "lib/cli/scene_command.hpp"
#include "lib/cli/text.hpp"
#include "lib/record/file_batch.hpp"
#include "lib/record/record_json.hpp"
#include "lib/record/short_lived_directory.hpp"
#include "lib/record/write_record.hpp"
#include "study/campaign/campaign_files.hpp"
#endif

namespace twinchute::study {
namespace {

#ifdef TWINCHUTE_HAS_CAMPAIGN

namespace fs = std::filesystem;

/// "i/n", i from 1.
void read_shard(const std::string& text, CampaignSettings& settings) {
    std::uint64_t number = 0;
    const char* const end = text.data() + text.size();
    const auto [slash, no_number] = std::from_chars(text.data(), end, number);
    bool ok = no_number == std::errc{} && slash != end && *slash == '/';
    if (ok) {
        const auto [rest, no_count] = std::from_chars(slash + 1, end, settings.shards);
        ok = no_count == std::errc{} && rest == end && number >= 1 && number <= settings.shards &&
             settings.shards <= 1'000'000;
    }
    if (!ok)
        throw UsageError(
            fmt::format("'--shard {}' is not understood (a number and how many there are), e.g. "
                        "--shard 2/8",
                        text));
    settings.shard = number - 1;
}

std::uint64_t run_number(const std::string& text, std::uint64_t runs) {
    std::uint64_t number = 0;
    const char* const end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, number);
    if (error != std::errc{} || rest != end || number >= runs)
        throw UsageError(fmt::format(
            "'--rerun {}' is not understood (runs count from 0 to {}), e.g. --rerun 0", text, runs - 1));
    return number;
}

CampaignSettings settings_of(const Arguments& arguments) {
    CampaignSettings settings;
    for (const std::string& text : arguments.values("set"))
        settings.overrides.push_back("--set " + text);
    settings.threads = whole_number(arguments, "threads", compare::processors(), 1024, 2);
    if (const auto shard = arguments.value("shard")) read_shard(*shard, settings);
    if (const auto format = arguments.value("export"); format && *format != "csv")
        throw UsageError(
            fmt::format("'--export {}' is not understood (csv is the one there is), --export csv", *format));
    return settings;
}

/// One run again, in full: its record, of both fidelities their comparison.
ExitCode rerun(const Campaign& campaign, std::uint64_t number, const fs::path& directory,
               const Arguments& arguments) {
    const bool quiet = arguments.has("quiet") || arguments.has("json");
    Design design(campaign.spec);
    std::vector<double> values(design.dimensions());
    design.values(number, values);
    Scene scene = campaign.sampler->scene_at(values);
    scene.name = fmt::format("{}, run {}", campaign.spec.name, number);
    const Interrupt interrupt;
    std::vector<RunRecord> records;
    for (const CampaignRuns& runs : campaign.of)
        records.push_back(run_watched(*runs.fidelity, scene, interrupt.token(), quiet, 1));
    if (records.size() == 2) {
        compare::Comparison comparison;
        comparison.candidate_title = campaign.of[0].fidelity->title;
        comparison.reference_title = campaign.of[1].fidelity->title;
        comparison.candidate = as_written(std::move(records[0]));
        comparison.reference = as_written(std::move(records[1]));
        comparison.gap = compare::measure_gap(comparison.reference, comparison.candidate, scene.tolerances);
        write_report(comparison, directory);
        if (!quiet) print(fmt::format("report    {}\n", printable((directory / "report.html").string())));
        return ExitCode::done;
    }
    const RunRecord& record = records.front();
    write_record(record, directory);
    if (arguments.has("json")) print(summary_json(record));
    if (!quiet) {
        print(record_text(record, campaign.of.front().fidelity->title, output_style()));
        print(fmt::format("record    {}\n", printable((directory / "summary.json").string())));
    }
    return exit_code(record.status.code);
}

/// Stores of runs that are there go on only where that is wanted; those of another campaign never.
void check_stores(const Campaign& campaign, bool goes_on) {
    // Another process may be making the directory just now: it is nobody's until it has its store.json.
    for (int tries = 0; !campaign.of.front().store->exists(); ++tries) {
        try {
            check_output_dir(campaign.directory);
            break;
        } catch (const UsageError&) {
            constexpr int most = 50;
            if (tries == most) throw;
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
    }
    for (const CampaignRuns& runs : campaign.of) {
        if (!runs.store->exists()) continue;
        runs.store->require_same();
        if (!goes_on)
            throw UsageError(
                fmt::format("'{}' holds runs of this campaign (nothing there is overwritten), go on "
                            "with --resume or name another directory with --out",
                            campaign.directory.string()));
    }
}

void write_results(const Campaign& campaign, const std::string& json, bool exports) {
    const fs::path& directory = campaign.directory;
    for (const CampaignRuns& runs : campaign.of) {
        const std::uint64_t count = &runs == &campaign.of.front() ? campaign.spec.runs : campaign.full_runs;
        if (count == 0) continue;  // interrupted before
        runs.store->join(count);
        if (exports) export_csv(runs, count, runs.store->folder().parent_path() / "runs.csv");
    }
    FileBatch batch;
    batch.add(directory / "report.html", campaign_page(campaign));
    batch.add(directory / "junit.xml", campaign_junit(campaign));
    if (campaign.spec.release_point && campaign.results.has_landing)
        batch.add(directory / "landing.kml", campaign_kml(campaign));
    batch.add(directory / "campaign.json", json, FileBatch::Kind::marker);
    batch.commit();
}

void say_valid(const Campaign& campaign, const Arguments& arguments) {
    const std::string words = fmt::format(
        "{}: the campaign '{}' is valid: {} runs, {} inputs; nothing was run", campaign.spec.file.string(),
        campaign.spec.name, campaign.spec.runs, campaign.spec.inputs.size());
    if (!arguments.has("quiet")) print(printable(words) + "\n");
}

ExitCode code_of(const Campaign& campaign) {
    if (campaign.interrupted) return ExitCode::interrupted;
    const bool none_complete = campaign.results.endings.complete == 0 && campaign.results.made > 0;
    if (none_complete || (campaign.both && campaign.both->endings.complete == 0)) return ExitCode::numerical;
    const bool met = std::ranges::all_of(judgements(campaign), [](const Judgement& j) {
        return j.verdict == Verdict::open || j.verdict == Verdict::met;
    });
    return met ? ExitCode::done : ExitCode::verdict;
}

ExitCode run_command(const Fidelity& rom, const Fidelity& full, const Arguments& arguments) {
    CampaignSettings settings = settings_of(arguments);
    CampaignSpec spec = read_campaign(arguments.operand);
    const bool is_shard = arguments.has("shard");
    if (is_shard && (spec.until || spec.rare || spec.fidelity == CampaignFidelity::both))
        throw UsageError(
            "--shard does not go with 'until', 'rare' or fidelity = \"both\" (which runs there are follows "
            "from all of them), give runs");
    const fs::path directory =
        arguments.value("out").value_or(default_output_dir(arguments.operand).string());
    Campaign campaign = open_campaign(std::move(spec), rom, full, directory, settings);
    if (arguments.has("check")) {
        say_valid(campaign, arguments);
        return ExitCode::done;
    }
    if (const auto number = arguments.value("rerun")) {
        const fs::path place = directory / ("rerun-" + *number);
        const std::uint64_t run = run_number(*number, campaign.spec.runs);
        check_output_dir(place);
        if (const RunStore& store = *campaign.of.front().store; store.exists()) store.require_same();
        return rerun(campaign, run, place, arguments);
    }
    check_stores(campaign, is_shard || arguments.has("resume") || arguments.has("export"));
    const bool quiet = arguments.has("quiet"), json = arguments.has("json");
    const Interrupt interrupt;  // until the files are safe
    settings.stop = interrupt.token();
    {
        ProgressLine line("campaign", !quiet && !json && progress_is_seen());
        settings.progress = line.reporter();
        run_campaign(campaign, settings);
    }
    if (is_shard && !campaign.interrupted) {
        if (!quiet)
            print(fmt::format("shard {} is done: {}\n", *arguments.value("shard"),
                              printable(directory.string())));
        return ExitCode::done;
    }
    evaluate_campaign(campaign);
    const std::string text = campaign_json(campaign);
    write_results(campaign, text, arguments.has("export"));
    if (json) print(text);
    if (!json && !quiet)
        print(campaign_text(campaign, output_style()) +
              fmt::format("report    {}\n", printable((directory / "report.html").string())));
    return code_of(campaign);
}

#else

[[noreturn]] void refuse_all() {
    throw UsageError(
        "'campaign' is not in this build (HDF5 or Random123 was not found when it was configured), "
        "install libhdf5-dev and librandom123-dev and build again");
}

ExitCode run_command(const Fidelity&, const Fidelity&, const Arguments&) {
    refuse_all();
}

#endif

}  // namespace

#ifdef TWINCHUTE_HAS_CAMPAIGN

StudyWork campaign_work(CampaignText asked, const Fidelity& rom, const Fidelity& full) {
    CampaignSpec spec = read_campaign_text(asked.text, asked.name, asked.directory, Bases::beneath);
    spec.base = asked.scene_file;
    CampaignSettings settings;
    settings.overrides = std::move(asked.overrides);
    settings.scene_with = std::move(asked.scene_with);
    settings.threads = asked.threads;
    return
        [=, &rom, &full](const std::stop_token& stop, const std::function<void(const Progress&)>& progress) {
            const ShortLivedDirectory place;
            CampaignSettings own = settings;
            own.stop = stop;
            own.progress = progress;
            Campaign campaign = open_campaign(spec, rom, full, place.path(), own);
            run_campaign(campaign, own);
            evaluate_campaign(campaign);
            return StudyResult{.json = campaign_json(campaign),
                               .page = campaign_page(campaign),
                               .interrupted = campaign.interrupted};
        };
}

#else

StudyWork campaign_work(CampaignText, const Fidelity&, const Fidelity&) {
    refuse_all();
}

#endif

Command campaign_command(const Fidelity& rom, const Fidelity& full) {
    Command command;
    command.name = "campaign";
    command.summary = "thousands of runs with inputs that vary: probabilities, quantiles, landing ellipses";
    command.operand = "FILE";
    command.example = "twinchute campaign data/campaigns/c9-overload.toml";
    command.options = {
        {"out", "DIR", "write runs and results there instead of ./<campaign file>.out"},
        {"threads", "N",
         "runs at the same time, as many as there are cores unless given; the answer is the same"},
        {"resume", "", "go on with the runs that are there"},
        {"shard", "I/N", "make only this part of the runs, beside other processes that make the others"},
        {"export", "csv", "also write all runs as runs.csv", false, {"csv"}},
        {"rerun", "INDEX", "run this one of the runs in full, with its record, into DIR/rerun-INDEX"},
        {"set", "KEY=VALUE", "override a key of the scene that varies", true},
        {"check", "", "validate campaign and scene and run nothing more than the scene itself"},
        {"json", "", "print the results as JSON and nothing else"},
        {"quiet", "", "print nothing but errors"}};
    command.run = [&rom, &full](const Arguments& arguments) { return run_command(rom, full, arguments); };
    return command;
}

}  // namespace twinchute::study
