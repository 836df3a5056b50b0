#include "compare/report/gap_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "compare/report/words.hpp"
#include "lib/cli/text.hpp"
#include "lib/record/display_units.hpp"

namespace twinchute::compare {
namespace {

using Sides = std::array<const RunRecord*, 2>;
Sides sides_of(const Comparison& comparison) {
    return {&comparison.candidate, &comparison.reference};
}

/// As metrics of one parachute among several are titled.
std::string of_parachute(const std::string& parachute, std::string_view what) {
    return parachute.empty() ? std::string(what) : fmt::format("{}: {}", parachute, what);
}

struct LedgerLine {
    std::string_view name;
    double EnergyLedger::*term;
};
constexpr std::array ledger_lines{
    LedgerLine{"Work of gravity", &EnergyLedger::gravity_work},
    LedgerLine{"Work of drag", &EnergyLedger::drag_work},
    LedgerLine{"External work", &EnergyLedger::external_work},
    LedgerLine{"Change of structure", &EnergyLedger::ramp},
    LedgerLine{"Added mass, brought to speed", &EnergyLedger::added_mass},
    LedgerLine{"Damping", &EnergyLedger::damping},
    LedgerLine{"Kinetic, change", &EnergyLedger::kinetic},
    LedgerLine{"Elastic, change", &EnergyLedger::elastic},
};

double term_of(const RunRecord& record, const LedgerLine& line) {
    return record.energy ? (*record.energy).*line.term : 0.0;
}

Cell fixed(double value, int decimals) {
    return std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : "-";
}

/// Whose a row is says nothing where there is one side.
Table named_by_side(Table table, const PageSides& sides) {
    if (sides.size() > 1) return table;
    table.columns.erase(table.columns.begin());
    for (std::vector<Cell>& row : table.rows)
        row.erase(row.begin());
    return table;
}

Cell tolerance_cell(const std::optional<Tolerance>& tolerance, const std::string& text,
                    ToleranceOrigin origin) {
    return tolerance ? Cell(text, Tone::plain, std::string(origin_name(origin))) : Cell("-");
}

}  // namespace

Cell verdict_cell(Verdict verdict) {
    const std::string_view name = verdict_name(verdict);
    switch (verdict) {
        case Verdict::within:
            return {name, Tone::good};
        case Verdict::exceeded:
            return {name, Tone::bad};
        case Verdict::missing:
            return {name, Tone::missing};
        case Verdict::not_reached:
            return {name, Tone::open};
        case Verdict::not_judged:
            break;
    }
    return "-";
}

Table metrics_table(const Comparison& comparison) {
    const std::string reference = comparison.reference.fidelity, candidate = comparison.candidate.fidelity;
    Table table;
    table.add_words({"metric"});
    table.add_numbers({candidate, reference, "difference", "tolerance"});
    table.add_words({"verdict", candidate + " is", reference + " is"});
    for (const MetricGap& metric : comparison.gap.metrics) {
        const std::string_view unit = metric.row->unit;
        const bool repeats_inputs = metric.candidate && metric.reference &&
                                    metric.candidate->kind == MetricKind::input &&
                                    metric.reference->kind == MetricKind::input;
        table.rows.push_back(
            {{metric.row->title, metric.verdict != Verdict::not_judged ? Tone::strong
                                 : repeats_inputs                      ? Tone::quiet
                                                                       : Tone::plain},
             value_text(metric.candidate, unit),
             value_text(metric.reference, unit),
             difference_text(metric),
             tolerance_cell(metric.tolerance,
                            metric.tolerance ? shown_tolerance(*metric.tolerance, unit) : "", metric.origin),
             verdict_cell(metric.verdict),
             standing_text(metric.candidate),
             standing_text(metric.reference)});
    }
    return table;
}

Table metric_notes_table(const Comparison& comparison) {
    Table table;
    table.add_words({"metric", "of", "note"});
    for (const MetricGap& metric : comparison.gap.metrics) {
        const auto add = [&](const Cell& side, const std::string& note) {
            if (!note.empty()) table.rows.push_back({metric.row->title, side, note});
        };
        const std::string candidate = metric.candidate ? metric.candidate->note : "",
                          reference = metric.reference ? metric.reference->note : "";
        add("-", metric.note);
        if (candidate == reference) {
            add("both", candidate);
        } else {
            add({comparison.candidate.fidelity, Tone::candidate}, candidate);
            add({comparison.reference.fidelity, Tone::reference}, reference);
        }
    }
    return table;
}

Table histories_table(const FidelityGap& gap) {
    constexpr std::array phases{HistoryPhase::deployment, HistoryPhase::inflation, HistoryPhase::descent};
    Table table;
    table.add_words({"over time"});
    for (const HistoryPhase phase : phases)
        table.add_numbers({phase_name(phase)});
    table.add_numbers({"tolerance"});
    table.add_words({"verdict"});
    for (const HistoryGap& history : gap.histories) {
        std::span<const PhaseScore> rest = history.phases;
        do {  // a row for each parachute
            const std::string parachute = rest.empty() ? "" : rest.front().parachute;
            const auto next = std::ranges::find_if(
                rest, [&](const PhaseScore& score) { return score.parachute != parachute; });
            const auto own = rest.first(static_cast<std::size_t>(next - rest.begin()));
            rest = rest.subspan(own.size());
            std::vector<Cell>& cells = table.rows.emplace_back();
            cells.emplace_back(of_parachute(parachute, history.row->title));
            for (const HistoryPhase phase : phases) {
                const auto score = std::ranges::find(own, phase, &PhaseScore::phase);
                cells.emplace_back(score == own.end() ? "-" : share_text(score->l2, false));
            }
            cells.emplace_back(history.tolerance ? share_text(history.tolerance->value, false) : "-");
            const bool exceeds = std::ranges::any_of(own, [&](const PhaseScore& score) {
                return phase_verdict(history, score) == Verdict::exceeded;
            });
            const bool is_within = history.verdict == Verdict::exceeded && !exceeds;  // another's
            cells.push_back(verdict_cell(is_within ? Verdict::within : history.verdict));
        } while (!rest.empty());
    }
    return table;
}

Table phases_table(const FidelityGap& gap) {
    Table table;
    table.add_words({"over time", "phase"});
    table.add_numbers({"since snatch"}, "s");
    table.add_numbers({"maximum", "L2", "infinity", "tolerance"});
    table.add_words({"verdict"});
    for (const HistoryGap& history : gap.histories) {
        const Cell tolerance = tolerance_cell(
            history.tolerance, history.tolerance ? share_text(history.tolerance->value, false) : "",
            history.origin);
        for (const PhaseScore& phase : history.phases)
            table.rows.push_back({history.row->title, of_parachute(phase.parachute, phase_name(phase.phase)),
                                  fmt::format("{:.2f} to {:.2f}", phase.from, phase.to),
                                  share_text(-phase.maximum, true), share_text(phase.l2, false),
                                  share_text(phase.infinity, false),
                                  phase.phase == HistoryPhase::deployment ? "-" : tolerance,
                                  verdict_cell(phase_verdict(history, phase))});
        if (history.phases.empty())
            table.rows.push_back(
                {history.row->title, "-", "-", "-", "-", "-", tolerance, verdict_cell(history.verdict)});
    }
    return table;
}

Table test_table(const Comparison& comparison) {
    const Sides sides = sides_of(comparison);
    Table table;
    table.add_words({"over time"});
    table.add_numbers({"largest", sides[0]->fidelity, sides[1]->fidelity});
    for (const TestScore& score : test_scores(*comparison.test, sides)) {
        std::vector<Cell>& cells = table.rows.emplace_back();
        cells = {score.row->title, with_unit(score.largest, score.row->unit)};
        for (const std::optional<double>& l2 : score.l2)
            cells.emplace_back(l2 ? share_text(*l2, false) : "-");
    }
    return table;
}

Table energy_table(const PageSides& sides) {
    if (std::ranges::none_of(sides, [](const PageSide& side) { return side.record->energy.has_value(); }))
        return {};
    double largest = 0.0;
    for (const LedgerLine& line : ledger_lines)
        for (const PageSide& side : sides)
            if (const double term = term_of(*side.record, line); std::isfinite(term))
                largest = std::max(largest, std::abs(term));
    Table table;
    table.add_words({"energy"}, shown_unit("kJ"));
    for (const PageSide& side : sides)
        table.add_numbers({side.record->fidelity});
    table.columns.push_back({.title = "share", .drawn = true});
    for (const LedgerLine& line : ledger_lines) {
        std::vector<Cell> cells{line.name};
        std::vector<Bar> bars;
        bool any = false;
        for (const PageSide& side : sides) {
            const double value = term_of(*side.record, line);
            any = any || value != 0.0;  // exactly zero: nothing behind it
            cells.emplace_back(value != 0.0 ? readable(shown(1e-3 * value, "kJ").value) : "-");
            if (value == 0.0 || !std::isfinite(value)) continue;
            const double width =
                50.0 * std::abs(value / largest);  // from the middle, to the right if positive
            bars.push_back({side.tone == Tone::candidate ? "bar candidate" : "bar reference",
                            value < 0.0 ? 50.0 - width : 50.0, width});
        }
        cells.emplace_back(std::move(bars));
        if (any) table.rows.push_back(std::move(cells));
    }
    std::vector<Cell> residual{"Not accounted for, of the work of drag"};
    for (const PageSide& side : sides)
        residual.emplace_back(side.record->energy && std::isfinite(side.record->energy->residual_fraction)
                                  ? fmt::format("{:.2g} %", 100 * side.record->energy->residual_fraction)
                                  : "-");
    residual.emplace_back();
    table.rows.push_back(std::move(residual));
    return table;
}

Table events_table(const PageSides& sides) {
    const SharedClock clock = shared_clock(sides);
    const bool compares = sides.size() > 1;
    Table table;
    table.add_words({"event"});
    const auto columns = [&](std::string_view what, std::string_view unit) {
        for (const PageSide& side : sides)
            table.add_numbers({(compares ? side.record->fidelity + " " : "") + std::string(what)}, unit);
    };
    columns("time", "s");
    if (compares) table.add_numbers({"difference"}, "s");
    columns("altitude", shown_unit("m"));
    columns("speed", shown_unit("m/s"));
    for (const EventPair& pair : event_pairs(sides)) {
        std::vector<Cell> cells{pair.name};
        const auto of_all = [&](double Event::*value, int decimals, std::string_view unit) {
            for (std::size_t s = 0; s < sides.size(); ++s)
                cells.push_back(pair.event[s] ? fixed(shown(pair.event[s]->*value, unit).value, decimals)
                                              : "-");
        };
        of_all(&Event::time, 3, "s");
        const auto& [candidate, reference] = pair.event;
        if (compares)
            cells.push_back(
                candidate && reference
                    ? signed_text((reference->time - clock.zero[1]) - (candidate->time - clock.zero[0]),
                                  std::max(std::abs(reference->time), std::abs(candidate->time)))
                    : "-");
        of_all(&Event::altitude, 1, "m");
        of_all(&Event::speed, 2, "m/s");
        table.rows.push_back(std::move(cells));
    }
    return table;
}

Table calibration_table(const Comparison& comparison) {
    Table table;
    table.add_words({"metric"});
    table.add_numbers({comparison.candidate.fidelity + " before", "after", comparison.reference.fidelity},
                      "");
    table.add_words({"unit"});
    table.add_numbers({"gap before", "after"}, "%");
    for (const CalibrationGap& one : calibration_gaps(comparison)) {
        const auto number = [&](double value) { return readable(shown(value, one.row->unit).value, 4); };
        table.rows.push_back({std::string(one.row->title), number(one.before), number(one.after),
                              number(one.reference), std::string(shown_unit(one.row->unit)),
                              signed_text(-100.0 * one.gap_before, 100.0),
                              signed_text(-100.0 * one.gap_after, 100.0)});
    }
    return table;
}

Table filling_table(const PageSides& sides) {
    Table table;
    table.add_words({"of", "case"});
    table.add_numbers({"initial mouth"}, "");
    table.add_numbers({"filling time"}, "s");
    table.add_numbers({"fill constant"}, "");
    table.add_numbers({"peak force"}, shown_unit("N"));
    table.add_words({"end"});
    const auto number = [](const std::optional<double>& value, std::string_view unit = {}) {
        return value ? readable(shown(*value, unit).value, 4) : std::string("-");
    };
    for (const PageSide& side : sides) {
        const RunRecord& record = *side.record;
        if (!record.filling) continue;
        const auto add = [&](const char* what, const PredictedFilling::At& at) {
            table.rows.push_back({{record.fidelity, side.tone},
                                  what,
                                  readable(at.initial_mouth, 4),
                                  number(at.filling_time),
                                  number(at.fill_constant),
                                  number(at.peak_force, "N"),
                                  at.status});
        };
        add("as given",
            {record.filling->initial_mouth, std::string(status_name(record.status.code)),
             record.metric("filling_time_s"), record.metric("fill_constant"), record.metric("peak_force_N")});
        for (const PredictedFilling::At& at : record.filling->bracket)
            add("bracket", at);
    }
    return named_by_side(std::move(table), sides);
}

Table left_out_table(const PageSides& sides) {
    Table table;
    table.add_words({"by", "left out", "why"});
    for (const PageSide& side : sides)
        for (const LeftOut& row : side.record->left_out)
            table.rows.push_back({{side.record->fidelity, side.tone}, row.what, row.why});
    return named_by_side(std::move(table), sides);
}

Table warnings_table(const PageSides& sides) {
    Table table;
    table.add_words({"of", "warning", "why", "what helps"});
    for (const PageSide& side : sides)
        for (const Warning& row : side.record->warnings)
            table.rows.push_back({{side.record->fidelity, side.tone}, row.what, row.why, row.suggestion});
    return named_by_side(std::move(table), sides);
}

Table inputs_table(const RunRecord& record) {
    Table table;
    table.add_words({"key"});
    table.add_numbers({"value"});
    table.add_words({"unit", "origin", "source"});
    for (const Input& input : record.inputs) {
        const auto* number = std::get_if<double>(&input.value);
        table.rows.push_back({{input.key, Tone::code},
                              number ? fmt::format("{:.10g}", *number) : std::get<std::string>(input.value),
                              input.unit,
                              origin_name(input.origin),
                              input.source});
    }
    return table;
}

}  // namespace twinchute::compare
