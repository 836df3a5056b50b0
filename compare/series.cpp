#include "compare/series.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "compare/render/escape.hpp"
#include "compare/render/table.hpp"
#include "compare/report/still_page.hpp"
#include "lib/cli/record_text.hpp"
#include "lib/cli/text.hpp"
#include "lib/record/display_units.hpp"
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
/// Columns of a series of one fidelity: there is space for more.
constexpr std::array<std::string_view, 7> metrics_alone{
    "snatch_speed", "filling_time",           "peak_force", "load_factor",
    "descent_rate", "landing_vertical_speed", "flight_time"};

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
    const auto over_time = [&record](std::string_view channel) {
        Curve curve = curve_of(record, channel).value_or(Curve{});
        for (double& time : curve.time)
            time -= snatch_of(record);
        return curve;
    };
    SeriesSide side{record_row(record, ""), {}, over_time("force"), over_time("speed")};
    if (record.energy) side.energy_residual = record.energy->residual_fraction;
    for (const char* name : {"full-open", "canopy-filled", "peak-force"})
        if (const Event* event = record.find_event(name))
            side.opening_end = std::max(side.opening_end, event->time - snatch_of(record));
    return side;
}

/// Reference less candidate, as everywhere for reading; the CSV file has it the other way round, as gap.json.
std::string gap_text(const std::optional<double>& share) {
    return share ? fmt::format("{:+.1f} %", -100.0 * *share) : "-";
}

bool compares(const CaseSeries& series) {
    return !series.candidate_title.empty();
}

/// Numbers of one fidelity or both for reading, in the units chosen; columns that a case fills.
Table brief_table(const CaseSeries& series) {
    const bool both = compares(series);
    std::vector<const MetricRow*> columns =
        both ? columns_of(series, brief_metrics) : columns_of(series, metrics_alone);
    std::erase_if(columns, [&](const MetricRow* column) {
        return std::ranges::none_of(series.cases, [&](const SeriesCase& one) {
            return one.reference.value_of(*column) || (one.candidate && one.candidate->value_of(*column));
        });
    });
    const bool grouped =
        std::ranges::any_of(series.cases, [](const auto& one) { return !one.group.empty(); });
    Table table;
    table.add_words({"case"});
    if (grouped) table.add_words({"group"});
    if (both) table.add_words({"verdict"});
    table.add_words({"status"});
    for (const MetricRow* column : columns)
        table.add_numbers({column->title}, shown_unit(column->unit));
    if (both) table.add_numbers({"gap in peak force"});
    const bool booked = std::ranges::any_of(
        series.cases, [](const auto& one) { return one.reference.energy_residual.has_value(); });
    if (booked) table.add_numbers({"energy left over"});
    table.add_numbers({"wall"}, "s");
    const auto cell = [](const std::optional<double>& v) { return v ? readable(*v) : std::string("-"); };
    const auto pair = [](const std::string& candidate, const std::string& reference) {
        return candidate == reference ? candidate : candidate + " / " + reference;
    };
    for (const SeriesCase& one : series.cases) {
        const auto text_of = [&](const auto& of) {
            return one.candidate ? pair(of(*one.candidate), of(one.reference)) : of(one.reference);
        };
        std::vector<Cell>& row = table.rows.emplace_back();
        row.emplace_back(one.name).link = one.page;
        if (grouped) row.emplace_back(one.group);
        if (both) row.emplace_back(one.verdict);
        row.emplace_back(text_of([](const SeriesSide& side) { return side.row.status; }));
        for (const MetricRow* column : columns)
            row.emplace_back(text_of([&](const SeriesSide& side) {
                std::optional<double> value = side.value_of(*column);
                if (value) value = shown(*value, column->unit).value;
                return cell(value);
            }));
        if (both) row.emplace_back(gap_text(one.gap));
        if (booked)
            row.emplace_back(
                one.reference.energy_residual ? fmt::format("{:.1e}", *one.reference.energy_residual) : "-");
        row.emplace_back(text_of([&](const SeriesSide& side) { return cell(side.row.wall_s); }));
    }
    return table;
}

/// "series", or "series-rom" of one fidelity.
std::string stem_of(const CaseSeries& series) {
    if (compares(series) || series.cases.empty()) return "series";
    return "series-" + series.cases.front().reference.row.fidelity;
}

/// "12 cases of the reduced-order model, 0.4 s".
std::string count_text(const CaseSeries& series) {
    return fmt::format("{} cases {}, {:.3g} s", series.cases.size(),
                       compares(series) ? "at both fidelities" : "of the " + series.reference_title,
                       series.wall_s);
}

/// "Where two numbers stand: rom / full."
std::string sides_text(const CaseSeries& series) {
    if (series.cases.empty() || !series.cases.front().candidate) return {};
    return fmt::format("Where two numbers stand: {} / {}.", series.cases.front().candidate->row.fidelity,
                       series.cases.front().reference.row.fidelity);
}

}  // namespace

std::optional<double> SeriesSide::value_of(const MetricRow& metric) const {
    const auto found = std::ranges::find(row.metrics, metric.key, &std::pair<std::string, double>::first);
    return found == row.metrics.end() ? std::nullopt : std::optional(found->second);
}

CaseSeries series_of(const Scene& scene) {
    CaseSeries series;
    series.title = scene.name.substr(0, scene.name.rfind(", " + scene.case_name));
    series.spec = scene.series.value_or(SeriesSpec{"froude_number", "peak_force_ratio", "", "", {}, {}});
    return series;
}

SeriesCase series_case(const Scene& scene, const Comparison& comparison) {
    SeriesCase one = series_case(scene, comparison.reference);
    one.candidate = side_of(comparison.candidate);
    for (const MetricGap& gap : comparison.gap.metrics)
        if (gap.row->name == "peak_force") one.gap = gap.relative;
    one.verdict = verdict_name(overall_verdict(comparison.gap));
    return one;
}

SeriesCase series_case(const Scene& scene, const RunRecord& record) {
    SeriesCase one;
    one.name = scene.case_name;
    if (scene.series) one.group = scene.series->group;
    one.reference = side_of(record);
    return one;
}

std::string series_csv(const CaseSeries& series) {
    const std::vector<const MetricRow*> columns = columns_of(series, csv_metrics);
    const auto sides_of = [](const SeriesCase& one) {
        std::vector<const SeriesSide*> sides{&one.reference};
        if (one.candidate) sides.push_back(&*one.candidate);
        return sides;
    };
    Table table;
    table.add_words({"case", "group"}, "-");
    if (!series.cases.empty()) {
        for (const SeriesSide* side : sides_of(series.cases.front())) {
            const std::string& fidelity = side->row.fidelity;
            table.add_words({fidelity + ".status"}, "-");
            for (const MetricRow* column : columns)
                table.add_words({fmt::format("{}.{}", fidelity, column->name)},
                                column->unit.empty() ? "1" : column->unit);
            table.add_words({fidelity + ".energy_residual"}, "1");
            table.add_words({fidelity + ".wall"}, "s");
        }
        if (compares(series)) table.add_words({"peak_force_gap"}, "1");
    }
    for (const SeriesCase& one : series.cases) {
        std::vector<Cell>& cells = table.rows.emplace_back();
        cells = {one.name, one.group};
        for (const SeriesSide* side : sides_of(one)) {
            cells.emplace_back(side->row.status);
            for (const MetricRow* column : columns)
                cells.emplace_back(exact(side->value_of(*column)));
            cells.emplace_back(exact(side->energy_residual));
            cells.emplace_back(exact(side->row.wall_s));
        }
        if (compares(series)) cells.emplace_back(exact(one.gap));
    }
    return csv_table(table);
}

std::string series_markdown(const CaseSeries& series) {
    std::string text = fmt::format("# {}\n\n{}.\n\n![{} against {}]({}.svg)\n\n", markdown_text(series.title),
                                   count_text(series), find_metric_row(series.spec.y)->title,
                                   find_metric_row(series.spec.x)->title, stem_of(series));
    text += markdown_table(brief_table(series)) + "\n";
    for (const std::string& words :
         {sides_text(series), units_remark().empty() ? "" : fmt::format("Here: {}.", units_remark())})
        if (!words.empty()) text += words + " ";
    return text + fmt::format("All metrics: {}.csv.\n", stem_of(series));
}

std::string series_terminal(const CaseSeries& series, const Style& style) {
    std::string text = terminal_table(brief_table(series), style);
    if (const std::string sides = sides_text(series); !sides.empty()) text += sides + "\n";
    return text;
}

std::string series_html(const CaseSeries& series) {
    std::string summary = fmt::format("<p>{}.</p>\n", xml_text(count_text(series)));
    if (!units_remark().empty()) summary += fmt::format("<p>Here: {}.</p>\n", units_remark());
    summary += html_table(brief_table(series),
                          fmt::format("A line for each case. {}", xml_text(sides_text(series))), {}, "cases");
    std::string openings;
    for (const Plot& plot : opening_plots(series))
        openings += page_figure(plot);
    return still_page(
        series.title, "series",
        page_section("summary", "Cases", summary) +
            page_section("against", "One metric against another", page_figure(series_plot(series))) +
            (openings.empty() ? "" : page_section("openings", "Openings", openings)));
}

std::filesystem::path add_series(FileBatch& batch, const CaseSeries& series,
                                 const std::filesystem::path& directory) {
    const std::string stem = stem_of(series);
    batch.add(directory / (stem + ".csv"), series_csv(series));
    batch.add(directory / (stem + ".svg"), svg_plot(series_plot(series)));
    batch.add(directory / (stem + ".html"), series_html(series));
    batch.add(directory / (stem + ".md"), series_markdown(series), FileBatch::Kind::marker);
    return directory / (stem + ".html");
}

}  // namespace twinchute::compare
