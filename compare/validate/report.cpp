#include "compare/validate/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "compare/validate/report_words.hpp"
#include "lib/record/record_json.hpp"
#include "lib/scene/data_files.hpp"

namespace twinchute::compare {
namespace {

constexpr std::array verdicts{RowVerdict::not_judged, RowVerdict::fitted, RowVerdict::not_run,
                              RowVerdict::by_test};

/// How near a row is to its limit; beyond 1 it is exceeded. A row that gave nothing is worst of all.
double strain(const RowResult& row) {
    if (row.verdict == RowVerdict::exceeded && !(row.error() && row.tolerance))
        return std::numeric_limits<double>::infinity();
    const auto error = row.error();
    if (!error || !row.tolerance) return -1.0;
    return std::abs(*error) / *row.tolerance;
}

std::string suite_text(const SuiteResult& suite, const Style& style) {
    const std::vector<ShownRow> shown = shown_rows(suite);
    const Table table = suite_table(shown);
    std::string text = table.rows.empty() ? "" : terminal_table(table, style, 2);
    for (const ShownRow& one : shown) {
        const RowResult& row = *one.row;
        if (row.verdict == RowVerdict::exceeded && !row.why.empty())
            text += printable(fmt::format("  {}: {}", row_title(row), row.why)) + "\n";
        if (row.verdict == RowVerdict::not_run || row.verdict == RowVerdict::by_test)
            text += printable(
                        fmt::format("  {}: {}: {}", row_verdict_name(row.verdict), row_title(row), row.why)) +
                    "\n";
    }
    for (const std::string& calibration : suite.calibrations)
        text += printable(fmt::format("  {}", calibration)) + "\n";
    for (const std::string& offsets : suite.offsets)
        text += printable(fmt::format("  off by: {}", offsets)) + "\n";
    for (const GroupResult& group : suite.groups())
        text += fmt::format("  {}: {}\n", printable(group.name), agreement_text(group));
    return text;
}

nlohmann::ordered_json row_json(const RowResult& row) {
    nlohmann::ordered_json json{{"case", row.name}, {"quantity", row.quantity}, {"unit", row.unit}};
    if (!row.fidelity.empty()) json["fidelity"] = row.fidelity;
    if (row.line > 0) json["line"] = row.line;
    const auto put = [&](const char* key, const std::optional<double>& value) {
        if (value && std::isfinite(*value)) json[key] = *value;
    };
    put("expected", row.expected);
    put("predicted", row.predicted);
    put("low", row.low);
    put("high", row.high);
    put("error", row.error());
    put("relative_error", row.relative_error());
    put("tolerance", row.tolerance);
    put("sigma_measured", row.sigma_measured);
    put("sigma_inputs", row.sigma_inputs);
    json["verdict"] = row_verdict_name(row.verdict);
    for (const auto& [key, value] : {std::pair{"why", &row.why},
                                     {"where", &row.where},
                                     {"grade", &row.grade},
                                     {"source", &row.source},
                                     {"note", &row.note},
                                     {"group", &row.group}})
        if (!value->empty()) json[key] = *value;
    return json;
}

nlohmann::ordered_json group_json(const GroupResult& group) {
    nlohmann::ordered_json json{{"name", group.name}, {"points", group.rows.size()}};
    if (!group.agreement) return json;
    const Agreement& a = *group.agreement;
    json["mean_log"] = a.mean_log;
    json["bias"] = a.bias;
    json["sigma_model"] = a.sigma_model;
    json["sigma_experiment"] = a.sigma_experiment;
    json["sigma_experiment_capped"] = a.capped;
    return json;
}

}  // namespace

std::vector<ShownRow> shown_rows(const SuiteResult& suite) {
    std::vector<ShownRow> shown;
    for (const RowResult& row : suite.rows) {
        const auto same = std::ranges::find_if(shown, [&](const ShownRow& other) {
            const RowResult& o = *other.row;
            return row.line > 0 && o.line > 0 && o.name == row.name && o.fidelity == row.fidelity &&
                   o.quantity == row.quantity;
        });
        const int held = row.verdict == RowVerdict::within ? 1 : 0;
        if (same == shown.end()) {
            shown.push_back({&row, row.line > 0 ? 1 : 0, held});
            continue;
        }
        ++same->lines;
        same->within += held;
        if (strain(row) > strain(*same->row)) same->row = &row;
    }
    return shown;
}

std::string suite_summary(const SuiteResult& suite) {
    std::string text = fmt::format("{} of {} judged rows {}", suite.count(RowVerdict::within), suite.judged(),
                                   agreement_word(suite.evidence));
    std::string rest;
    for (const RowVerdict verdict : verdicts)
        if (const int count = suite.count(verdict); count > 0)
            rest += fmt::format("{}{} {}", rest.empty() ? "; " : ", ", count, row_verdict_name(verdict));
    return text + rest;
}

std::string validation_summary(const Validation& validation) {
    int within = 0, judged = 0;
    for (const SuiteResult& suite : validation.suites)
        within += suite.count(RowVerdict::within), judged += suite.judged();
    return fmt::format("{} of {} judged rows within{}", within, judged,
                       validation.interrupted ? ", interrupted" : "");
}

std::string agreement_text(const GroupResult& group) {
    if (!group.agreement)
        return fmt::format("{} {}, too few for bias and scatter", group.rows.size(),
                           group.rows.size() == 1 ? "point" : "points");
    const Agreement& a = *group.agreement;
    return fmt::format(
        "{} points, bias {:.2f}, relative standard deviation of the model {:.2f}, of the experiment {:.2f}{}",
        a.count, a.bias, a.sigma_model, a.sigma_experiment,
        a.capped ? " (more than the points scatter: taken as half their variance)" : "");
}

std::string soundness_text(const Validation& validation, const Style& style) {
    int within = 0, judged = 0;
    std::string outside;
    for (const SuiteResult& suite : validation.suites) {
        if (suite.evidence == Evidence::exact) {
            within += suite.count(RowVerdict::within), judged += suite.judged();
            continue;
        }
        std::vector<std::string> names;
        for (const RowResult& row : suite.rows)
            if (row.verdict == RowVerdict::exceeded &&
                std::ranges::find(names, row_title(row)) == names.end())
                names.push_back(row_title(row));
        if (names.empty()) continue;
        outside +=
            fmt::format("outside   {} ({}): {} of {} judged rows\n", suite.name,
                        evidence_name(suite.evidence), suite.count(RowVerdict::exceeded), suite.judged());
        for (const std::string& name : names)
            outside += fmt::format("          {}\n", printable(name));
    }
    std::string text;
    if (judged > 0)
        text = (within == judged ? style.paint("sound", Colour::green) + "     "
                                 : style.paint("NOT SOUND", Colour::red) + " ") +
               fmt::format("{} of {} rows with exact answers verified\n", within, judged);
    return text + outside;
}

std::string validation_terminal(const Validation& validation, const Style& style) {
    std::string text = soundness_text(validation, style);
    if (!text.empty()) text += "\n";
    for (const SuiteResult& suite : validation.suites)
        text += style.paint(printable(suite.title), Colour::bold) + "  (" + suite.name + ")\n" +
                suite_text(suite, style) + "  " + suite_summary(suite) + "\n\n";
    return text + validation_summary(validation) + "\n";
}

std::string validation_csv(const Validation& validation) {
    Table table;
    table.add_words({"suite", "case"}, "-");
    table.add_words({"line"}, "1");
    table.add_words({"fidelity", "quantity", "unit"}, "-");
    table.add_words(
        {"expected", "predicted", "low", "high", "error", "tolerance", "sigma_measured", "sigma_inputs"},
        "of the row");
    table.add_words({"verdict", "why", "where", "grade", "source", "note", "group"}, "-");
    for (const SuiteResult& suite : validation.suites)
        for (const RowResult& row : suite.rows)
            table.rows.push_back({suite.name,
                                  row.name,
                                  row.line > 0 ? fmt::format("{}", row.line) : "",
                                  row.fidelity,
                                  row.quantity,
                                  row.unit,
                                  exact(row.expected),
                                  exact(row.predicted),
                                  exact(row.low),
                                  exact(row.high),
                                  exact(row.error()),
                                  exact(row.tolerance),
                                  exact(row.sigma_measured),
                                  exact(row.sigma_inputs),
                                  row_verdict_name(row.verdict),
                                  row.why,
                                  row.where,
                                  row.grade,
                                  row.source,
                                  row.note,
                                  row.group});
    return csv_table(table);
}

std::string validation_json(const Validation& validation, const Provenance& provenance) {
    nlohmann::ordered_json json;
    json["generator"] = "twinchute";
    json["schema"] = 1;
    json["summary"] = validation_summary(validation);
    json["within"] = !validation.failed();
    json["decided_by"] = validation.exact_alone ? "exact" : "all";
    auto& suites = json["suites"] = nlohmann::ordered_json::array();
    for (const SuiteResult& suite : validation.suites) {
        nlohmann::ordered_json one{{"name", suite.name},
                                   {"title", suite.title},
                                   {"file", suite.file},
                                   {"evidence", evidence_name(suite.evidence)},
                                   {"summary", suite_summary(suite)},
                                   {"wall_s", suite.seconds}};
        auto& rows = one["rows"] = nlohmann::ordered_json::array();
        for (const RowResult& row : suite.rows)
            rows.push_back(row_json(row));
        auto& groups = one["groups"] = nlohmann::ordered_json::array();
        for (const GroupResult& group : suite.groups())
            groups.push_back(group_json(group));
        suites.push_back(std::move(one));
    }
    json["provenance"] = provenance_json(provenance);
    return json_text(json);
}

std::string plot_name(const SuiteResult& suite, const GroupResult& group) {
    return fmt::format("scatter-{}-{}.svg", suite.name, file_stem_of(group.name));
}

}  // namespace twinchute::compare
