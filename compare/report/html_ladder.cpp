// Error against run time: the ladder of the same scene, where it was run.
#include <fmt/format.h>

#include "compare/render/escape.hpp"
#include "compare/report/html_parts.hpp"
#include "compare/report/ladder_files.hpp"
#include "lib/cli/record_text.hpp"

namespace twinchute::compare {
namespace {

Table advice_table(const Ladder& ladder) {
    Table table;
    table.add_words({"error"});
    for (const std::string_view fidelity : ladder.fidelities)
        table.add_words({fidelity});
    for (const auto& [wanted, word] : wanted_accuracies) {
        std::vector<Cell>& row = table.rows.emplace_back();
        row.emplace_back(fmt::format("up to {}", word));
        for (const std::string_view fidelity : ladder.fidelities) {
            const LevelResult* level = cheapest(ladder, fidelity, wanted);
            row.emplace_back(level == nullptr
                                 ? "none"
                                 : fmt::format("{}: {}", level->level.name, time_text(level->wall_s)));
        }
    }
    return table;
}

std::string gap_words(const Ladder& ladder) {
    if (!ladder.gap) return {};
    return fmt::format(
        "<p>The gap between {} and {}, each at its best, is {:.2g} % ({}), the dashed line: errors far below "
        "it "
        "buy nothing.</p>\n",
        xml_text(ladder.fidelities[0]), xml_text(ladder.fidelities[1]), 100 * ladder.gap->value,
        xml_text(find_metric_row(ladder.gap->metric)->title));
}

/// Times belong to the machine that they were taken on.
std::string made_by(const Ladder& ladder) {
    const Provenance& made = ladder.provenance;
    return fmt::format("{} levels{}, {}: twinchute {} ({}), {}, {} {}.", ladder.levels.size(),
                       ladder.quick ? ", without those dearer than four runs of the scene as it is" : "",
                       xml_text(made.date), xml_text(made.version), xml_text(made.commit),
                       xml_text(made.host_cpu), ladder.threads, ladder.threads == 1 ? "thread" : "threads");
}

}  // namespace

std::string ladder_section(const LadderBeside& beside) {
    if (!beside.ladder && beside.why_not.empty()) return {};
    std::string text = "<section id=\"ladder\"><h2>Error against run time</h2>\n";
    if (!beside.ladder)
        return text + fmt::format(
                          "<p class=\"alert\">A ladder lies beside this comparison and is not shown: {}. Run "
                          "<code>twinchute ladder</code> on this scene again, then <code>twinchute "
                          "report</code>.</p>\n"
                          "</section>\n",
                          xml_text(beside.why_not));
    const Ladder& ladder = *beside.ladder;
    text += html_table(advice_table(ladder),
                       "<strong>Which level to use</strong>, the cheapest for a wanted accuracy:", {},
                       "ladder-advice");
    text += gap_words(ladder);
    text +=
        "<p>Filled markers are errors of numbers: the largest relative distance, over the judged metrics, "
        "from the "
        "reference of the same physics. Hollow ones are distances to other physics, and no errors.</p>\n";
    text += fmt::format(
        "<figure class=\"still ladder\">\n<div class=\"scroll\" tabindex=\"0\" role=\"region\" "
        "aria-label=\"Plot of "
        "error against run time\">{}</div><figcaption>{}</figcaption></figure>\n",
        ladder_svg(ladder), made_by(ladder));
    text += "<details><summary>All levels, and what they are held against</summary>\n";
    text += html_table(levels_table(ladder),
                       "<strong>Levels.</strong> <em>Estimate</em>: difference from the next finer level. "
                       "<em>Effect</em>: what leaving a physics effect out changes. A star: no cheaper level "
                       "of its model is "
                       "as good.",
                       {}, "ladder-levels");
    text += html_table(references_table(ladder, false), "<strong>References</strong> of the judged metrics.",
                       {}, "ladder-references");
    return text + "</details>\n</section>\n";
}

}  // namespace twinchute::compare
