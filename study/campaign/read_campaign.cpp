// From a campaign file to a CampaignSpec. Every key is known or refused, every number has the unit of what it
// belongs to.
#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "compare/validate/suite_table.hpp"
#include "lib/math/sha256.hpp"
#include "lib/math/vec.hpp"
#include "lib/scene/data_files.hpp"
#include "lib/scene/nearest.hpp"
#include "lib/scene/units.hpp"
#include "study/campaign/rare.hpp"
#include "study/campaign/read_answers.hpp"
#include "study/campaign/read_inputs.hpp"
#include "study/campaign/spec.hpp"

namespace twinchute::study {
namespace {

namespace fs = std::filesystem;
using compare::SuiteTable;

constexpr std::array designs{"random", "lhs", "sobol", "grid", "saltelli", "points.csv"};
constexpr std::array fidelities{"rom", "full", "both"};
constexpr std::uint64_t most_runs = 1'000'000'000;

std::uint64_t whole(SuiteTable& reader, std::string_view key, std::uint64_t fallback, std::uint64_t most) {
    const toml::node* node = reader.find(key);
    if (!node) return fallback;
    const auto value = node->value_exact<std::int64_t>();
    if (!value || *value < 0 || static_cast<std::uint64_t>(*value) > most)
        reader.refuse(key, fmt::format("a whole number from 0 to {} belongs here", most), "", "");
    return static_cast<std::uint64_t>(*value);
}

void read_design(SuiteTable& reader, CampaignSpec& spec) {
    const std::string word = reader.text("design");
    if (word.empty()) return;
    if (word.ends_with(".csv")) {
        spec.design = DesignKind::points;
        spec.points = word;
        return;
    }
    const auto known = std::ranges::find(designs, word);
    if (known == designs.end() || word == designs.back())
        reader.refuse("design", fmt::format("'{}' is unknown", word), "",
                      suggest(word, {designs.begin(), designs.end()}));
    spec.design = static_cast<DesignKind>(known - designs.begin());
}

void read_fidelity(SuiteTable& reader, CampaignSpec& spec) {
    const std::string word = reader.text("fidelity");
    if (word.empty()) return;
    const auto known = std::ranges::find(fidelities, word);
    if (known == fidelities.end())
        reader.refuse("fidelity", fmt::format("'{}' is unknown", word), "", "write rom, full or both");
    spec.fidelity = static_cast<CampaignFidelity>(known - fidelities.begin());
}

void read_until(SuiteTable& campaign, CampaignSpec& spec) {
    const toml::table* table = campaign.table("until");
    if (!table) return;
    SuiteTable reader(*table, campaign.file(), "campaign.until");
    StopRule rule;
    rule.answer = reader.needed_text("answer", "whose interval is judged");
    reader.need("halfwidth", "how narrow its interval has to be");
    const auto answer = std::ranges::find(spec.answers, rule.answer, &AnswerSpec::name);
    if (answer == spec.answers.end())
        reader.refuse("answer", fmt::format("there is no answer '{}'", rule.answer), "",
                      "name one of [[answer]]");
    if (answer->kind == AnswerSpec::Kind::ellipse)
        reader.refuse("answer", "an ellipse has no single halfwidth", "", "name another answer");
    // Of a probability "0.1 %" is an amount, of others a share of the estimate.
    if (answer->kind == AnswerSpec::Kind::probability) {
        rule.halfwidth = *reader.amount("halfwidth", "1");
    } else {
        const Tolerance width = *reader.tolerance("halfwidth", answer->unit.empty() ? "1" : answer->unit);
        rule.halfwidth = width.value, rule.relative = width.relative;
    }
    if (!(rule.halfwidth > 0.0)) reader.refuse("halfwidth", "is not positive", "", "e.g. \"0.1 %\"");
    reader.end();
    spec.until = rule;
}

void read_rare(SuiteTable& reader, CampaignSpec& spec) {
    const std::string word = reader.text("rare");
    if (word.empty()) return;
    if (word != "subset")
        reader.refuse("rare", fmt::format("'{}' is unknown", word), "", "write rare = \"subset\"");
    if (!has_subset_simulation())
        reader.refuse("rare", "is not in this build",
                      "OpenTURNS was not found when it was configured (Debian: libopenturns-dev)",
                      "install it and build again, or ask for more runs");
    if (spec.fidelity == CampaignFidelity::both || spec.until || spec.design == DesignKind::points ||
        spec.design == DesignKind::grid || spec.design == DesignKind::saltelli)
        reader.refuse("rare", "does not go with fidelity = \"both\", until, or points that are laid out",
                      "it draws its runs near the event",
                      "choose fidelity rom and design random, lhs or sobol");
    if (std::ranges::count(spec.inputs, wind_gusts, &CampaignInput::key) > 0)
        reader.refuse("rare", fmt::format("does not go with {}", wind_gusts),
                      "it steps from run to run towards the event, and a realisation has no neighbours",
                      "leave out one of them");
    if (std::ranges::count(spec.answers, AnswerSpec::Kind::probability, &AnswerSpec::kind) == 0)
        reader.refuse("rare", "is not used", "no [[answer]] is a probability", "leave it out");
    if (spec.runs < least_runs_of_rare)
        reader.refuse(
            "runs", fmt::format("is less than {}", least_runs_of_rare),
            fmt::format("rare makes that many a level, in {} simulations; of fewer its mean is off by more "
                        "than 2 %",
                        simulations),
            fmt::format("runs = {}", least_runs_of_rare));
    spec.rare = true;
}

/// [campaign], which refers to inputs and answers.
void read_plan(SuiteTable& top, CampaignSpec& spec) {
    top.need("campaign", "how many runs there are");
    SuiteTable reader(*top.table("campaign"), top.file(), "campaign");
    spec.seed = whole(reader, "seed", 1, std::numeric_limits<std::int64_t>::max());
    read_design(reader, spec);
    read_fidelity(reader, spec);
    read_until(reader, spec);
    const bool counts_itself = spec.design == DesignKind::points || spec.design == DesignKind::grid;
    if (!spec.until && !counts_itself) reader.need("runs", "how many runs there are, or until when");
    spec.runs = whole(reader, "runs", spec.until ? 10'000'000 : 0, most_runs);
    if (counts_itself && reader.find("runs"))
        reader.refuse("runs", "is not used", "this design has as many as it has points", "leave it out");
    if (!counts_itself && spec.runs == 0)
        reader.refuse("runs", "is zero", "", "give at least one, e.g. runs = 10000");
    // Whole points of Saltelli's design.
    if (const std::uint64_t block = spec.inputs.size() + 2; spec.design == DesignKind::saltelli)
        spec.runs = (spec.runs + block - 1) / block * block;
    if (spec.until && (counts_itself || spec.design == DesignKind::lhs))
        reader.refuse("until", "does not go with this design", "it is only right as a whole",
                      "choose random, sobol or saltelli");
    spec.pilot = reader.count("pilot", spec.pilot, 100'000);
    spec.full_runs = reader.count("full_runs", spec.full_runs, 1'000'000);
    if (spec.fidelity != CampaignFidelity::both)
        for (const char* key : {"pilot", "full_runs"})
            if (reader.find(key))
                reader.refuse(key, "is not used", "it belongs to fidelity = \"both\"", "leave it out");
    if (spec.fidelity == CampaignFidelity::both) {
        if (spec.until) reader.need("runs", "how many runs of the ROM there are");
        if (spec.pilot < 8)
            reader.refuse("pilot", "is less than 8", "a correlation needs some runs", "pilot = 20");
        if (static_cast<std::uint64_t>(spec.full_runs) > spec.runs || spec.pilot > spec.full_runs)
            reader.refuse("full_runs", "is not between pilot and runs", "each full run has one of the ROM",
                          "");
    }
    if (spec.fidelity == CampaignFidelity::both && (counts_itself || spec.design == DesignKind::saltelli))
        reader.refuse("design", "does not go with fidelity = \"both\"", "it wants runs drawn at random",
                      "choose random, lhs or sobol");
    if (const toml::table* point = reader.table("release_point")) {
        SuiteTable place(*point, reader.file(), "campaign.release_point");
        place.need("latitude", "where a map puts the release");
        place.need("longitude", "where a map puts the release");
        spec.release_point = {*place.amount("latitude", "rad"), *place.amount("longitude", "rad")};
        const auto check = [&](const char* key, double angle, double most) {
            if (!(std::abs(angle) <= most * pi / 180.0))
                place.refuse(key, fmt::format("{:.5g} deg is no {}", angle * 180.0 / pi, key),
                             "numbers without a unit are radians",
                             fmt::format("write e.g. {} = \"47.3 deg\"", key));
        };
        check("latitude", (*spec.release_point)[0], 90.0);
        check("longitude", (*spec.release_point)[1], 180.0);
        place.end();
    }
    read_rare(reader, spec);
    reader.end();
}

void check_design(const CampaignSpec& spec) {
    for (const AnswerSpec& answer : spec.answers)
        if (answer.limit && spec.design == DesignKind::grid)
            throw SceneError(answer.place, "answer.limit", "does not go with a grid",
                             "its runs are laid out, not drawn: they have no interval that a limit could be "
                             "held against",
                             "choose random, lhs or sobol");
    const bool correlated = !spec.correlation.isIdentity(0.0);
    if (correlated && (spec.design == DesignKind::grid || spec.design == DesignKind::saltelli))
        throw SceneError({spec.file.string(), 1, 1}, "campaign.design",
                         fmt::format("'{}' does not go with correlated inputs", design_name(spec.design)),
                         "its sums take each input for itself", "choose random, lhs or sobol");
}

toml::table parsed(std::string_view text, const std::string& name) {
    try {
        return toml::parse(text, name);
    } catch (const toml::parse_error& error) {
        const auto& begin = error.source().begin;
        throw SceneError({name, static_cast<int>(begin.line), static_cast<int>(begin.column)}, "",
                         "is not TOML", std::string(error.description()), "correct it there");
    }
}

}  // namespace

std::string_view design_name(DesignKind kind) {
    return designs[static_cast<std::size_t>(kind)];
}
std::string_view fidelity_name(CampaignFidelity fidelity) {
    return fidelities[static_cast<std::size_t>(fidelity)];
}

CampaignSpec read_campaign_text(std::string_view text, const std::string& name, const fs::path& directory,
                                Bases bases) {
    const toml::table table = parsed(text, name);
    SuiteTable reader(table, name, "");
    if (reader.count("schema", 1, 1) != 1) reader.refuse("schema", "is not 1", "", "write schema = 1");
    CampaignSpec spec;
    spec.file = name;
    spec.sha256 = sha256_hex(text);
    spec.name = reader.text("name");
    if (spec.name.empty()) spec.name = spec.file.stem().string();
    spec.base = reader.needed_text("base", "which scene varies");
    spec.set = reader.texts("set");
    const NamedFiles files{directory, bases};
    read_inputs(reader, files, spec);
    read_answers(reader, spec);
    read_plan(reader, spec);
    reader.end();
    finish_inputs(files, spec);
    check_design(spec);
    return spec;
}

CampaignSpec read_campaign(const fs::path& file) {
    return read_campaign_text(read_text_file(file), file.string(), file.parent_path());
}

}  // namespace twinchute::study
