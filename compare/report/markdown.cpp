#include "compare/report/markdown.hpp"

#include <fmt/format.h>

#include <array>

#include "compare/render/escape.hpp"
#include "compare/report/attribution_text.hpp"
#include "compare/report/gap_tables.hpp"
#include "compare/report/words.hpp"
#include "lib/cli/record_text.hpp"
#include "lib/cli/text.hpp"
#include "lib/record/display_units.hpp"

namespace twinchute::compare {
namespace {

using Sides = std::array<const RunRecord*, 2>;

std::string section(std::string_view title, const Table& table) {
    return table.rows.empty() ? std::string() : fmt::format("## {}\n\n{}\n", title, markdown_table(table));
}

std::string metrics_section(const Comparison& comparison) {
    const std::string text =
        section("Metrics", metrics_table(comparison)) + markdown_text(difference_legend(comparison)) + "\n" +
        "An *input* only repeats what the scene says; a *result* comes out of the model.\n";
    const std::string notes = markdown_table(metric_notes_table(comparison));
    return notes.empty() ? text : text + "\n" + notes;
}

std::string histories_section(const FidelityGap& gap) {
    if (gap.histories.empty()) return {};
    std::string text =
        section("Histories", phases_table(gap)) +
        "Clocks begin at snatch, of each parachute. Difference of the maxima, L2 and infinity norm of the "
        "difference, each over the\n"
        "reference's own in the same time. A tolerance is held against the L2 of inflation and "
        "descent.\n\n";
    std::string notes;
    for (const HistoryGap& history : gap.histories)
        if (!history.note.empty())
            notes += fmt::format("- {} over time: {}\n", history.row->title, history.note);
    return notes.empty() ? text : text + notes + "\n";
}

std::string test_section(const Comparison& comparison) {
    if (!comparison.test) return {};
    return section("Test", test_table(comparison)) +
           fmt::format(
               "L2 norm of the difference over that of {}, from release on, where both have values.\n\n",
               markdown_text(comparison.test->file));
}

std::string why_section(const Comparison& comparison) {
    if (!comparison.attribution) return {};
    const Attribution& attribution = *comparison.attribution;
    std::string text = "## Why\n\n";
    for (const MetricAttribution& metric : attribution.metrics)
        text += fmt::format("- {}\n", markdown_text(attribution_sentence(metric, comparison)));
    if (!attribution.metrics.empty()) {
        text += "\n" + markdown_table(attribution_table(comparison));
        text += fmt::format("\n{}\n\n", markdown_text(attribution_legend(comparison)));
        for (const std::string& detail : attribution_details(attribution))
            text += fmt::format("- {}\n", markdown_text(detail));
    }
    for (const std::string& note : attribution.notes)
        text += fmt::format("- {}\n", markdown_text(note));
    return text + "\n";
}

std::string cost_section(const Comparison& comparison, const Sides& sides) {
    std::string text = "## Cost\n\n";
    for (const RunRecord* side : sides) {
        text +=
            fmt::format("- {}: {}\n", markdown_text(side->fidelity), markdown_text(cost_text(side->cost)));
        for (const BlockCost& block : side->cost.blocks) {
            text += fmt::format("  - {}: {}\n", markdown_text(block.name), time_text(block.seconds));
        }
    }
    if (comparison.gap.cost_ratio) {
        text +=
            fmt::format("- {} took {} times as long as {}\n", markdown_text(comparison.reference.fidelity),
                        ratio_text(*comparison.gap.cost_ratio), markdown_text(comparison.candidate.fidelity));
    }
    return text;
}

std::string provenance_section(const RunRecord& record) {
    const Provenance& made = record.provenance;
    std::string text = "## Provenance\n\n";
    text += fmt::format("- scene: {} (SHA-256 {})\n", markdown_text(record.scene.file),
                        markdown_text(record.scene.sha256));
    text += fmt::format("- twinchute {}, commit {}, {}\n", markdown_text(made.version),
                        markdown_text(made.commit), markdown_text(made.date));
    text += fmt::format("- {}, {}, for {}\n", markdown_text(made.compiler), markdown_text(made.flags),
                        markdown_text(made.instruction_set));
    return text + fmt::format("- on {}, threads: {}\n", markdown_text(made.host_cpu), made.threads);
}

}  // namespace

std::string report_markdown(const Comparison& comparison) {
    const Sides sides{&comparison.candidate, &comparison.reference};
    const PageSides both = page_sides(comparison);
    std::string text = fmt::format("# {}\n\n", markdown_text(comparison.reference.scene.name));
    text += fmt::format("**{}**\n\n", markdown_text(verdict_line(comparison)));
    if (is_judged(comparison.reference) && is_judged(comparison.candidate))
        for (const std::string& words : judged_words(comparison))
            text += fmt::format("- {}\n", markdown_text(words));
    for (const MetricGap* metric : largest_unjudged(comparison.gap))
        text += fmt::format("- without a tolerance: {}: {}\n", markdown_text(metric->row->title),
                            markdown_text(difference_words(*metric, comparison)));
    text += "\n";
    text +=
        fmt::format("{} is the {}, {} the {}.\n\n", markdown_text(comparison.candidate.fidelity),
                    markdown_text(comparison.candidate_title), markdown_text(comparison.reference.fidelity),
                    markdown_text(comparison.reference_title));
    for (const RunRecord* side : sides) {
        text += fmt::format("- {}: {}{}\n", markdown_text(side->fidelity),
                            markdown_text(status_name(side->status.code)),
                            side->status.detail.empty() ? "" : ", " + markdown_text(side->status.detail));
    }
    if (const std::string fill = fill_constant_text(comparison.reference); !fill.empty()) {
        text += fmt::format("- {}\n", markdown_text(fill));
    }
    if (!units_remark().empty()) text += fmt::format("- units: {}\n", units_remark());
    text += "\n" + metrics_section(comparison) + "\n" + why_section(comparison);
    text += "## Curves\n\n![Opening force against time](force.svg)\n\n![Speed against time](speed.svg)\n\n";
    text +=
        histories_section(comparison.gap) + test_section(comparison) + cost_section(comparison, sides) + "\n";
    text += section("Events", events_table(both)) + section("Energy", energy_table(both));
    text += section("Before and after calibration", calibration_table(comparison));
    text += section("Predicted filling", filling_table(both));
    text += section("Left out", left_out_table(both)) + section("Warnings", warnings_table(both)) +
            section("Inputs", inputs_table(comparison.reference));
    return text + provenance_section(comparison.reference);
}

}  // namespace twinchute::compare
