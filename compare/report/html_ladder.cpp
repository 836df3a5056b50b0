// Error against run time: the ladder of the same scene, where it was run.
#include <fmt/format.h>

#include "compare/report/escape.hpp"
#include "compare/report/html_parts.hpp"
#include "compare/report/ladder_files.hpp"
#include "lib/cli/record_text.hpp"

namespace twinchute::compare {
namespace {

std::string alignment_of(const LadderTable& table) {
    std::string letters;
    for (const bool right : table.right)
        letters += right ? 'r' : 'l';
    return letters;
}

std::string cell(const std::string& text, bool number) {
    return fmt::format("<td{}>{}</td>", number ? " class=\"number\"" : "",
                       text == "-" ? "\u2013" : xml_text(text));
}

std::string table_html(const LadderTable& table, const std::string& name, const std::string& caption) {
    std::string text = fmt::format(
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" "
        "aria-label=\"{}\">\n<table><caption>{}</caption>\n",
        name, caption);
    text += table_head(table.header, alignment_of(table)) + "<tbody>\n";
    for (const std::vector<std::string>& row : table.rows) {
        text += fmt::format("<tr><th scope=\"row\">{}</th>", xml_text(row.front()));
        for (std::size_t i = 1; i < row.size(); ++i)
            text += cell(row[i], table.right[i]);
        text += "</tr>\n";
    }
    return text + "</tbody></table></div>\n";
}

LadderTable advice_table(const Ladder& ladder) {
    LadderTable table{{"error"}, {false}, {}};
    for (const std::string_view fidelity : ladder.fidelities) {
        table.header.emplace_back(fidelity);
        table.right.push_back(false);
    }
    for (const auto& [wanted, word] : wanted_accuracies) {
        std::vector<std::string> row{fmt::format("up to {}", word)};
        for (const std::string_view fidelity : ladder.fidelities) {
            const RungResult* rung = cheapest(ladder, fidelity, wanted);
            row.push_back(rung == nullptr ? "no rung"
                                          : fmt::format("{}: {}", rung->rung.name, time_text(rung->wall_s)));
        }
        table.rows.push_back(std::move(row));
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
    return fmt::format("{} rungs{}, {}: twinchute {} ({}), {}, {} {}.", ladder.rungs.size(),
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
    text += table_html(advice_table(ladder), "Which rung",
                       "<strong>Which rung to use</strong>, the cheapest for a wanted accuracy:");
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
    text += "<details><summary>All rungs, and what they are held against</summary>\n";
    text += table_html(
        rungs_table(ladder), "Rungs",
        "<strong>Rungs.</strong> <em>Estimate</em>: difference from the next finer rung. "
        "<em>Effect</em>: what leaving a piece out changes. A star: no cheaper rung of its model is as "
        "good.");
    text += table_html(references_table(ladder, false), "References",
                       "<strong>References</strong> of the judged metrics.");
    return text + "</details>\n</section>\n";
}

}  // namespace twinchute::compare
