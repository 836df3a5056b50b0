#include "compare/report/terminal.hpp"

#include <fmt/format.h>

#include "compare/report/attribution_text.hpp"
#include "compare/report/gap_tables.hpp"
#include "compare/report/words.hpp"
#include "lib/cli/record_text.hpp"

namespace twinchute::compare {
namespace {

/// A table and the line that says how to read it.
std::string with_legend(const Table& table, const Style& style, const std::string& legend) {
    return table.rows.empty() ? std::string() : terminal_table(table, style) + legend + "\n\n";
}

std::string test_text(const Comparison& comparison, const Style& style) {
    if (!comparison.test) return {};
    std::string text = with_legend(
        test_table(comparison), style,
        fmt::format("L2 norm of the difference over that of {}, from release on, where both have values",
                    printable(comparison.test->file)));
    for (const std::string& note : comparison.test->notes)
        text += fmt::format("test      {}\n", printable(note));
    return text;
}

std::string calibration_part(const Comparison& comparison, const Style& style) {
    return with_legend(calibration_table(comparison), style,
                       fmt::format("{} without its calibration and with it, in metrics with a tolerance",
                                   comparison.candidate.fidelity));
}

std::string attribution_part(const Comparison& comparison, const Style& style) {
    if (!comparison.attribution) return {};
    const Attribution& attribution = *comparison.attribution;
    std::string text;
    if (!attribution.metrics.empty()) text += terminal_table(attribution_table(comparison), style) + "\n";
    for (const MetricAttribution& metric : attribution.metrics)
        text += fmt::format("why       {}\n", printable(attribution_sentence(metric, comparison)));
    for (const std::string& note : attribution.notes)
        text += fmt::format("why       {}\n", printable(note));
    return text + "\n";
}

std::string side_notes(const RunRecord& record, const Style& style) {
    std::string text;
    if (record.filling) text += filling_text(*record.filling, record.fidelity + ": ");
    text += calibration_text(record, record.fidelity + ": ");
    for (const LeftOut& row : record.left_out) {
        text += fmt::format("left out  {}: {}{}\n", record.fidelity, printable(row.what),
                            row.why.empty() ? "" : fmt::format(" ({})", printable(row.why)));
    }
    return text + warnings_text(record.warnings, record.fidelity + " ", style);
}

}  // namespace

std::string terminal_text(const Comparison& comparison, const Style& style) {
    const ExitCode code = exit_code(comparison);
    const Colour colour = code == ExitCode::done          ? Colour::green
                          : code == ExitCode::interrupted ? Colour::yellow
                                                          : Colour::red;
    std::string text = style.paint(printable(comparison.reference.scene.name), Colour::bold) + "\n";
    if (const std::string fill = fill_constant_text(comparison.reference); !fill.empty()) {
        text += printable(fill) + "\n";
    }
    text += "\n";
    text += with_legend(metrics_table(comparison), style, printable(difference_legend(comparison)));
    text += with_legend(histories_table(comparison.gap), style,
                        fmt::format("L2 norm of the difference over that of {}; clocks begin at snatch",
                                    comparison.reference.fidelity));
    text += calibration_part(comparison, style);
    text += test_text(comparison, style);
    text += attribution_part(comparison, style);
    text += fmt::format("verdict   {}\n", style.paint(printable(verdict_line(comparison)), colour));
    if (is_judged(comparison.reference) && is_judged(comparison.candidate))
        for (const std::string& words : judged_words(comparison))
            text += fmt::format("          {}\n", printable(words));
    for (const MetricGap* metric : largest_unjudged(comparison.gap))
        text += fmt::format("unjudged  {}: {}\n", metric->row->title,
                            printable(difference_words(*metric, comparison)));
    text += units_text();
    text += fmt::format("cost      {}\n", cost_line(comparison));
    for (const RunRecord* side : {&comparison.candidate, &comparison.reference})
        text += side_notes(*side, style);
    return text;
}

}  // namespace twinchute::compare
