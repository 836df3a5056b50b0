#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "study/campaign/campaign_files.hpp"

namespace twinchute::study {
namespace {

using compare::Cell;
using compare::Table;
using compare::Tone;

std::string to_five_digits(double value, const std::string& unit) {
    return readable(value, 5) + (unit.empty() ? "" : " " + unit);
}

std::string percent(const Interval& share) {
    if (!std::isfinite(share.estimate)) return "-";
    return fmt::format("{:.1f} % ({:.1f} to {:.1f})", 100.0 * share.estimate, 100.0 * share.low,
                       100.0 * share.high);
}

Tone tone_of(Verdict verdict) {
    switch (verdict) {
        case Verdict::met:
            return Tone::good;
        case Verdict::undecided:
            return Tone::caution;
        case Verdict::exceeded:
            return Tone::bad;
        case Verdict::open:
            break;
    }
    return Tone::quiet;
}

std::string question_of(const AnswerSpec& a) {
    switch (a.kind) {
        case AnswerSpec::Kind::probability:
            return fmt::format("P({})", a.asked);
        case AnswerSpec::Kind::quantile:
            return fmt::format("{:g} % of {}", 100.0 * a.level, metric_words(a.metric));
        case AnswerSpec::Kind::mean:
            return "mean of " + metric_words(a.metric);
        case AnswerSpec::Kind::ellipse:
            return fmt::format("{:g} % landing ellipse, half axes", 100.0 * a.level);
    }
    return {};
}

std::string end_text(const AnswerSpec& answer, double end) {
    return std::isfinite(end) ? answer_number(answer, end) : "too few runs";
}

std::string interval_text(const AnswerSpec& answer, const Interval& value) {
    if (!std::isfinite(value.estimate) || (std::isnan(value.low) && std::isnan(value.high))) return "-";
    return fmt::format("{} to {}", end_text(answer, value.low), end_text(answer, value.high));
}

}  // namespace

std::string answer_number(const AnswerSpec& answer, double value) {
    if (!std::isfinite(value)) return "-";
    if (answer.kind == AnswerSpec::Kind::probability) return fmt::format("{:.4g} %", 100.0 * value);
    return to_five_digits(value, answer.unit);
}

Table answers_table(const Campaign& campaign) {
    Table table;
    table.add_words({"Answer", "Question"});
    table.add_numbers({"Estimate", "95 % interval", "Runs", "Limit"});
    table.add_words({"Verdict"});
    for (const Answer& a : campaign.results.answers) {
        std::string estimate = answer_number(*a.spec, a.value.estimate);
        if (a.ellipse) estimate += " and " + answer_number(*a.spec, a.ellipse->minor.estimate);
        table.rows.push_back({Cell(a.spec->name, Tone::strong), question_of(*a.spec), estimate,
                              interval_text(*a.spec, a.value), fmt::format("{}", a.count),
                              a.spec->limit ? answer_number(*a.spec, *a.spec->limit) : "-",
                              Cell(verdict_name(a.verdict), tone_of(a.verdict), a.method)});
    }
    return table;
}

Table indices_table(const Campaign& campaign, const MetricIndices& indices) {
    Table table;
    table.add_words({"Input"});
    table.add_numbers({"First order", "Total"});
    const auto cell = [](const std::optional<Interval>& index) { return index ? percent(*index) : "-"; };
    for (std::size_t i = 0; i < indices.of.size(); ++i)
        table.rows.push_back({Cell(campaign.spec.inputs[i].key, Tone::code), cell(indices.of[i].first),
                              cell(indices.of[i].total)});
    return table;
}

Table inputs_table(const Campaign& campaign) {
    Table table;
    table.add_words({"Input", "Distribution", "Unit", "Source", "Grade"});
    for (const CampaignInput& input : campaign.spec.inputs)
        table.rows.push_back(
            {Cell(input.key, Tone::code),
             input.distribution ? input.distribution->shown() : "points of " + campaign.spec.points,
             input.unit.empty() ? "-" : input.unit, input.source.empty() ? "-" : input.source,
             input.grade.empty() ? "-" : input.grade});
    return table;
}

Table failures_table(const Campaign& campaign) {
    Table table;
    table.add_words({"Ended by"});
    table.add_numbers({"Runs"});
    table.add_words({"First of them"});
    const auto add = [&](const Endings& endings, const char* model) {
        for (const auto& [status, failed] : endings.failed)
            table.rows.push_back({model + status, fmt::format("{}", failed.count),
                                  fmt::format("{}{}", fmt::join(failed.first, ", "),
                                              failed.count > failed.first.size() ? ", ..." : "")});
    };
    add(campaign.results.endings, campaign.both ? "reduced-order model: " : "");
    if (campaign.both) add(campaign.both->endings, "full model: ");
    return table;
}

std::vector<std::string> answer_notes(const Campaign& campaign) {
    std::vector<std::string> notes;
    for (const std::string& key : campaign.set_in_vain)
        notes.push_back(fmt::format("{} is set, and varies: no run has the value that is set", key));
    for (const Answer& a : campaign.results.answers) {
        if (!a.note.empty()) notes.push_back(fmt::format("{}: {}", a.spec->name, a.note));
        if (!a.rare) continue;
        std::string note = fmt::format("{}: {} subset simulations, {} levels at most", a.spec->name,
                                       simulations, a.rare->levels);
        for (std::size_t i = 0; i < a.rare->inputs.size(); ++i)
            note += fmt::format("{} {} {}", i == 0 ? "; where it happens, on average" : ",",
                                campaign.spec.inputs[i].key,
                                to_five_digits(a.rare->inputs[i], campaign.spec.inputs[i].unit));
        if (a.rare->failed > 0)
            note += fmt::format("; {} of the runs failed and count as no hit", a.rare->failed);
        notes.push_back(std::move(note));
    }
    if (!campaign.both) return notes;
    for (const PairedAnswer& a : campaign.both->answers) {
        if (!a.note.empty()) notes.push_back(fmt::format("{}: {}", a.spec->name, a.note));
        if (a.spec->kind != AnswerSpec::Kind::mean || !std::isfinite(campaign.both->cost_ratio)) continue;
        notes.push_back(
            fmt::format("{}: a full run cost {:.0f} reduced-order runs; the narrowest interval for its cost "
                        "has {:.0f} of these "
                        "for each full run, here there were {:.0f}",
                        a.spec->name, campaign.both->cost_ratio,
                        best_cheap_runs(a.correlation, campaign.both->cost_ratio),
                        static_cast<double>(a.cheap_runs) / static_cast<double>(campaign.both->pairs)));
    }
    return notes;
}

Table pairs_table(const MultiFidelity& both) {
    Table table;
    table.add_words({"Answer of the full model"});
    table.add_numbers({"Estimate", "95 % interval", "ROM alone", "Full runs alone", "Correlation", "Gain"});
    table.add_words({"Verdict", "Method"});
    for (const PairedAnswer& a : both.answers)
        table.rows.push_back(
            {Cell(a.spec->name, Tone::strong), answer_number(*a.spec, a.value.estimate),
             interval_text(*a.spec, a.value), answer_number(*a.spec, a.cheap),
             interval_text(*a.spec, a.dear_alone),
             std::isfinite(a.correlation) ? fmt::format("{:.5f}", a.correlation) : "-",
             std::isfinite(a.gain.estimate)
                 ? fmt::format("{:.0f} ({:.0f} to {:.0f})", a.gain.estimate, a.gain.low, a.gain.high)
                 : "-",
             Cell(verdict_name(a.verdict), tone_of(a.verdict)), a.method});
    return table;
}

}  // namespace twinchute::study
