#include "compare/report/markdown.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "compare/report/attribution_text.hpp"
#include "compare/report/escape.hpp"
#include "compare/report/words.hpp"
#include "lib/cli/record_text.hpp"
#include "lib/cli/text.hpp"

namespace twinchute::compare {
namespace {

using Sides = std::array<const RunRecord*, 2>;

/// Cells are foreign text.
std::string row(const std::vector<std::string>& cells) {
    std::string line = "|";
    for (const std::string& cell : cells)
        line += " " + markdown_text(cell) + " |";
    return line + "\n";
}

/// `alignment`: one letter a column, l or r.
std::string header(const std::vector<std::string>& cells, std::string_view alignment) {
    std::string rule = "|";
    for (const char c : alignment)
        rule += c == 'r' ? " ---: |" : " --- |";
    return row(cells) + rule + "\n";
}

/// What has to be known about a row, a line each; what both sides say is said once.
std::string notes_of(const MetricGap& metric, const Comparison& comparison) {
    std::string text;
    const auto say = [&](const std::string& who, const std::string& what) {
        if (what.empty()) return;
        text += fmt::format("- {}{}{}: {}\n", markdown_text(metric.row->title), who.empty() ? "" : ", ",
                            markdown_text(who), markdown_text(what));
    };
    say("", metric.note);
    const std::string candidate = metric.candidate ? metric.candidate->note : "";
    const std::string reference = metric.reference ? metric.reference->note : "";
    if (candidate == reference) {
        say("both", candidate);
    } else {
        say(comparison.candidate.fidelity, candidate);
        say(comparison.reference.fidelity, reference);
    }
    return text;
}

std::string metrics_section(const Comparison& comparison) {
    const std::string& reference = comparison.reference.fidelity;
    const std::string& candidate = comparison.candidate.fidelity;
    std::string text = "## Metrics\n\n" + header({"metric", candidate, reference, "difference", "tolerance",
                                                  "verdict", candidate + " is", reference + " is"},
                                                 "lrrrrlll");
    std::string notes;
    for (const MetricGap& metric : comparison.gap.metrics) {
        const std::string_view unit = metric.row->unit;
        text += row({std::string(metric.row->title), value_text(metric.candidate, unit),
                     value_text(metric.reference, unit), difference_text(metric),
                     metric.tolerance ? fmt::format("{} ({})", tolerance_text(*metric.tolerance, unit),
                                                    origin_name(metric.origin))
                                      : "-",
                     std::string(metric.verdict == Verdict::not_judged ? "-" : verdict_name(metric.verdict)),
                     standing_text(metric.candidate), standing_text(metric.reference)});
        notes += notes_of(metric, comparison);
    }
    text += fmt::format(
        "\nDifferences are {} minus {}; relative ones and relative tolerances are shares of {}.\n",
        markdown_text(candidate), markdown_text(reference), markdown_text(reference));
    text += "An *input* only repeats what the scene says; a *result* comes out of the model.\n";
    return notes.empty() ? text : text + "\n" + notes;
}

std::string verdict_or_dash(Verdict verdict) {
    return std::string(verdict == Verdict::not_judged ? "-" : verdict_name(verdict));
}

std::string histories_section(const FidelityGap& gap) {
    if (gap.histories.empty()) return {};
    std::string text = "## Histories\n\n" + header({"over time", "phase", "since snatch [s]", "maximum", "L2",
                                                    "infinity", "tolerance", "verdict"},
                                                   "llrrrrrl");
    std::string notes;
    for (const HistoryGap& history : gap.histories) {
        const std::string title(history.row->title);
        const std::string tolerance =
            history.tolerance ? fmt::format("{} ({})", share_text(history.tolerance->value, false),
                                            origin_name(history.origin))
                              : "-";
        for (const PhaseScore& phase : history.phases) {
            const bool judged = phase.phase != HistoryPhase::deployment;
            text +=
                row({title, std::string(phase_name(phase.phase)),
                     fmt::format("{:.2f} to {:.2f}", phase.from, phase.to), share_text(phase.maximum, true),
                     share_text(phase.l2, false), share_text(phase.infinity, false), judged ? tolerance : "-",
                     verdict_or_dash(phase_verdict(history, phase))});
        }
        if (history.phases.empty())
            text += row({title, "-", "-", "-", "-", "-", tolerance, verdict_or_dash(history.verdict)});
        if (!history.note.empty()) notes += fmt::format("- {} over time: {}\n", title, history.note);
    }
    text +=
        "\nBoth clocks begin at snatch. Difference of the maxima, L2 and infinity norm of the difference, "
        "each over the\n"
        "reference's own in the same time. A tolerance is held against the L2 of inflation and descent.\n\n";
    return notes.empty() ? text : text + notes + "\n";
}

std::string test_section(const Comparison& comparison) {
    if (!comparison.test) return {};
    std::string text = "## Test\n\n" + header({"over time", "largest", comparison.candidate.fidelity,
                                               comparison.reference.fidelity},
                                              "lrrr");
    for (const TestScore& score : scores_of_test(comparison))
        text += row(test_cells(score));
    return text + fmt::format(
                      "\nL2 norm of the difference over that of {}, from release on, where both have "
                      "values.\n\n",
                      markdown_text(comparison.test->file));
}

std::string attribution_section(const Comparison& comparison) {
    if (!comparison.attribution) return {};
    const Attribution& attribution = *comparison.attribution;
    std::string text = "## Why\n\n";
    for (const MetricAttribution& metric : attribution.metrics)
        text += fmt::format("- {}\n", markdown_text(attribution_sentence(metric, comparison)));
    if (!attribution.metrics.empty()) {
        const Table table = attribution_table(comparison);
        text += "\n" + header(table.header, "l" + std::string(table.header.size() - 1, 'r'));
        for (const std::vector<std::string>& cells : table.rows)
            text += row(cells);
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

std::string energy_section(const Sides& sides) {
    struct Line {
        std::string_view name;
        double EnergyLedger::*term;
        bool fraction;
    };
    constexpr std::array lines{
        Line{"kinetic [J]", &EnergyLedger::kinetic, false},
        Line{"elastic [J]", &EnergyLedger::elastic, false},
        Line{"work of gravity [J]", &EnergyLedger::gravity_work, false},
        Line{"work of drag [J]", &EnergyLedger::drag_work, false},
        Line{"damping [J]", &EnergyLedger::damping, false},
        Line{"added mass [J]", &EnergyLedger::added_mass, false},
        Line{"change of structure [J]", &EnergyLedger::ramp, false},
        Line{"external work [J]", &EnergyLedger::external_work, false},
        Line{"residual over work of drag [%]", &EnergyLedger::residual_fraction, true},
    };
    if (std::ranges::none_of(sides, [](const RunRecord* side) { return side->energy.has_value(); }))
        return {};
    std::string text =
        "## Energy\n\n" + header({"since release", sides[0]->fidelity, sides[1]->fidelity}, "lrr");
    for (const Line& line : lines) {
        std::vector<std::string> cells{std::string(line.name)};
        bool any = false;
        for (const RunRecord* side : sides) {
            const double value = side->energy ? (*side->energy).*line.term : 0.0;
            const bool there =
                side->energy && (value != 0.0 || line.fraction);  // exactly zero: nothing behind it
            any = any || there;
            cells.push_back(!there          ? "-"
                            : line.fraction ? fmt::format("{:.2g}", 100 * value)
                                            : readable(value));
        }
        if (any) text += row(cells);
    }
    return text + "\n";
}

std::string events_section(const Sides& sides) {
    std::vector<const Event*> order;  // each name once, by the time it first happens on either side
    for (const RunRecord* side : sides) {
        for (const Event& event : side->events)
            order.push_back(&event);
    }
    std::ranges::stable_sort(order, {}, &Event::time);
    std::vector<std::string> names;
    for (const Event* event : order) {
        if (std::ranges::count(names, event->name) == 0) names.push_back(event->name);
    }
    if (names.empty()) return {};
    std::vector<std::string> titles{"event"};
    for (const RunRecord* side : sides) {
        for (const char* what : {"time [s]", "altitude [m]", "speed [m/s]"})
            titles.push_back(side->fidelity + " " + what);
    }
    std::string text = "## Events\n\n" + header(titles, "lrrrrrr");
    for (const std::string& name : names) {
        std::vector<std::string> cells{name};
        for (const RunRecord* side : sides) {
            const Event* event = side->find_event(name);
            cells.push_back(event == nullptr ? "-" : fmt::format("{:.3f}", event->time));
            cells.push_back(event == nullptr ? "-" : fmt::format("{:.1f}", event->altitude));
            cells.push_back(event == nullptr ? "-" : fmt::format("{:.2f}", event->speed));
        }
        text += row(cells);
    }
    return text + "\n";
}

std::string notes_section(const Sides& sides) {
    std::string left_out, warnings;
    for (const RunRecord* side : sides) {
        for (const LeftOut& what : side->left_out) {
            left_out += fmt::format("- {}: {}{}\n", markdown_text(side->fidelity), markdown_text(what.what),
                                    what.why.empty() ? "" : " (" + markdown_text(what.why) + ")");
        }
        for (const Warning& warning : side->warnings) {
            warnings +=
                fmt::format("- {}: {}{}{}\n", markdown_text(side->fidelity), markdown_text(warning.what),
                            warning.why.empty() ? "" : " (" + markdown_text(warning.why) + ")",
                            warning.suggestion.empty() ? "" : ", " + markdown_text(warning.suggestion));
        }
    }
    std::string text;
    if (!left_out.empty()) text += "## Left out\n\n" + left_out + "\n";
    if (!warnings.empty()) text += "## Warnings\n\n" + warnings + "\n";
    return text;
}

std::string inputs_section(const RunRecord& record) {
    if (record.inputs.empty()) return {};
    std::string text = "## Inputs\n\n" + header({"key", "value", "unit", "origin", "source"}, "lrlll");
    for (const Input& input : record.inputs) {
        const auto* number = std::get_if<double>(&input.value);
        text += row({input.key, number ? fmt::format("{:.10g}", *number) : std::get<std::string>(input.value),
                     input.unit, std::string(origin_name(input.origin)), input.source});
    }
    return text + "\n";
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
    std::string text = fmt::format("# {}\n\n", markdown_text(comparison.reference.scene.name));
    text += fmt::format("**{}**\n\n", markdown_text(verdict_line(comparison)));
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
    text += "\n" + metrics_section(comparison) + "\n" + attribution_section(comparison);
    text += "## Curves\n\n![Opening force against time](force.svg)\n\n![Speed against time](speed.svg)\n\n";
    text +=
        histories_section(comparison.gap) + test_section(comparison) + cost_section(comparison, sides) + "\n";
    text += events_section(sides) + energy_section(sides) + notes_section(sides);
    text += inputs_section(comparison.reference);
    return text + provenance_section(comparison.reference);
}

}  // namespace twinchute::compare
