#include "compare/report/terminal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "compare/report/attribution_text.hpp"
#include "compare/report/words.hpp"
#include "lib/cli/record_text.hpp"

namespace twinchute::compare {
namespace {

Colour verdict_colour(Verdict verdict) {
    switch (verdict) {
        case Verdict::within:
            return Colour::green;
        case Verdict::exceeded:
        case Verdict::missing:
            return Colour::red;
        case Verdict::not_reached:
        case Verdict::not_judged:
            return Colour::none;
    }
    return Colour::none;
}

/// Paints the verdicts of a table, one a row, afterwards: colour codes would count as columns.
std::string painted(const std::string& text, const std::vector<Verdict>& verdicts, const Style& style) {
    if (!style.colour) return text;
    std::string result;
    std::size_t row = 0;
    for (std::size_t begin = 0; begin < text.size(); ++row) {
        const std::size_t end = text.find('\n', begin);
        std::string line = text.substr(begin, end - begin);
        if (row > 0) {
            const std::string_view name = verdict_name(verdicts[row - 1]);
            const std::size_t at = line.rfind(name);
            if (at != std::string::npos)
                line.replace(at, name.size(), style.paint(name, verdict_colour(verdicts[row - 1])));
        }
        result += line + '\n';
        begin = end + 1;
    }
    return result;
}

std::string gap_table(const Comparison& comparison, const Style& style) {
    Table table;
    const std::string reference = comparison.reference.fidelity, candidate = comparison.candidate.fidelity;
    table.header = {"metric",    candidate, reference,         "difference",
                    "tolerance", "verdict", candidate + " is", reference + " is"};
    table.right = {false, true, true, true, true};
    std::vector<Verdict> verdicts;
    for (const MetricGap& metric : comparison.gap.metrics) {
        verdicts.push_back(metric.verdict);
        const std::string_view unit = metric.row->unit;
        const bool judged = metric.verdict != Verdict::not_judged;
        table.rows.push_back({std::string(metric.row->title), value_text(metric.candidate, unit),
                              value_text(metric.reference, unit), difference_text(metric),
                              metric.tolerance ? tolerance_text(*metric.tolerance, unit) : "-",
                              judged ? std::string(verdict_name(metric.verdict)) : "-",
                              standing_text(metric.candidate), standing_text(metric.reference)});
    }
    return painted(aligned(table, style), verdicts, style);
}

/// A line a history: the share by phase, in one norm; the report has the others.
std::string histories_text(const Comparison& comparison, const Style& style) {
    Table table;
    table.header = {"over time"};
    table.right = {false};
    constexpr std::array phases{HistoryPhase::deployment, HistoryPhase::inflation, HistoryPhase::descent};
    for (const HistoryPhase phase : phases) {
        table.header.emplace_back(phase_name(phase));
        table.right.push_back(true);
    }
    table.header.insert(table.header.end(), {"tolerance", "verdict"});
    table.right.push_back(true);
    std::vector<Verdict> verdicts;
    for (const HistoryGap& history : comparison.gap.histories) {
        std::vector<std::string> cells{std::string(history.row->title)};
        for (const HistoryPhase phase : phases) {
            const auto score = std::ranges::find(history.phases, phase, &PhaseScore::phase);
            cells.push_back(score == history.phases.end() ? "-" : share_text(score->l2, false));
        }
        cells.push_back(history.tolerance ? share_text(history.tolerance->value, false) : "-");
        cells.emplace_back(history.verdict == Verdict::not_judged ? "-" : verdict_name(history.verdict));
        table.rows.push_back(std::move(cells));
        verdicts.push_back(history.verdict);
    }
    if (table.rows.empty()) return {};
    return painted(aligned(table, style), verdicts, style) +
           fmt::format("L2 norm of the difference over that of {}; both clocks begin at snatch\n\n",
                       comparison.reference.fidelity);
}

/// A line a measured history.
std::string test_text(const Comparison& comparison, const Style& style) {
    if (!comparison.test) return {};
    Table table;
    table.header = {"test", "largest", comparison.candidate.fidelity, comparison.reference.fidelity};
    table.right = {false, true, true, true};
    for (const TestScore& score : scores_of_test(comparison))
        table.rows.push_back(test_cells(score));
    return aligned(table, style) +
           fmt::format(
               "L2 norm of the difference over that of {}, from release on, where both have values\n\n",
               printable(comparison.test->file));
}

std::string attribution_part(const Comparison& comparison, const Style& style) {
    if (!comparison.attribution) return {};
    const Attribution& attribution = *comparison.attribution;
    std::string text;
    if (!attribution.metrics.empty()) {
        Table table = attribution_table(comparison);
        for (std::vector<std::string>& cells : table.rows)
            std::ranges::transform(cells, cells.begin(),
                                   [](const std::string& cell) { return printable(cell); });
        text += aligned(table, style) + "\n";
    }
    for (const MetricAttribution& metric : attribution.metrics)
        text += fmt::format("why       {}\n", printable(attribution_sentence(metric, comparison)));
    for (const std::string& note : attribution.notes)
        text += fmt::format("why       {}\n", printable(note));
    return text + "\n";
}

std::string side_notes(const RunRecord& record, const Style& style) {
    std::string text;
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
    text += gap_table(comparison, style) + "\n" + histories_text(comparison, style) +
            test_text(comparison, style);
    text += attribution_part(comparison, style);
    text += fmt::format("verdict   {}\n", style.paint(printable(verdict_line(comparison)), colour));
    text += fmt::format("cost      {}\n", cost_line(comparison));
    for (const RunRecord* side : {&comparison.candidate, &comparison.reference})
        text += side_notes(*side, style);
    return text;
}

}  // namespace twinchute::compare
