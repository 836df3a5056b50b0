#include "compare/report/junit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "compare/render/escape.hpp"
#include "compare/report/trend_text.hpp"
#include "compare/report/words.hpp"
#include "lib/record/metrics.hpp"

namespace twinchute::compare {
namespace {

struct Case {
    std::string name;
    double seconds = 0.0;
    std::string problem;  ///< "", "failure", "error" or "skipped"
    std::string type, message;
};

Case run_case(const RunRecord& record) {
    Case row{"run " + record.fidelity, record.cost.wall_s, {}, {}, {}};
    if (const ExitCode code = twinchute::exit_code(record.status.code); code != ExitCode::done) {
        row.problem = code == ExitCode::verdict ? "failure" : "error";
        row.type = status_name(record.status.code);
        row.message = record.status.detail.empty() ? row.type : record.status.detail;
    }
    return row;
}

/// Where there is nothing to judge a case says why it was skipped.
void skip(Case& row, bool has_tolerance) {
    row.problem = "skipped";
    row.message = has_tolerance ? "a run broke off" : "no tolerance asked for";
}

void skip_unreached(Case& row, const std::string& note) {
    row.problem = "skipped";
    row.message = note.empty() ? "not reached" : "not reached: " + note;
}

Case history_case(const HistoryGap& history) {
    Case row{std::string(history.row->name), 0.0, {}, {}, {}};
    if (history.verdict == Verdict::exceeded || history.verdict == Verdict::missing) {
        row.problem = "failure";
        row.type = verdict_name(history.verdict);
        row.message = failure_text(history);
    } else if (history.verdict == Verdict::not_judged) {
        skip(row, history.tolerance.has_value());
    }
    return row;
}

Case metric_case(const MetricGap& metric, const Comparison& comparison) {
    Case row{std::string(metric.row->name), 0.0, {}, {}, {}};
    if (metric.verdict == Verdict::exceeded || metric.verdict == Verdict::missing) {
        row.problem = "failure";
        row.type = verdict_name(metric.verdict);
        row.message = failure_text(metric, comparison);
    } else if (metric.verdict == Verdict::not_reached) {
        skip_unreached(row, metric.note);
    } else if (metric.verdict == Verdict::not_judged) {
        skip(row, metric.tolerance.has_value());
    }
    return row;
}

/// One for each metric that moved and is judged, and one for the baseline as a whole.
std::vector<Case> baseline_cases(const Trend& trend) {
    Case whole{"baseline", 0.0, {}, {}, {}};
    const Verdict verdict = overall_verdict(trend);
    if (verdict == Verdict::exceeded) whole.problem = "failure";
    if (verdict == Verdict::not_judged) whole.problem = "skipped";
    whole.type = verdict_name(verdict);
    whole.message = verdict_line(trend);
    std::vector<Case> cases{std::move(whole)};
    for (const MetricChange& change : trend.changes) {
        if (change.verdict == Verdict::not_judged) continue;
        Case row{fmt::format("baseline {} {}", change.fidelity, split_metric_key(change.key).name),
                 0.0,
                 {},
                 {},
                 {}};
        if (change.verdict == Verdict::not_reached) {
            skip_unreached(row, change.note);
        } else if (change.verdict != Verdict::within) {
            row.problem = "failure";
            row.type = verdict_name(change.verdict);
            row.message = failure_text(change);
        }
        cases.push_back(std::move(row));
    }
    return cases;
}

std::string case_xml(const Case& row, std::string_view class_name) {
    std::string text =
        fmt::format("    <testcase classname=\"{}\" name=\"{}\" time=\"{:.6f}\"", xml_text(class_name),
                    xml_text(row.name), std::isfinite(row.seconds) ? row.seconds : 0.0);
    if (row.problem.empty()) return text + "/>\n";
    const std::string message = xml_text(row.message);
    if (row.problem == "skipped")
        return text + fmt::format(">\n      <skipped message=\"{}\"/>\n    </testcase>\n", message);
    return text + fmt::format(">\n      <{0} type=\"{1}\" message=\"{2}\">{2}</{0}>\n    </testcase>\n",
                              row.problem, xml_text(row.type), message);
}

}  // namespace

std::string junit_xml(const Comparison& comparison, const Trend* trend) {
    std::vector<Case> cases{run_case(comparison.reference), run_case(comparison.candidate)};
    for (const MetricGap& metric : comparison.gap.metrics)
        cases.push_back(metric_case(metric, comparison));
    for (const HistoryGap& history : comparison.gap.histories)
        cases.push_back(history_case(history));
    if (trend != nullptr) std::ranges::move(baseline_cases(*trend), std::back_inserter(cases));
    int failures = 0, errors = 0, skipped = 0;
    double seconds = 0;
    // Dashboards take what stands before the last '.' for a package.
    std::string scene = comparison.reference.scene.name;
    std::ranges::replace(scene, '.', '_');
    const std::string class_name = "twinchute." + scene;
    std::string body;
    for (const Case& row : cases) {
        failures += row.problem == "failure";
        errors += row.problem == "error";
        skipped += row.problem == "skipped";
        if (std::isfinite(row.seconds)) seconds += row.seconds;
        body += case_xml(row, class_name);
    }
    // The schema's timestamp has no zone.
    std::string date = comparison.reference.provenance.date;
    if (date.ends_with('Z')) date.pop_back();
    const std::string counts =
        fmt::format("tests=\"{}\" failures=\"{}\" errors=\"{}\"", cases.size(), failures, errors);
    return fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<testsuites name=\"twinchute compare\" {0} time=\"{1:.6f}\">\n"
        "  <testsuite name=\"{2}\" {0} skipped=\"{5}\" time=\"{1:.6f}\" timestamp=\"{3}\">\n"
        "{4}  </testsuite>\n</testsuites>\n",
        counts, seconds, xml_text(class_name), xml_text(date), body, skipped);
}

}  // namespace twinchute::compare
