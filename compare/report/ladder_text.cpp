// The ladder for reading: Markdown and terminal.
#include <fmt/format.h>

#include <algorithm>

#include "compare/render/escape.hpp"
#include "compare/report/ladder_files.hpp"
#include "lib/cli/record_text.hpp"
#include "lib/cli/text.hpp"

namespace twinchute::compare {
namespace {

std::string share_text(double value) {
    if (value == 0.0) return "0";
    return value >= 1e-4 ? fmt::format("{:.2g} %", 100 * value) : fmt::format("{:.1e}", value);
}

std::string worst_text(const std::optional<Worst>& worst) {
    return worst ? share_text(worst->value) : "-";
}

std::string status_text(const LevelResult& result) {
    if (!result.was_run) return "not run";
    if (result.is_reference) return "reference";
    const std::string status(status_name(result.status.code));
    return result.level.given ? status + ", as given" : status;
}

std::string to_six_digits(double value, std::string_view unit) {
    return readable(value, 6) + (unit.empty() ? "" : " ") + std::string(unit);
}

std::string value_of(const LevelMetric* metric) {
    if (metric == nullptr) return "-";
    std::string text = to_six_digits(metric->value, metric->row->unit);
    if (metric->low != metric->high)
        text += fmt::format(" ({} to {})", readable(metric->low, 4), readable(metric->high, 4));
    return text;
}

Table values_table(const Ladder& ladder) {
    Table table;
    table.add_words({"level", "setting", "shows"});
    for (const std::string_view name : ladder.judged)
        table.add_numbers({find_metric_row(name)->title});
    for (const LevelResult& result : ladder.levels) {
        std::vector<Cell>& row = table.rows.emplace_back();
        row = {result.level.name, result.setting, result.level.why};
        for (const std::string_view name : ladder.judged)
            row.emplace_back(value_of(result.find(name)));
    }
    return table;
}

std::string failures_of(const Ladder& ladder, const char* prefix) {
    std::string text;
    for (const LevelResult& result : ladder.levels)
        if (!result.ended())
            text += fmt::format("{}{}: {}{}{}\n", prefix, result.level.name, status_text(result),
                                result.status.detail.empty() ? "" : ", ", clean_text(result.status.detail));
    return text;
}

std::string test_text(const Ladder& ladder) {
    if (!ladder.test) return {};
    std::string text = fmt::format("*To test* is the largest distance from what `{}` measured (",
                                   clean_text(ladder.test->file));
    for (const TestValue& measured : ladder.test->values)
        text += fmt::format("{}{} {}", &measured == &ladder.test->values.front() ? "" : ", ",
                            measured.row->title, to_six_digits(measured.value, measured.row->unit));
    return text +
           "). It holds errors of numbers, of the model and of\nthe test, and is kept apart from all of "
           "them. ";
}

std::string seeds_text(const Ladder& ladder) {
    int seeds = 1;
    for (const LevelResult& result : ladder.levels)
        seeds = std::max(seeds, result.seeds);
    if (seeds == 1) return {};
    return fmt::format("Values of runs with noise are medians over {} seeds, with their range. ", seeds);
}

}  // namespace

Table levels_table(const Ladder& ladder) {
    Table table;
    table.add_words({"level"});
    table.add_numbers({"time", "steps", "calls", "error"});
    table.add_words({"in"});
    table.add_numbers({"estimate"});
    for (const std::string_view fidelity : ladder.fidelities)
        table.add_numbers({fmt::format("gap to {}", fidelity)});
    if (ladder.test) table.add_numbers({"to test"});
    table.add_numbers({"effect"});
    table.add_words({"front", "status"});
    for (const LevelResult& result : ladder.levels) {
        const bool counts = result.was_run && result.steps > 0;
        std::vector<Cell>& row = table.rows.emplace_back();
        row = {result.level.name,
               result.was_run ? time_text(result.wall_s) : "-",
               counts ? fmt::format("{}", result.steps) : "-",
               counts ? fmt::format("{}", result.rhs_calls) : "-",
               worst_text(result.error),
               result.error ? result.error->metric : "-",
               worst_text(result.estimate)};
        for (const std::string_view fidelity : ladder.fidelities)
            row.emplace_back(worst_text(result.gap_to(fidelity)));
        if (ladder.test) row.emplace_back(worst_text(result.to_test));
        row.insert(row.end(), {worst_text(result.effect), result.on_front ? "*" : "", status_text(result)});
    }
    return table;
}

Table references_table(const Ladder& ladder, bool all) {
    Table table;
    table.add_words({"fidelity", "metric"});
    table.add_numbers({"value"});
    table.add_words({"reference"});
    for (const LadderReference& reference : ladder.references) {
        if (!all && std::ranges::count(ladder.judged, reference.row->name) == 0) continue;
        const std::string note = reference.kind == MetricKind::input ? " (an input: it has no error)" : "";
        table.rows.push_back({reference.fidelity, reference.row->title,
                              to_six_digits(reference.value, reference.row->unit), reference.how + note});
    }
    return table;
}

std::string ladder_markdown(const Ladder& ladder) {
    const Provenance& p = ladder.provenance;
    std::string text = fmt::format("# Error against run time: {}\n\n", markdown_text(ladder.scene.name));
    text += fmt::format("`{}`, SHA-256 {}. twinchute {} ({}), {}, {}, {} {}; {}.\n\n",
                        clean_text(ladder.scene.file), ladder.scene.sha256.substr(0, 12),
                        markdown_text(p.version), markdown_text(p.commit), markdown_text(p.compiler),
                        markdown_text(p.host_cpu), ladder.threads, ladder.threads == 1 ? "thread" : "threads",
                        markdown_text(p.date));
    text += "![Error against run time](ladder.svg)\n\n";
    text +=
        "*Error* is numerical: the relative distance from the reference of the same physics, the largest "
        "over "
        "the\njudged metrics. *Gap* is the distance from the reference of another model, *effect* that of a "
        "level without a\nphysics effect from the scene as it is on the same mesh: neither is an error of "
        "numbers. *Estimate* is the\ndifference from the next finer level, of the finest from the one before "
        "it. Time is wall time, the least of several\nruns where they are short. A star marks what no "
        "cheaper "
        "level of its model matches. ";
    text += seeds_text(ladder) + test_text(ladder) + "\n\n";
    text += markdown_table(levels_table(ladder)) + "\n";
    if (const std::string failures = failures_of(ladder, "- "); !failures.empty())
        text += "Not answered:\n\n" + failures + "\n";
    text += "## References\n\n" + markdown_table(references_table(ladder, true)) + "\n";
    text += "## Values\n\n" + markdown_table(values_table(ladder)) + "\n";
    return text + "## Which level\n\n" + markdown_text(advice(ladder)) + "\n";
}

std::string ladder_text(const Ladder& ladder, const Style& style) {
    std::string text = style.paint(printable(ladder.scene.name), Colour::bold) + "\n\n";
    text += terminal_table(levels_table(ladder), style) + "\n";
    text += printable(failures_of(ladder, "failed    "), Newlines::keep);
    text += terminal_table(references_table(ladder, false), style) + "\n";
    return text + printable(advice(ladder)) + "\n";
}

}  // namespace twinchute::compare
