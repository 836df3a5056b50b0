// Background of the numbers: what was left out, warnings, inputs, and where they come from.
#include <fmt/format.h>

#include "compare/render/escape.hpp"
#include "compare/report/gap_tables.hpp"
#include "compare/report/html_parts.hpp"
#include "compare/report/page_files.hpp"
#include "lib/cli/record_text.hpp"

namespace twinchute::compare {
namespace {

std::string section(std::string_view id, std::string_view title, const Table& table,
                    std::string_view caption) {
    if (table.rows.empty()) return {};
    return fmt::format("<section id=\"{}\"><h2>{}</h2>\n{}</section>\n", id, title,
                       html_table(table, caption, {}, id));
}

std::string inputs(const RunRecord& record) {
    if (record.inputs.empty()) return {};
    return fmt::format(
        "<details><summary>All {} inputs</summary>\n{}</details>\n", record.inputs.size(),
        html_table(inputs_table(record), "Effective inputs in SI, with where each is from.", {}, "inputs"));
}

std::string provenance(const PageSides& sides) {
    const RunRecord& record = *sides.back().record;
    const Provenance& made = record.provenance;
    std::string text = "<dl class=\"facts\">\n";
    const auto fact = [&](std::string_view name, const std::string& value) {
        text += fmt::format("<dt>{}</dt><dd>{}</dd>\n", name, xml_text(value));
    };
    fact("Scene file", record.scene.file);
    text += fmt::format("<dt>SHA-256</dt><dd><code>{}</code></dd>\n", xml_text(record.scene.sha256));
    fact("Program", fmt::format("twinchute {}, commit {}", made.version, made.commit));
    fact("Made", made.date);
    fact("Compiler", fmt::format("{}, {}", made.compiler, made.flags));
    fact("Machine", fmt::format("{}, {}", made.host_cpu, made.instruction_set));
    for (const PageSide& side : sides) {
        const Cost& cost = side.record->cost;
        std::string blocks;
        for (const BlockCost& block : cost.blocks)
            blocks +=
                fmt::format("<li>{}: {}</li>\n", xml_text(block.name), xml_text(time_text(block.seconds)));
        text += fmt::format("<dt>Run of {}</dt><dd>{}, threads: {}{}</dd>\n", side_name(side),
                            xml_text(cost_text(cost)), side.record->provenance.threads,
                            blocks.empty() ? "" : "<ul class=\"plain\">\n" + blocks + "</ul>");
    }
    return text + "</dl>\n";
}

}  // namespace

std::string calibration_section(const Comparison& comparison) {
    return section(
        "calibration", "Before and after calibration", calibration_table(comparison),
        "What the calibration of the candidate does to the gap, in metrics that have a tolerance.");
}

std::string notes_sections(const PageSides& sides) {
    const bool compares = sides.size() > 1;
    std::string text =
        section(
            "filling", "Predicted filling", filling_table(sides),
            compares
                ? "Initial mouth, entrance loss and fabric are shared inputs; shape, volume and mouth are "
                  "each model's own."
                : "How far the filling hangs on the initial mouth.") +
        section("left-out", "Left out", left_out_table(sides),
                compares ? "Physics that the scene does not ask for, or a model does not have."
                         : "Physics that the scene does not ask for, or the model does not have.") +
        section("warnings", "Warnings", warnings_table(sides),
                compares ? "Warnings of both runs." : "Warnings of the run.");
    text +=
        "<section id=\"provenance\"><h2>Provenance</h2>\n" + provenance(sides) + inputs(*sides.back().record);
    text += fmt::format(
        "<details><summary>Licences of what draws in this page</summary>\n<pre>{}</pre></details>\n",
        "\n" + std::string(page_file("NOTICE")));
    return text + "</section>\n";
}

}  // namespace twinchute::compare
