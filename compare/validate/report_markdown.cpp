// The report that is published as docs/generated/validation.md.
#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "compare/render/escape.hpp"
#include "compare/validate/report.hpp"
#include "compare/validate/report_words.hpp"

namespace twinchute::compare {
namespace {

constexpr std::string_view how_to_read = R"(How to read it:

- **expected** is what the source says, ± its standard uncertainty where it is a measurement that states one.
- **predicted** is what the model gives. In brackets: its range over seeds, or between both ends of a bracketed input.
  ± is its standard deviation where uncertain inputs were sampled (fixed seeds).
- **tolerance** is what the row asks for. Where inputs were sampled it is two standard uncertainties of measurement and inputs together;
  where an input is bracketed it is one standard uncertainty of the measurement beyond both ends.
- **within** is the verdict. Of a table with many lines the worst one is shown, and how many are within. Rows of grade D or R, and those
  said to be so, are shown and not judged. A *fitted* row was used to adjust an input: it says nothing, the rows beside it do.
- **grade** of the source: C computed from the governing equations, S stated in the paper, P primary, A and B measured or transcribed as
  the suite says, D a counter-example.
- "verified" is said of exact answers, "reproduced" of what a paper prints, "validated" of test data alone.

)";

std::string list(std::string_view heading, const std::vector<std::string>& items) {
    std::string text;
    for (const std::string& item : items)
        text += "- " + markdown_text(item) + "\n";
    return text.empty() ? text : fmt::format("{}:\n\n{}\n", heading, text);
}

/// Remarks beside numbers, each sentence once with the cases that it is said of.
std::string notes(const std::vector<ShownRow>& shown) {
    std::vector<std::pair<std::string, std::vector<std::string>>> said;
    for (const ShownRow& one : shown) {
        const RowResult& row = *one.row;
        const bool ran = row.verdict != RowVerdict::not_run && row.verdict != RowVerdict::by_test;
        std::string words = row.note;
        if (!row.why.empty() && row.verdict != RowVerdict::fitted)
            words += (words.empty() ? "" : "; ") + row.why;
        if (!ran || words.empty()) continue;
        const std::string who = row_title(row) + (row.verdict == RowVerdict::exceeded ? " (not within)" : "");
        auto place = std::ranges::find(said, words, [](const auto& entry) { return entry.first; });
        if (place == said.end()) place = said.insert(said.end(), {words, {}});
        if (std::ranges::find(place->second, who) == place->second.end()) place->second.push_back(who);
    }
    std::string text;
    for (const auto& [words, who] : said)
        text += fmt::format("- {}: {}\n", markdown_text(fmt::format("{}", fmt::join(who, "; "))),
                            markdown_text(words));
    return text.empty() ? "" : "Notes:\n\n" + text + "\n";
}

std::string left_out(const SuiteResult& suite, RowVerdict verdict, const char* heading) {
    std::string text;
    for (const RowResult& row : suite.rows)
        if (row.verdict == verdict)
            text += fmt::format("- {}: {}\n", markdown_text(row_title(row)), markdown_text(row.why));
    return text.empty() ? "" : fmt::format("{}:\n\n{}\n", heading, text);
}

std::string sources(const SuiteResult& suite) {
    std::vector<std::string> order;
    for (const RowResult& row : suite.rows)
        if (!row.source.empty() && std::ranges::find(order, row.source) == order.end())
            order.push_back(row.source);
    std::string text;
    for (const std::string& source : order) {
        std::vector<std::string> names;
        for (const RowResult& row : suite.rows)
            if (row.source == source && std::ranges::find(names, row.name) == names.end())
                names.push_back(row.name);
        text += fmt::format("- {}: {}\n", markdown_text(fmt::format("{}", fmt::join(names, "; "))),
                            markdown_text(source));
    }
    return text.empty() ? "" : "Sources:\n\n" + text + "\n";
}

std::string group_text(const SuiteResult& suite) {
    std::string text;
    for (const GroupResult& group : suite.groups()) {
        text += fmt::format("- {}: {}\n", markdown_text(group.name), agreement_text(group));
    }
    for (const GroupResult& group : suite.groups())
        if (group.agreement)
            text += fmt::format("\n![{}]({})\n", markdown_text(group.name), plot_name(suite, group));
    if (text.empty()) return {};
    return "Bias and scatter, from the logarithms of predicted over measured, sigma_M^2 = s^2 - sigma_E^2 "
           "and bias = exp(mean + "
           "sigma_M^2/2 - sigma_E^2/2)\n(FDS Validation Guide, \"Calculating Model Uncertainty\"; McGrattan "
           "and Toman, Metrologia "
           "48, 2011, 173-180); rows of grade D are left out:\n\n" +
           text + "\n";
}

}  // namespace

std::string validation_markdown(const Validation& validation, const Provenance& provenance,
                                const std::string& command) {
    std::string text = "# Validation\n\n" + validation_summary(validation) + ".\n\n";
    text += fmt::format("Made by `{}`: twinchute {}, commit {}, {}, {}, {}.\n\n", command, provenance.version,
                        provenance.commit, markdown_text(provenance.compiler),
                        markdown_text(provenance.host_cpu), provenance.date);
    Table suites;
    suites.add_words({"suite", "expected values are", ""});
    for (const SuiteResult& suite : validation.suites)
        suites.rows.push_back({suite.title, evidence_name(suite.evidence), suite_summary(suite)});
    text += markdown_table(suites) + "\n";
    text += how_to_read;
    for (const SuiteResult& suite : validation.suites) {
        const std::vector<ShownRow> shown = shown_rows(suite);
        text += fmt::format("## {}\n\n", markdown_text(suite.title));
        if (!suite.about.empty()) text += markdown_text(suite.about) + "\n\n";
        text += suite_summary(suite) + ".\n\n";
        if (const Table table = suite_table(shown); !table.rows.empty()) text += markdown_table(table) + "\n";
        text += group_text(suite);
        text += list("Calibrated to other drops", suite.calibrations);
        text += list("Predicted less expected, together", suite.offsets) + list("Cases", suite.remarks);
        text += notes(shown) + left_out(suite, RowVerdict::not_run, "Not run") +
                left_out(suite, RowVerdict::by_test, "Shown by tests alone") + sources(suite);
    }
    return text;
}

}  // namespace twinchute::compare
