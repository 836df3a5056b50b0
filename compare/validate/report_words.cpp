#include "compare/validate/report_words.hpp"

#include <fmt/format.h>

#include <cmath>

namespace twinchute::compare {
namespace {

/// Four digits, more where the tolerance is a smaller share of the value than they show.
int digits_of(const RowResult& row) {
    constexpr int usual = 4, most = 9;
    if (!row.tolerance || !row.expected || !(*row.tolerance > 0.0) || *row.expected == 0.0) return usual;
    const double digits = std::ceil(std::log10(std::abs(*row.expected) / *row.tolerance)) + 2.0;
    return digits > usual ? static_cast<int>(std::min<double>(digits, most)) : usual;
}

std::string number(const std::optional<double>& value, int digits) {
    return value ? readable(*value, digits) : "-";
}

}  // namespace

std::string row_title(const RowResult& row) {
    return row.quantity.empty() ? row.name : row.name + ", " + row.quantity;
}

std::string expected_text(const RowResult& row) {
    if (!row.expected) return "-";
    const std::string text = number(row.expected, digits_of(row));
    return row.sigma_measured.value_or(0.0) > 0.0
               ? fmt::format("{} ± {}", text, readable(*row.sigma_measured, 2))
               : text;
}

std::string predicted_text(const RowResult& row) {
    if (!row.predicted) return "-";
    const int digits = digits_of(row);
    std::string text = number(row.predicted, digits);
    if (row.low && row.high && *row.low != *row.high)
        text += fmt::format(" [{}, {}]", readable(*row.low, digits), readable(*row.high, digits));
    if (row.sigma_inputs) text += fmt::format(" ± {}", readable(*row.sigma_inputs, 2));
    return text;
}

std::string error_text(const RowResult& row) {
    const auto error = row.error(), relative = row.relative_error();
    if (!error || row.verdict == RowVerdict::fitted) return "-";
    if (!relative) return fmt::format("{:+.2g}", *error);
    const double share = 100.0 * *relative;
    return std::abs(share) >= 0.1 ? fmt::format("{:+.1f} %", share) : fmt::format("{:+.1g} %", share);
}

std::string tolerance_text(const RowResult& row) {
    if (!row.tolerance || !row.expected || row.verdict == RowVerdict::fitted) return "-";
    if (*row.expected == 0.0) return readable(*row.tolerance, 2);
    const double share = 100.0 * *row.tolerance / std::abs(*row.expected);
    return share >= 0.1 ? fmt::format("{:.1f} %", share) : fmt::format("{:.1g} %", share);
}

std::string verdict_text(const ShownRow& shown) {
    if (shown.lines > 1) return fmt::format("{} of {}", shown.within, shown.lines);
    switch (shown.row->verdict) {
        case RowVerdict::within:
            return "yes";
        case RowVerdict::exceeded:
            return "NO";
        case RowVerdict::fitted:
            return "fitted: " + shown.row->why;
        default:
            return std::string(row_verdict_name(shown.row->verdict));
    }
}

std::string quantity_text(const ShownRow& shown) {
    const RowResult& row = *shown.row;
    std::string text = row.quantity;
    if (!row.unit.empty()) text += fmt::format(" [{}]", row.unit);
    if (shown.lines > 1) text += fmt::format(", worst of {} lines: {}", shown.lines, row.line);
    return text;
}

Table suite_table(const std::vector<ShownRow>& shown) {
    Table table;
    table.add_words({"case", "where", "model", "quantity"});
    table.add_numbers({"expected", "predicted", "error", "tolerance"});
    table.add_words({"grade", "within"});
    for (const ShownRow& one : shown) {
        const RowResult& row = *one.row;
        if (row.verdict == RowVerdict::not_run || row.verdict == RowVerdict::by_test) continue;
        const Tone tone = row.verdict == RowVerdict::exceeded ? Tone::bad
                          : row.verdict == RowVerdict::within ? Tone::good
                                                              : Tone::caution;
        table.rows.push_back({row.name,
                              row.where,
                              row.fidelity,
                              quantity_text(one),
                              expected_text(row),
                              predicted_text(row),
                              error_text(row),
                              tolerance_text(row),
                              row.grade,
                              {verdict_text(one), tone}});
    }
    return table;
}

}  // namespace twinchute::compare
