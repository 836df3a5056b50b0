#include "compare/stability_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "compare/render/escape.hpp"
#include "compare/render/table.hpp"
#include "lib/record/record_json.hpp"

namespace twinchute::compare {
namespace {

constexpr std::array verdicts{CellVerdict::stable, CellVerdict::refused, CellVerdict::stopped,
                              CellVerdict::silently_wrong, CellVerdict::misnamed};

/// Above a million a margin says no more than that.
std::string margin_text(const StabilityCell& cell) {
    if (!cell.margin) return "-";
    if (!(*cell.margin < 1e6)) return std::isnan(*cell.margin) ? "none" : "> 1e6";
    return readable(*cell.margin, 2);
}

/// Names the check that the margin is of, or why there is no answer.
std::string reason_text(const StabilityCell& cell) {
    if (cell.latency)
        return fmt::format("{}, within {} steps of the first sign: {}", cell.status, *cell.latency,
                           cell.reason);
    if (!cell.margin) return cell.status + ": " + cell.reason;
    return fmt::format("{}: {:.1e} of {:.1e}", cell.reason, *cell.error, *cell.limit);
}

std::string seconds_text(const StabilityCell& cell) {
    return cell.seconds > 0.0 ? fmt::format("{:.2g}", cell.seconds) : "-";
}

std::string short_of(std::string text, std::size_t most) {
    if (text.size() <= most) return text;
    text.resize(text.rfind(' ', most));
    return text + " ...";
}

/// Cells of one fidelity, or of every one, with its name, where `fidelity` is empty.
Table cells_table(const StabilityMatrix& matrix, std::string_view fidelity, std::size_t longest_reason) {
    Table table;
    if (fidelity.empty()) table.add_words({""});
    table.add_words({"case", "method", "verdict"});
    table.add_numbers({"margin", "steps", "s"});
    table.add_words({"reason"});
    for (const StabilityCell& cell : matrix.cells) {
        if (!fidelity.empty() && cell.row->fidelity != fidelity) continue;
        const Tone tone = is_failure(cell.verdict)              ? Tone::bad
                          : cell.verdict == CellVerdict::stable ? Tone::good
                                                                : Tone::caution;
        std::vector<Cell>& row = table.rows.emplace_back();
        if (fidelity.empty()) row.emplace_back(cell.row->fidelity);
        row.insert(row.end(), {cell.row->name,
                               cell.method,
                               {cell_verdict_name(cell.verdict), tone},
                               margin_text(cell),
                               fmt::format("{}", cell.steps),
                               seconds_text(cell),
                               short_of(reason_text(cell), longest_reason)});
    }
    return table;
}

constexpr std::string_view how_to_read =
    R"(Each cell runs one case by one method and ends in one of:

- **stable**: answered, and every check of the case holds. The margin is the limit of its nearest check over the
  error found; it has to be above 1.
- **refused**: before it ran, or at an instant before anything could go wrong, with the reason.
- **stopped**: by a guard, with a named status that is a true statement about this case. Which ones are true
  stands in the case's row of the source; any other ending counts as **misnamed**, a failure.
- **silently wrong**: answered, and a check fails. This is the failure that the matrix is there to exclude.

Steps and verdicts are the same in every run; seconds are those of one run each and of the machine at hand.

)";

constexpr std::string_view theory = R"(## What the checks rest on

Errors and limits are shares of the expected value.

- **Closed forms** of the reduced-order model: elastic snatch, force dv sqrt(k m_red) after a quarter period
  pi/2 sqrt(m_red/k), momentum shared; Ludtke's opening by drag alone, v/v_s = 1/(1 + I(x)/M); the fall in a
  vacuum; the fall with a constant drag area, v_e tanh(g t/v_e) and v_e^2/g ln cosh(g t/v_e); the terminal speed
  sqrt(2 W/(rho C_D S)). Limit: a hundred times the relative tolerance of the scene, 1e-6 at the default. One step may
  leave one tolerance, and a run has tens to tens of thousands of them, whose errors partly add up. The snatch force is the
  lines' stiffness times a small difference of lengths, so that its limit grows with the length over the stretch.
- **Another method** at a tolerance of 1e-12 where no closed form exists: two Runge-Kutta pairs of different order
  do not share their errors. They would share those of the right-hand side; the closed forms exclude these.
- **Energy ledger** of the full model: what does not add up over all the energy that changed hands. Limit: 0.2 %,
  where a run is stopped. An explicit step above the limit of stability brings in energy, so that this is the invariant
  that sees it.
- **Half the step**: peak force, largest deceleration and largest line tension within 0.5 %, as the tests of the time step
  hold them. A run that is driven by an instability, or rings at the edge of one, does not repeat its forces
  when the step is halved. Where lines chatter on next to no mass the peak is that of a chaotic motion: there the limit
  is the range of the peak over four starts that differ by a micrometre, if that is more.
- **Unstructured** is the layout in memory that imported, graded and damaged meshes have; here it has meshes that would do with the
  gore-batched layout, and no scene can ask for that. Besides the checks of its case, largest forces are those of that layout within 1e-4, where
  these end likewise: the arithmetic is the same but for the order of sums. Not so from the pack, which is chaotic, and not with one
  sector, whose layout is its own.
- **Momentum of the payload**: its change is the impulse of weight and riser force, within 1 % of both together; the
  rest is the trapezoidal rule over rows of 5 ms.
- **Snatch speed** from the pack: sqrt(2 g L), shared by both masses, within 1 m/s. Two packed runs cannot be compared
  force by force: they are chaotic.

**Stops**: a run looks for faults every 50 steps and drops what came after its last sound look. The first sign of a step
that is too long is an opening force more than 1 % of the peak away from that of a run in sound steps.

A step "times its bound" counts from the bound that a run takes its steps from, which is never above the true limit of that state.
Steps at multiples of the true limit, from the eigenvalues of the tangent, are held by
`tests/verification/structural_time_step_test.cpp`, with the number of steps until an instability is found.
)";

}  // namespace

std::string stability_summary(const StabilityMatrix& matrix) {
    std::string text;
    for (const CellVerdict verdict : verdicts) {
        const auto count = std::ranges::count(matrix.cells, verdict, &StabilityCell::verdict);
        if (count > 0 || verdict == CellVerdict::silently_wrong)
            text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, cell_verdict_name(verdict));
    }
    return fmt::format("{}; {} cells{}", text, matrix.cells.size(),
                       matrix.interrupted ? ", interrupted" : "");
}

std::string stability_terminal(const StabilityMatrix& matrix, const Style& style) {
    return terminal_table(cells_table(matrix, "", 90), style) + "\n" + stability_summary(matrix) + "\n";
}

std::string stability_csv(const StabilityMatrix& matrix) {
    Table table;
    table.add_words({"fidelity", "case", "method", "verdict"}, "-");
    table.add_words({"margin", "error", "limit"}, "1");
    table.add_words({"status", "reason"}, "-");
    table.add_words({"steps", "latency"}, "1");
    table.add_words({"end", "wall"}, "s");
    for (const StabilityCell& cell : matrix.cells)
        table.rows.push_back({cell.row->fidelity, cell.row->name, cell.method,
                              cell_verdict_name(cell.verdict), exact(cell.margin), exact(cell.error),
                              exact(cell.limit), cell.status, cell.reason, fmt::format("{}", cell.steps),
                              cell.latency ? fmt::format("{}", *cell.latency) : "", exact(cell.end),
                              exact(cell.seconds)});
    return csv_table(table);
}

std::string stability_markdown(const StabilityMatrix& matrix, const Provenance& provenance,
                               const std::string& command) {
    std::string text = "# Stability\n\n" + markdown_text(stability_summary(matrix)) + ".\n\n";
    text += fmt::format("Made by `{}`: twinchute {}, commit {}, {}, {}, {}.\n\n", command, provenance.version,
                        provenance.commit, markdown_text(provenance.compiler),
                        markdown_text(provenance.host_cpu), provenance.date);
    text += how_to_read;
    for (const auto& [fidelity, title] :
         {std::pair<std::string_view, const char*>{"rom", "Reduced-order model"}, {"full", "Full model"}}) {
        const Table table = cells_table(matrix, fidelity, std::string::npos);
        if (table.rows.empty()) continue;
        text += fmt::format("## {}\n\n{}", title, markdown_table(table));
        const StabilityCase* before = nullptr;
        std::string hard;
        for (const StabilityCell& cell : matrix.cells) {
            if (cell.row->fidelity != fidelity || cell.row == before) continue;
            hard += fmt::format("- {}: {}\n", markdown_text(cell.row->name), markdown_text(cell.row->why));
            before = cell.row;
        }
        text += "\nWhat is hard about them:\n\n" + hard + "\n";
    }
    return text + std::string(theory);
}

std::string stability_json(const StabilityMatrix& matrix, const Provenance& provenance) {
    nlohmann::ordered_json json;
    json["generator"] = "twinchute";
    json["schema"] = 1;
    json["summary"] = stability_summary(matrix);
    auto& list = json["cells"] = nlohmann::ordered_json::array();
    for (const StabilityCell& cell : matrix.cells) {
        nlohmann::ordered_json one{
            {"fidelity", cell.row->fidelity}, {"case", cell.row->name},
            {"method", cell.method},          {"verdict", cell_verdict_name(cell.verdict)},
            {"status", cell.status},          {"reason", cell.reason}};
        const auto put = [&](const char* key, const std::optional<double>& value) {
            if (value && std::isfinite(*value)) one[key] = *value;
        };
        put("margin", cell.margin);
        put("error", cell.error);
        put("limit", cell.limit);
        one["steps"] = cell.steps;
        if (cell.latency) one["latency_steps"] = *cell.latency;
        one["end_s"] = cell.end;
        one["wall_s"] = cell.seconds;
        list.push_back(std::move(one));
    }
    json["provenance"] = provenance_json(provenance);
    return json_text(json);
}

}  // namespace twinchute::compare
