#include "study/calibrate/calibration_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lib/record/metrics.hpp"

namespace twinchute::study {

using compare::Cell;
using compare::Tone;

compare::Table parameters_table(const Calibration& calibration) {
    compare::Table table;
    table.add_words({"input"});
    table.add_numbers({"scene", "estimate", "95 % from", "to"});
    table.add_words({"unit", "is"});
    const bool scatters =
        std::ranges::any_of(calibration.parameters, [](const Parameter& p) { return p.scatter.has_value(); });
    if (scatters) table.add_numbers({"test to test"});
    for (const Parameter& p : calibration.parameters) {
        const bool logarithmic = p.unknown.variable.logarithmic;
        std::vector<Cell> row{p.label(),
                              readable(p.start),
                              readable(p.estimate),
                              p.held ? "-" : readable(p.interval.low),
                              p.held ? "-" : readable(p.interval.high),
                              p.unknown.unit,
                              p.held         ? Cell("held: " + p.why, Tone::caution)
                              : p.identified ? Cell("identified", Tone::good)
                                             : Cell("not identified: " + p.why, Tone::caution)};
        if (scatters)
            row.emplace_back(!p.scatter    ? std::string("-")
                             : logarithmic ? fmt::format("{:.1f} %", 100.0 * *p.scatter)
                                           : readable(*p.scatter, 2));
        table.rows.push_back(std::move(row));
    }
    return table;
}

compare::Table fits_table(const Calibration& calibration) {
    compare::Table table;
    table.add_words({"test", "measured"});
    table.add_numbers({"readings", "rms left", "of the largest", "noise"});
    table.add_words({"its source", "unit"});
    for (const HistoryFit& fit : calibration.histories)
        table.rows.push_back({fit.test->name, fit.measured.kind->name,
                              fmt::format("{}", std::ranges::count(fit.used, true)), readable(fit.rms, 3),
                              fmt::format("{:.1f} %", 100.0 * fit.rms / fit.measured.largest()),
                              readable(fit.noise.sigma, 3),
                              fit.noise.given       ? "as given"
                              : fit.test->is_record ? "all as one reading"
                                                    : "from what is left",
                              fit.measured.kind->unit});
    for (const ScalarFit& fit : calibration.scalars)
        table.rows.push_back(
            {fit.test->name, fit.measured->row->name, "1",
             readable(std::abs(fit.measured->value - fit.model), 3),
             fmt::format("{:.1f} %", 100.0 * std::abs(fit.model / fit.measured->value - 1.0)),
             readable(fit.measured->sigma, 3), "as given", fit.measured->row->unit});
    return table;
}

compare::Table bands_table(const Calibration& calibration) {
    compare::Table table;
    table.add_words({"next drop"});
    table.add_numbers({"before", "calibrated", "95 % from", "to"});
    table.add_words({"unit"});
    for (const Band& band : calibration.predictive)
        table.rows.push_back({metric_words(band.row->key), band.before ? readable(*band.before) : "-",
                              readable(band.best), readable(band.low), readable(band.high), band.row->unit});
    return table;
}

compare::Table correlation_table(const Calibration& calibration) {
    compare::Table table;
    table.add_words({"input"});
    for (const Parameter& p : calibration.parameters)
        if (!p.held) table.columns.push_back({p.label(), compare::Align::right});
    for (std::size_t i = 0; i < calibration.parameters.size(); ++i) {
        if (calibration.parameters[i].held) continue;
        std::vector<Cell> row{calibration.parameters[i].label()};
        for (std::size_t j = 0; j < calibration.parameters.size(); ++j) {
            if (calibration.parameters[j].held) continue;
            const std::string text = fmt::format("{:.2f}", calibration.correlation(i, j));
            row.emplace_back(
                text, i != j && std::abs(calibration.correlation(i, j)) > 0.9 ? Tone::strong : Tone::plain);
        }
        table.rows.push_back(std::move(row));
    }
    return table;
}

std::vector<std::string> remarks_of(const Calibration& calibration) {
    std::vector<std::string> remarks;
    for (const Pairing& pair : calibration.pairs)
        remarks.push_back(
            fmt::format("{} and {} are closely correlated ({:.2f}): the tests know them together better "
                        "than each by itself",
                        calibration.parameters[pair.one].label(), calibration.parameters[pair.other].label(),
                        pair.correlation));
    for (const Parameter& p : calibration.parameters)
        if (p.held)
            remarks.push_back(
                fmt::format("{} is held at {}: the tests do not see it", p.label(), readable(p.estimate)));
    remarks.insert(remarks.end(), calibration.notes.begin(), calibration.notes.end());
    return remarks;
}

}  // namespace twinchute::study
