// A validation as terminal tables, CSV, JSON and Markdown.
#pragma once

#include <string>
#include <vector>

#include "compare/render/table.hpp"
#include "compare/validate/run_suite.hpp"

namespace twinchute::compare {

/// Rows for reading: of the lines of a table that were run for one case, the one that is nearest to its
/// limit, or farthest beyond it, stands for all.
struct ShownRow {
    const RowResult* row = nullptr;
    int lines = 0;   ///< of the table; 0: no table
    int within = 0;  ///< of them
};
std::vector<ShownRow> shown_rows(const SuiteResult& suite);

/// "12 of 14 judged rows verified; 3 not judged, 2 not run".
std::string suite_summary(const SuiteResult& suite);
/// "validate: 30 of 34 judged rows within; ...", all suites.
std::string validation_summary(const Validation& validation);

/// "bias 1.04, model 0.12, experiment 0.05 (5 points)".
std::string agreement_text(const GroupResult& group);

/// Whether exact answers are met, then which rows of other suites fall outside: a line or more.
std::string soundness_text(const Validation& validation, const Style& style);

std::string validation_terminal(const Validation& validation, const Style& style);
std::string validation_csv(const Validation& validation);
std::string validation_json(const Validation& validation, const Provenance& provenance);
/// `command`: what made it, for the reader who wants to repeat it. `plots`: names of the files of the groups'
/// plots.
std::string validation_markdown(const Validation& validation, const Provenance& provenance,
                                const std::string& command);

/// The file name of a group's plot: "scatter-measured-time-of-fall.svg".
std::string plot_name(const SuiteResult& suite, const GroupResult& group);

}  // namespace twinchute::compare
