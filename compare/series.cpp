#include "compare/series.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "compare/metrics.hpp"
#include "compare/report/escape.hpp"
#include "lib/cli/record_text.hpp"
#include "lib/cli/text.hpp"
#include "lib/record/record_csv.hpp"

namespace twinchute::compare {
namespace {

/// What a reader of a series looks for, behind the plot's own two.
constexpr std::array<std::string_view, 10> told{
    "snatch_speed",       "mass_ratio",       "froude_number",    "filling_time",
    "time_to_peak_force", "peak_force",       "peak_force_ratio", "opening_shock_coefficient",
    "descent_rate",       "signed_area_ratio"};
constexpr std::array<std::string_view, 4> brief{"snatch_speed", "filling_time", "peak_force",
                                                "signed_area_ratio"};

template <class Names>
std::vector<const MetricRow*> columns_of(const CaseSeries& series, const Names& more) {
    std::vector<const MetricRow*> columns;
    const auto add = [&](std::string_view name) {
        const MetricRow* row = find_metric_row(name);
        if (row != nullptr && std::ranges::find(columns, row) == columns.end()) columns.push_back(row);
    };
    add(series.spec.x);
    add(series.spec.y);
    for (const std::string_view name : more)
        add(name);
    return columns;
}

SeriesSide side_of(const RunRecord& record) {
    SeriesSide side{record_row(record, ""), {}};
    if (record.energy) side.energy_residual = record.energy->residual_fraction;
    return side;
}

std::string field(const std::optional<double>& value) {
    return value && std::isfinite(*value) ? fmt::format("{}", *value) : std::string();
}

std::string per_cent(const std::optional<double>& share) {
    return share ? fmt::format("{:+.1f} %", 100.0 * *share) : "-";
}

/// A table of Markdown, cells as they are.
std::string markdown_table(const std::vector<std::string>& header,
                           const std::vector<std::vector<std::string>>& rows, std::size_t words) {
    std::string text = "|", rule = "|";
    for (std::size_t i = 0; i < header.size(); ++i) {
        text += " " + header[i] + " |";
        rule += i < words ? " --- |" : " ---: |";
    }
    text += "\n" + rule + "\n";
    for (const auto& row : rows) {
        text += "|";
        for (const std::string& cell : row)
            text += " " + cell + " |";
        text += "\n";
    }
    return text;
}

/// Names and groups as they are, numbers of both fidelities for reading.
Table brief_table(const CaseSeries& series) {
    const std::vector<const MetricRow*> columns = columns_of(series, brief);
    Table table;
    table.header = {"case", "group", "status"};
    table.right = {false, false, false};
    const auto both = [&](const std::optional<double>& candidate, const std::optional<double>& reference) {
        const auto cell = [](const std::optional<double>& v) { return v ? readable(*v) : std::string("-"); };
        const std::string a = cell(candidate), b = cell(reference);
        return a == b ? a : a + " / " + b;
    };
    for (const MetricRow* column : columns)
        table.header.push_back(fmt::format("{}{}", column->title,
                                           column->unit.empty() ? "" : fmt::format(" [{}]", column->unit)));
    for (const char* more : {"gap in peak force", "energy left over", "wall [s]"})
        table.header.emplace_back(more);
    table.right.resize(table.header.size(), true);
    for (const SeriesCase& one : series.cases) {
        const SeriesSide &a = one.candidate, &b = one.reference;
        std::vector<std::string> row{
            one.name, one.group,
            a.row.status == b.row.status ? a.row.status : a.row.status + " / " + b.row.status};
        for (const MetricRow* column : columns)
            row.push_back(both(a.value_of(*column), b.value_of(*column)));
        row.push_back(per_cent(one.gap));
        row.push_back(b.energy_residual ? fmt::format("{:.1e}", *b.energy_residual) : "-");
        row.push_back(both(a.row.wall_s, b.row.wall_s));
        table.rows.push_back(std::move(row));
    }
    return table;
}

}  // namespace

std::optional<double> SeriesSide::value_of(const MetricRow& metric) const {
    const auto found = std::ranges::find(row.metrics, metric.key, &std::pair<std::string, double>::first);
    return found == row.metrics.end() ? std::nullopt : std::optional(found->second);
}

SeriesCase series_case(const Scene& scene, const Comparison& comparison) {
    SeriesCase one;
    one.name = scene.case_name;
    if (scene.series) one.group = scene.series->group;
    one.reference = side_of(comparison.reference);
    one.candidate = side_of(comparison.candidate);
    for (const MetricGap& gap : comparison.gap.metrics)
        if (gap.row->name == "peak_force") {
            one.gap = gap.relative;
        }
    one.verdict = verdict_name(overall_verdict(comparison.gap));
    return one;
}

std::string series_csv(const CaseSeries& series) {
    const std::vector<const MetricRow*> columns = columns_of(series, told);
    std::string names = "case,group", units = "-,-";
    const auto head = [&](const std::string& name, std::string_view unit) {
        names += "," + name;
        units += fmt::format(",{}", unit.empty() ? "1" : unit);
    };
    if (series.cases.empty()) return names + "\n" + units + "\n";
    const std::array<const SeriesSide*, 2> first{&series.cases.front().reference,
                                                 &series.cases.front().candidate};
    for (const SeriesSide* side : first) {
        const std::string& fidelity = side->row.fidelity;
        head(fidelity + ".status", "-");
        for (const MetricRow* column : columns)
            head(fmt::format("{}.{}", fidelity, column->name), column->unit);
        head(fidelity + ".energy_residual", "1");
        head(fidelity + ".wall", "s");
    }
    head("peak_force_gap", "1");
    std::string text = names + "\n" + units + "\n";
    for (const SeriesCase& one : series.cases) {
        text += csv_field(one.name) + "," + csv_field(one.group);
        for (const SeriesSide* side : {&one.reference, &one.candidate}) {
            text += "," + csv_field(side->row.status);
            for (const MetricRow* column : columns)
                text += "," + field(side->value_of(*column));
            text += "," + field(side->energy_residual) + "," + field(side->row.wall_s);
        }
        text += "," + field(one.gap) + "\n";
    }
    return text;
}

std::string series_markdown(const CaseSeries& series) {
    std::string text =
        fmt::format("# {}\n\n{} cases at both fidelities, {:.3g} s.\n\n![{} against {}](series.svg)\n\n",
                    markdown_text(series.title), series.cases.size(), series.wall_s,
                    find_metric_row(series.spec.y)->title, find_metric_row(series.spec.x)->title);
    Table table = brief_table(series);
    for (auto& row : table.rows)
        for (std::size_t i = 0; i < 2; ++i)
            row[i] = markdown_text(row[i]);
    text += markdown_table(table.header, table.rows, 3);
    const std::string& candidate = series.cases.empty() ? "rom" : series.cases.front().candidate.row.fidelity;
    const std::string& reference =
        series.cases.empty() ? "full" : series.cases.front().reference.row.fidelity;
    return text + fmt::format("\nWhere two numbers stand: {} / {}. All metrics: series.csv.\n", candidate,
                              reference);
}

std::string series_terminal(const CaseSeries& series, const Style& style) {
    Table table = brief_table(series);
    table.header.insert(table.header.begin() + 2, "verdict");
    table.right.insert(table.right.begin() + 2, false);
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
        std::vector<std::string>& row = table.rows[i];
        row.insert(row.begin() + 2, series.cases[i].verdict);
        for (std::string& cell : row)
            cell = printable(cell);
    }
    return aligned(table, style) +
           fmt::format("where two numbers stand: {} / {}\n",
                       series.cases.empty() ? "" : series.cases.front().candidate.row.fidelity,
                       series.cases.empty() ? "" : series.cases.front().reference.row.fidelity);
}

void add_series(FileBatch& batch, const CaseSeries& series, const std::filesystem::path& directory) {
    batch.add(directory / "series.csv", series_csv(series));
    batch.add(directory / "series.svg", series_svg(series));
    batch.add(directory / "series.md", series_markdown(series), FileBatch::Kind::marker);
}

}  // namespace twinchute::compare
