// The report of a calibration: one page without scripts.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "compare/render/escape.hpp"
#include "compare/render/plot.hpp"
#include "compare/report/still_page.hpp"
#include "study/calibrate/calibration_files.hpp"
#include "study/calibrate/calibration_tables.hpp"

namespace twinchute::study {
namespace {

using compare::page_figure;
using compare::page_section;
using compare::Plot;
using compare::PlotSeries;
using compare::still_page;
using compare::xml_text;

std::string history_title(const HistoryFit& fit) {
    return fmt::format("{}, {}", fit.measured.kind->title, fit.test->name);
}

Plot fit_plot(const HistoryFit& fit) {
    Plot plot;
    plot.title = history_title(fit);
    plot.x.label = "time on the clock of the test [s]";
    plot.y.label = fmt::format("{} [{}]", fit.measured.kind->name, fit.measured.kind->unit);
    PlotSeries measured{.label = "measured", .colour = compare::dim},
        model{.label = "calibrated model", .colour = compare::vermillion};
    measured.line = 0.0;
    measured.marker = compare::MarkerShape::dot;
    measured.x = fit.measured.time, measured.y = fit.measured.value;
    model.x = fit.measured.time, model.y = fit.model;
    plot.series = {measured, model};
    return plot;
}

Plot residual_plot(const HistoryFit& fit) {
    Plot plot;
    plot.title = "What is left over: " + history_title(fit);
    plot.height = 280.0;
    plot.x.label = "time on the clock of the test [s]";
    plot.y.label = fmt::format("measured less model [{}]", fit.measured.kind->unit);
    PlotSeries left{.label = "", .colour = compare::blue};
    left.line = 0.0;
    left.marker = compare::MarkerShape::dot;
    for (std::size_t i = 0; i < fit.model.size(); ++i) {
        if (!fit.used[i]) continue;
        left.x.push_back(fit.measured.time[i]);
        left.y.push_back(fit.measured.value[i] - fit.model[i]);
    }
    plot.series = {left};
    plot.levels = {{"+2 sigma", compare::dim, 2.0 * fit.noise.sigma},
                   {"0", compare::dim, 0.0},
                   {"-2 sigma", compare::dim, -2.0 * fit.noise.sigma}};
    return plot;
}

/// Density of a normal distribution in the scale of the variable, as high as 1.
Plot marginal_plot(const Parameter& p) {
    Plot plot;
    plot.title = p.label();
    plot.height = 260.0;
    plot.x.label = fmt::format("{}{}", p.label(), p.unknown.unit.empty() ? "" : " [" + p.unknown.unit + "]");
    plot.y.label = "density over its largest";
    plot.y.from_zero = true;
    PlotSeries density{.label = "normal with the covariance of the fit", .colour = compare::blue};
    const FitVariable& v = p.unknown.variable;
    constexpr int points = 120;
    constexpr double reach = 3.5;
    for (int i = 0; i <= points; ++i) {
        const double z = reach * (2.0 * i / points - 1.0);
        const double value = v.from_scale(v.to_scale(p.estimate) + z * p.sigma);
        if (value < v.low || value > v.high) continue;
        density.x.push_back(value);
        density.y.push_back(std::exp(-0.5 * z * z));
    }
    plot.series = {density};
    plot.markers = {{"95 %", compare::vermillion, p.interval.low},
                    {"95 %", compare::vermillion, p.interval.high}};
    return plot;
}

/// Share of the draws below a value.
Plot band_plot(const Band& band) {
    Plot plot;
    plot.title = "Next drop: " + metric_words(band.row->key);
    plot.height = 260.0;
    plot.x.label = fmt::format("{}{}", metric_words(band.row->key),
                               band.row->unit.empty() ? "" : fmt::format(" [{}]", band.row->unit));
    plot.y.label = "share of draws below";
    plot.y.from_zero = true;
    PlotSeries share{.label = fmt::format("{} draws of the inputs", band.draws.size()),
                     .colour = compare::green};
    for (std::size_t i = 0; i < band.draws.size(); ++i) {
        share.x.push_back(band.draws[i]);
        share.y.push_back((static_cast<double>(i) + 0.5) / static_cast<double>(band.draws.size()));
    }
    plot.series = {share};
    plot.markers = {{"2.5 %", compare::vermillion, band.low}, {"97.5 %", compare::vermillion, band.high}};
    return plot;
}

std::string summary_of(const Calibration& calibration, const std::vector<DropTest>& tests) {
    std::string body = fmt::format(
        "<p>{} to {} {}, by {} runs of the model.</p>\n",
        calibration.is_consistent() ? "Calibrated" : "Calibrated, but <strong>inconsistent</strong>",
        tests.size(), tests.size() == 1 ? "test" : "tests", calibration.runs);
    for (const Finding& f : calibration.findings) {
        body += fmt::format("<p><strong>{}</strong> ({}), {}.</p>\n", xml_text(f.what), xml_text(f.why),
                            xml_text(f.suggestion));
        if (f.explains.empty()) continue;
        body += "<p>Which explains:</p>\n<ul>\n";
        for (const std::string& what : f.explains)
            body += "<li>" + xml_text(what) + "</li>\n";
        body += "</ul>\n";
    }
    body += html_table(parameters_table(calibration),
                       "Inputs, with what the profile of the likelihood gives as their 95 % interval", "",
                       "parameters");
    std::string remarks;
    for (const std::string& remark : remarks_of(calibration))
        remarks += "<li>" + xml_text(remark) + "</li>\n";
    if (!remarks.empty()) body += "<ul>\n" + remarks + "</ul>\n";
    return page_section("summary", "Result", body);
}

}  // namespace

std::string calibration_page(const Calibration& calibration, const Scene& scene,
                             const std::vector<DropTest>& tests) {
    std::string fits =
        html_table(fits_table(calibration), "What was measured, and what the model leaves over", "", "fits");
    for (const HistoryFit& fit : calibration.histories)
        fits += page_figure(fit_plot(fit)) + page_figure(residual_plot(fit));
    std::string marginals = html_table(correlation_table(calibration), "Correlation", "", "correlation");
    for (const Parameter& p : calibration.parameters)
        if (!p.held && p.sigma > 0.0) marginals += page_figure(marginal_plot(p));
    std::string bands = html_table(bands_table(calibration), "The scene itself, dropped again", "", "bands");
    for (const Band& band : calibration.predictive)
        if (band.draws.size() > 1) bands += page_figure(band_plot(band));
    std::string page;
    page += summary_of(calibration, tests) + page_section("fit", "Fit and residuals", fits) +
            page_section("marginals", "Inputs", marginals);
    if (!calibration.predictive.empty()) page += page_section("next", "The next drop", bands);
    return still_page(scene.name, "calibration", page);
}

}  // namespace twinchute::study
