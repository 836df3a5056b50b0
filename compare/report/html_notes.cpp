// What has to be known about the numbers: what was left out, warnings, inputs, and where they come from.
#include <fmt/format.h>

#include "compare/render/escape.hpp"
#include "compare/report/gap_tables.hpp"
#include "compare/report/html_parts.hpp"
#include "compare/report/page_files.hpp"
#include "lib/cli/record_text.hpp"

namespace twinchute::compare {
namespace {

/// One block a side, so that each says its own.
template <typename Item>
std::string by_side(const Comparison& comparison, Item&& items_of) {
    std::string text = "<div class=\"pair\">\n";
    for (const PageSide& side : page_sides(comparison)) {
        const std::string items = items_of(*side.record);
        text += fmt::format(
            "<div><h3>{}</h3>{}</div>\n", side_name(side),
            items.empty() ? "<p class=\"quiet\">nothing</p>" : "<ul class=\"plain\">\n" + items + "</ul>");
    }
    return text + "</div>\n";
}

std::string left_out_items(const RunRecord& record) {
    std::string text;
    for (const LeftOut& row : record.left_out)
        text += fmt::format(
            "<li>{}{}</li>\n", xml_text(row.what),
            row.why.empty() ? "" : fmt::format(" <span class=\"note\">{}</span>", xml_text(row.why)));
    return text;
}

std::string warning_items(const RunRecord& record) {
    std::string text;
    for (const Warning& row : record.warnings) {
        text += fmt::format("<li><strong>{}</strong>", xml_text(row.what));
        if (!row.why.empty()) text += fmt::format(" <span class=\"note\">{}</span>", xml_text(row.why));
        if (!row.suggestion.empty())
            text += fmt::format(" <span class=\"note\">What helps: {}</span>", xml_text(row.suggestion));
        text += "</li>\n";
    }
    return text;
}

bool any(const Comparison& comparison, auto RunRecord::*list) {
    return !(comparison.candidate.*list).empty() || !(comparison.reference.*list).empty();
}

std::string inputs(const RunRecord& record) {
    if (record.inputs.empty()) return {};
    return fmt::format(
        "<details><summary>All {} inputs</summary>\n{}</details>\n", record.inputs.size(),
        html_table(inputs_table(record), "Effective inputs in SI, with where each is from.", {}, "inputs"));
}

std::string provenance(const Comparison& comparison) {
    const RunRecord& record = comparison.reference;
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
    for (const PageSide& side : page_sides(comparison)) {
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

std::string notes_sections(const Comparison& comparison) {
    std::string text;
    if (any(comparison, &RunRecord::left_out))
        text +=
            "<section id=\"left-out\"><h2>Left out</h2>\n<p>Physics that the scene does not ask for, or a "
            "model does not "
            "have.</p>\n" +
            by_side(comparison, left_out_items) + "</section>\n";
    if (any(comparison, &RunRecord::warnings))
        text += "<section id=\"warnings\"><h2>Warnings</h2>\n" + by_side(comparison, warning_items) +
                "</section>\n";
    text += "<section id=\"provenance\"><h2>Provenance</h2>\n" + provenance(comparison) +
            inputs(comparison.reference);
    text += fmt::format(
        "<details><summary>Licences of what draws in this page</summary>\n<pre>{}</pre></details>\n",
        "\n" + std::string(page_file("NOTICE")));
    return text + "</section>\n";
}

}  // namespace twinchute::compare
