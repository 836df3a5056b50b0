#include "compare/series.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "compare/render/escape.hpp"
#include "compare/render/table.hpp"
#include "lib/cli/record_text.hpp"
#include "lib/cli/text.hpp"
#include "lib/record/metrics.hpp"

namespace twinchute::compare {
namespace {

/// Metrics that a reader of a series looks for, behind the plot's own two.
constexpr std::array<std::string_view, 10> csv_metrics{
    "snatch_speed",       "mass_ratio",       "froude_number",    "filling_time",
    "time_to_peak_force", "peak_force",       "peak_force_ratio", "opening_shock_coefficient",
    "descent_rate",       "signed_area_ratio"};
constexpr std::array<std::string_view, 4> brief_metrics{"snatch_speed", "filling_time", "peak_force",
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

/// Reference less candidate, as everywhere for reading; the CSV file has it the other way round, as gap.json.
std::string gap_text(const std::optional<double>& share) {
    return share ? fmt::format("{:+.1f} %", -100.0 * *share) : "-";
}

/// Numbers of both fidelities for reading.
Table brief_table(const CaseSeries& series) {
    const std::vector<const MetricRow*> columns = columns_of(series, brief_metrics);
    Table table;
    table.add_words({"case", "group", "status"});
    const auto both = [&](const std::optional<double>& candidate, const std::optional<double>& reference) {
        const auto cell = [](const std::optional<double>& v) { return v ? readable(*v) : std::string("-"); };
        const std::string a = cell(candidate), b = cell(reference);
        return a == b ? a : a + " / " + b;
    };
    for (const MetricRow* column : columns)
        table.add_numbers({column->title}, column->unit);
    table.add_numbers({"gap in peak force", "energy left over"});
    table.add_numbers({"wall"}, "s");
    for (const SeriesCase& one : series.cases) {
        const SeriesSide &a = one.candidate, &b = one.reference;
        std::vector<Cell>& row = table.rows.emplace_back();
        row = {one.name, one.group,
               a.row.status == b.row.status ? a.row.status : a.row.status + " / " + b.row.status};
        for (const MetricRow* column : columns)
            row.emplace_back(both(a.value_of(*column), b.value_of(*column)));
        row.emplace_back(gap_text(one.gap));
        row.emplace_back(b.energy_residual ? fmt::format("{:.1e}", *b.energy_residual) : "-");
        row.emplace_back(both(a.row.wall_s, b.row.wall_s));
    }
    return table;
}

/// "rom / full": whose numbers stand in a cell of two.
std::string sides_of(const CaseSeries& series) {
    if (series.cases.empty()) return "rom / full";
    return series.cases.front().candidate.row.fidelity + " / " + series.cases.front().reference.row.fidelity;
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
    const std::vector<const MetricRow*> columns = columns_of(series, csv_metrics);
    Table table;
    table.add_words({"case", "group"}, "-");
    if (!series.cases.empty()) {
        for (const SeriesSide* side : {&series.cases.front().reference, &series.cases.front().candidate}) {
            const std::string& fidelity = side->row.fidelity;
            table.add_words({fidelity + ".status"}, "-");
            for (const MetricRow* column : columns)
                table.add_words({fmt::format("{}.{}", fidelity, column->name)},
                                column->unit.empty() ? "1" : column->unit);
            table.add_words({fidelity + ".energy_residual"}, "1");
            table.add_words({fidelity + ".wall"}, "s");
        }
        table.add_words({"peak_force_gap"}, "1");
    }
    for (const SeriesCase& one : series.cases) {
        std::vector<Cell>& cells = table.rows.emplace_back();
        cells = {one.name, one.group};
        for (const SeriesSide* side : {&one.reference, &one.candidate}) {
            cells.emplace_back(side->row.status);
            for (const MetricRow* column : columns)
                cells.emplace_back(exact(side->value_of(*column)));
            cells.emplace_back(exact(side->energy_residual));
            cells.emplace_back(exact(side->row.wall_s));
        }
        cells.emplace_back(exact(one.gap));
    }
    return csv_table(table);
}

std::string series_markdown(const CaseSeries& series) {
    return fmt::format("# {}\n\n{} cases at both fidelities, {:.3g} s.\n\n![{} against {}](series.svg)\n\n",
                       markdown_text(series.title), series.cases.size(), series.wall_s,
                       find_metric_row(series.spec.y)->title, find_metric_row(series.spec.x)->title) +
           markdown_table(brief_table(series)) +
           fmt::format("\nWhere two numbers stand: {}. All metrics: series.csv.\n", sides_of(series));
}

std::string series_terminal(const CaseSeries& series, const Style& style) {
    Table table = brief_table(series);
    table.columns.insert(table.columns.begin() + 2, {"verdict"});
    for (std::size_t i = 0; i < table.rows.size(); ++i)
        table.rows[i].insert(table.rows[i].begin() + 2, series.cases[i].verdict);
    return terminal_table(table, style) + fmt::format("where two numbers stand: {}\n", sides_of(series));
}

void add_series(FileBatch& batch, const CaseSeries& series, const std::filesystem::path& directory) {
    batch.add(directory / "series.csv", series_csv(series));
    batch.add(directory / "series.svg", series_svg(series));
    batch.add(directory / "series.md", series_markdown(series), FileBatch::Kind::marker);
}

}  // namespace twinchute::compare
