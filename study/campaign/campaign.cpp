#include "study/campaign/campaign.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "lib/cli/command.hpp"
#include "lib/math/sha256.hpp"
#include "lib/record/checkpoint.hpp"
#include "lib/scene/scene_digest.hpp"
#include "lib/scene/units.hpp"
#include "study/campaign/engine.hpp"

namespace twinchute::study {
namespace {

constexpr std::uint64_t rom_chunk = 8192, full_chunk = 64, pair_chunk = 4;

/// Digest of all that a run depends on; for a design without an end that leaves out the number of runs.
std::string digest_of(const CampaignSpec& spec, const Scene& nominal, const Fidelity& fidelity) {
    std::string text =
        fmt::format("{}\n{}\n{}\n", scene_digest(nominal), fidelity.name, design_name(spec.design));
    if (spec.design == DesignKind::lhs) text += fmt::format("runs {}\n", spec.runs);
    for (const CampaignInput& input : spec.inputs) {
        text += fmt::format("{} {} {}\n", input.key,
                            input.distribution ? input.distribution->text() : "points", input.levels);
        for (const Wind& wind : input.winds)
            for (const auto& [altitude, v] : wind.levels)
                text += fmt::format("{} {} {} {}\n", altitude, v.x(), v.y(), v.z());
        if (input.gusts)
            text += fmt::format("{} {}\n", fmt::join(input.gusts->sd, " "),
                                fmt::join(input.gusts->correlation_length, " "));
    }
    for (Eigen::Index i = 0; i < spec.correlation.size(); ++i)
        text += fmt::format("{} ", spec.correlation.data()[i]);
    for (const std::vector<double>& row : spec.point_rows)
        text += fmt::format("{}\n", fmt::join(row, " "));
    return sha256_hex(text);
}

/// Whether a metric takes the whole history of its run, which costs more than all others and is not made in
/// batches: kept where it is asked for.
bool takes_history(std::string_view key) {
    return key == "impulse_N_s" || key == "max_altitude_m" || key.ends_with("_percent_drag_area_s") ||
           key.ends_with("_mach_number");
}

/// Metrics to keep: those of a run of the scene that stand in the table of metrics, and those asked for.
Columns columns_of(const CampaignSpec& spec, const RunRecord& nominal) {
    Columns columns;
    columns.inputs = spec.inputs.size();
    const auto add = [&](std::string key) {
        if (std::ranges::count(columns.metrics, key) == 0) columns.metrics.push_back(std::move(key));
    };
    for (const MetricRow& row : metric_rows())
        if (nominal.find_metric(row.key) && !takes_history(row.key)) add(std::string(row.key));
    for (const AnswerSpec& answer : spec.answers) {
        if (answer.kind == AnswerSpec::Kind::ellipse) {
            add("landing_east_m");
            add("landing_north_m");
        } else {
            add(answer.metric);
        }
    }
    return columns;
}

/// Refuses a question that the scene has no answer to.
void require_answers(const CampaignSpec& spec, const RunRecord& nominal) {
    for (const AnswerSpec& answer : spec.answers) {
        const std::string key = answer.kind == AnswerSpec::Kind::ellipse ? "landing_east_m" : answer.metric;
        if (nominal.find_metric(key) || key == "unopened_parachutes") continue;
        throw SceneError(answer.place, "answer",
                         fmt::format("'{}': a run of the scene has no {}", answer.name, metric_words(key)),
                         fmt::format("it ended: {}", nominal.status.detail),
                         "ask for another metric, or change the scene's stop");
    }
}

StoreIdentity identity_of(const CampaignSpec& spec, const Scene& nominal, const CampaignRuns& runs,
                          std::uint64_t chunk) {
    StoreIdentity identity;
    identity.program = current_program();
    identity.digest = digest_of(spec, nominal, *runs.fidelity);
    identity.seed = spec.seed;
    identity.chunk = chunk;
    identity.columns = {"status"};
    identity.units = {""};
    for (const CampaignInput& input : spec.inputs) {
        identity.columns.push_back(input.key);
        identity.units.push_back(input.unit);
    }
    for (const std::string& metric : runs.columns.metrics) {
        identity.columns.push_back(metric);
        identity.units.emplace_back(split_metric_key(metric).unit);
    }
    for (int code = 0; status_name(static_cast<StatusCode>(code)) != "unknown"; ++code)
        identity.statuses.emplace_back(status_name(static_cast<StatusCode>(code)));
    return identity;
}

CampaignRuns open_runs(const Campaign& campaign, const Fidelity& fidelity,
                       const std::filesystem::path& directory, std::uint64_t chunk) {
    const Scene& nominal = campaign.sampler->nominal();
    if (const auto lacking = fidelity.unsupported_keys(nominal); !lacking.empty())
        throw UsageError(fmt::format("{}: '{}' cannot run this scene ({}), choose another fidelity",
                                     campaign.spec.file.string(), fidelity.name,
                                     unsupported_text(nominal, lacking)));
    CampaignRuns runs;
    runs.fidelity = &fidelity;
    Run run;
    const RunRecord record = fidelity.run(nominal, run);
    require_answers(campaign.spec, record);
    runs.columns = columns_of(campaign.spec, record);
    runs.store = std::make_unique<RunStore>(directory, identity_of(campaign.spec, nominal, runs, chunk));
    runs.in_batches = fidelity.batches && campaign.spec.design != DesignKind::points &&
                      fidelity.batches(nominal, runs.columns.metrics);
    runs.engine = runs.in_batches    ? fmt::format("in batches of {}", fidelity.batch)
                  : fidelity.metrics ? "one by one, metrics alone"
                                     : "one by one, whole records";
    if (nominal.full.symmetry == Symmetry::sector && fidelity.name == "full") runs.engine += ", one sector";
    if (!campaign.sampler->is_quick()) runs.engine += ", scene read anew for each run";
    return runs;
}

/// A scene with overrides below those that it is called with.
SceneWith with(const SceneWith& scene_with, std::vector<std::string> overrides) {
    return [scene_with, overrides = std::move(overrides)](const std::vector<std::string>& more) {
        std::vector<std::string> all = overrides;
        all.insert(all.end(), more.begin(), more.end());
        return scene_with(all);
    };
}

/// The scene of a campaign. Where full runs are made of it and one sector can stand for the whole canopy, at
/// every value of the inputs, it does, unless the scene says otherwise.
std::unique_ptr<Sampler> make_sampler(const CampaignSpec& spec, const SceneWith& scene_with) {
    auto given = std::make_unique<Sampler>(spec, scene_with);
    const bool may_differ = std::ranges::any_of(spec.inputs, [](const CampaignInput& input) {
        return input.key == "release.path_angle" || input.kind == KeyKind::word || input.gusts;
    });
    const bool is_said = std::ranges::any_of(given->nominal().inputs, [](const Input& input) {
        return input.key == "full.symmetry" && input.origin != InputOrigin::fallback;
    });
    if (spec.fidelity == CampaignFidelity::rom || may_differ || is_said) return given;
    try {
        return std::make_unique<Sampler>(spec, with(scene_with, {"--set full.symmetry=\"sector\""}));
    } catch (const SceneError&) {
        return given;  // its sectors differ
    }
}

/// Running interval of the first answer, for the line of progress.
class Running {
public:
    Running(const Campaign& campaign, const CampaignRuns& runs, std::uint64_t wanted,
            const CampaignSettings& settings)
        : settings_(settings), wanted_(wanted), width_(runs.store->columns()) {
        for (const AnswerSpec& answer : campaign.spec.answers)
            if (!answer_ && answer.kind != AnswerSpec::Kind::ellipse && runs.columns.of(answer.metric)) {
                answer_ = &answer;
                column_ = *runs.columns.of(answer.metric);
            }
    }

    void add(std::span<const double> rows) {
        if (!settings_.progress) return;
        done_ += rows.size() / width_;
        for (std::size_t at = 0; answer_ && at < rows.size(); at += width_) {
            const double value = rows[at + column_];
            if (std::isnan(value)) continue;
            moments_.add(value);
            hits_ += (answer_->above ? value > answer_->threshold : value < answer_->threshold) ? 1 : 0;
        }
        const std::string text = words();
        settings_.progress({text, std::numeric_limits<double>::quiet_NaN(),
                            static_cast<double>(done_) * static_cast<double>(settings_.shards) /
                                static_cast<double>(wanted_)});
    }

private:
    std::string words() const {
        std::string text = fmt::format("{} runs", done_);
        if (!answer_ || moments_.count < 2) return text;
        const Interval now = answer_->kind == AnswerSpec::Kind::probability
                                 ? share_interval(hits_, moments_.count)
                                 : mean_interval(moments_);
        return text + fmt::format(", {}{} {:.4g} ({:.4g} to {:.4g})", answer_->name,
                                  answer_->kind == AnswerSpec::Kind::quantile ? ", mean" : "", now.estimate,
                                  now.low, now.high);
    }

    const CampaignSettings& settings_;
    std::uint64_t wanted_, done_ = 0, hits_ = 0;
    std::size_t width_, column_ = 0;
    const AnswerSpec* answer_ = nullptr;
    Moments moments_;
};

Engine engine_of(const Campaign& campaign, const CampaignRuns& runs, const CampaignSettings& settings) {
    return {campaign.spec,  *campaign.sampler, *runs.fidelity, runs.columns, settings.threads,
            settings.shard, settings.shards,   settings.stop,  {},           runs.in_batches};
}

bool make_runs(const Campaign& campaign, CampaignRuns& runs, std::uint64_t count,
               const CampaignSettings& settings) {
    Running running(campaign, runs, count, settings);
    Engine engine = engine_of(campaign, runs, settings);
    engine.cost = &runs.cost;
    engine.made = [&](std::span<const double> rows) { running.add(rows); };
    return engine.run(*runs.store, count);
}

/// Simulations of the answers that are probabilities.
bool simulate_rare(Campaign& campaign, const CampaignSettings& settings) {
    const CampaignRuns& runs = campaign.of.front();
    const Engine engine = engine_of(campaign, runs, settings);
    for (std::size_t i = 0; i < campaign.spec.answers.size(); ++i) {
        const AnswerSpec& answer = campaign.spec.answers[i];
        std::optional<RareEvent>& event = campaign.rare.emplace_back();
        if (answer.kind != AnswerSpec::Kind::probability || !runs.columns.of(answer.metric)) continue;
        if (settings.progress)
            settings.progress({fmt::format("{}, subset simulation", answer.name),
                               std::numeric_limits<double>::quiet_NaN(), 1.0});
        event = estimate_rare(engine, answer, i);
        if (!event) return false;
    }
    return true;
}

bool is_narrow(const StopRule& rule, const Interval& value) {
    const double width = rule.relative ? rule.halfwidth * std::abs(value.estimate) : rule.halfwidth;
    return value.halfwidth() <= width;
}

/// Goes on until the interval is narrow, looked at after numbers of runs that no thread has a say in.
bool run_until(Campaign& campaign, const CampaignSettings& settings) {
    CampaignRuns& runs = campaign.of.front();
    const StopRule& rule = *campaign.spec.until;
    const auto answer = std::ranges::find(campaign.spec.answers, rule.answer, &AnswerSpec::name);
    const std::uint64_t most = campaign.spec.runs, chunk = runs.store->identity().chunk;
    std::uint64_t chunks = 1;
    for (;;) {
        campaign.spec.runs = std::min(most, chunks * chunk);
        if (!make_runs(campaign, runs, campaign.spec.runs, settings)) return false;
        const Interval now =
            interval_of(campaign.spec, *answer, *runs.store, runs.columns, campaign.spec.runs);
        if (campaign.spec.runs == most || is_narrow(rule, now)) return true;
        chunks += std::max<std::uint64_t>(1, chunks / 4);
    }
}

/// Runs of the full model: the pilot, then as many as the interval of the answer needs by what the pilot
/// shows at worst, looked at again; all that are allowed where there is no such rule.
bool run_pairs(Campaign& campaign, const CampaignSettings& settings) {
    const CampaignSpec& spec = campaign.spec;
    const CampaignRuns& cheap = campaign.of[0];
    CampaignRuns& dear = campaign.of[1];
    const auto most = static_cast<std::uint64_t>(spec.full_runs);
    std::uint64_t count = spec.until ? static_cast<std::uint64_t>(spec.pilot) : most;
    for (;;) {
        if (!make_runs(campaign, dear, count, settings)) return false;
        campaign.full_runs = count;
        if (!spec.until || count == most) return true;
        const MultiFidelity now =
            combine(spec, *cheap.store, cheap.columns, *dear.store, dear.columns, spec.runs, count);
        const auto answer = std::ranges::find(now.answers, spec.until->answer,
                                              [](const PairedAnswer& a) { return a.spec->name; });
        if (answer == now.answers.end() || is_narrow(*spec.until, answer->value)) return true;
        const double wanted = spec.until->relative ? spec.until->halfwidth * std::abs(answer->value.estimate)
                                                   : spec.until->halfwidth;
        const double ratio = answer->value.halfwidth() / wanted;
        const double next = std::min(static_cast<double>(most), static_cast<double>(count) * ratio * ratio);
        count = std::clamp<std::uint64_t>(static_cast<std::uint64_t>(next), count + pair_chunk, most);
    }
}

/// Keys that overrides, "--set key=value" each, set beside a distribution of their own.
std::vector<std::string> set_in_vain(const std::vector<std::string>& overrides, const CampaignSpec& spec) {
    std::vector<std::string> keys;
    for (const std::string_view text : overrides) {
        const std::string_view assignment = text.substr(text.find(' ') + 1);
        const std::string_view key = trimmed(assignment.substr(0, assignment.find('=')));
        if (std::ranges::count(spec.inputs, key, &CampaignInput::key) > 0) keys.emplace_back(key);
    }
    return keys;
}

}  // namespace

Campaign open_campaign(CampaignSpec spec, const Fidelity& rom, const Fidelity& full,
                       const std::filesystem::path& directory, const CampaignSettings& settings) {
    Campaign campaign{.spec = std::move(spec), .sampler = nullptr, .directory = directory, .of = {}};
    std::vector<std::string> overrides;
    for (const std::string& text : campaign.spec.set)
        overrides.push_back("--set " + text);
    overrides.insert(overrides.end(), settings.overrides.begin(), settings.overrides.end());
    campaign.set_in_vain = set_in_vain(settings.overrides, campaign.spec);
    campaign.sampler = make_sampler(
        campaign.spec,
        with(settings.scene_with ? settings.scene_with : base_of(campaign.spec), std::move(overrides)));
    switch (campaign.spec.fidelity) {
        case CampaignFidelity::rom:
            campaign.of.push_back(open_runs(campaign, rom, directory, rom_chunk));
            break;
        case CampaignFidelity::full:
            campaign.of.push_back(open_runs(campaign, full, directory, full_chunk));
            break;
        case CampaignFidelity::both:
            campaign.of.push_back(open_runs(campaign, rom, directory, rom_chunk));
            campaign.of.push_back(open_runs(campaign, full, directory / "full", pair_chunk));
            break;
    }
    return campaign;
}

void run_campaign(Campaign& campaign, const CampaignSettings& settings) {
    const auto start = std::chrono::steady_clock::now();
    campaign.threads = settings.threads;
    for (const CampaignRuns& runs : campaign.of)
        runs.store->begin();
    CampaignRuns& first = campaign.of.front();
    const bool both = campaign.of.size() > 1;
    bool done = campaign.spec.until && !both ? run_until(campaign, settings)
                                             : make_runs(campaign, first, campaign.spec.runs, settings);
    if (done && both) done = run_pairs(campaign, settings);
    if (done && campaign.spec.rare) done = simulate_rare(campaign, settings);
    campaign.interrupted = !done;
    campaign.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void evaluate_campaign(Campaign& campaign) {
    const CampaignRuns& first = campaign.of.front();
    campaign.results = evaluate(campaign.spec, *first.store, first.columns, campaign.spec.runs);
    for (std::size_t i = 0; i < campaign.rare.size(); ++i)
        if (campaign.rare[i]) take_simulation(campaign.results.answers[i], *campaign.rare[i]);
    if (campaign.of.size() < 2) return;
    const CampaignRuns& dear = campaign.of[1];
    campaign.both = combine(campaign.spec, *first.store, first.columns, *dear.store, dear.columns,
                            campaign.spec.runs, campaign.full_runs);
    campaign.both->cost_ratio = dear.cost.each() / first.cost.each();
}

std::vector<Judgement> judgements(const Campaign& campaign) {
    std::vector<Judgement> all;
    for (const Answer& a : campaign.results.answers) {
        all.push_back({a.spec, a.value, a.verdict, false});
        if (!campaign.both) continue;
        const auto paired = std::ranges::find(campaign.both->answers, a.spec, &PairedAnswer::spec);
        if (paired != campaign.both->answers.end())
            all.back() = {a.spec, paired->value, paired->verdict, true};
    }
    return all;
}

}  // namespace twinchute::study
