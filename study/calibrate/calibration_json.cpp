#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "lib/record/record_json.hpp"
#include "lib/scene/scene_id.hpp"
#include "study/calibrate/calibration_files.hpp"

namespace twinchute::study {
namespace {

using nlohmann::ordered_json;

ordered_json tests_json(const std::vector<DropTest>& tests) {
    ordered_json all = ordered_json::array();
    for (const DropTest& test : tests)
        all.push_back({{"name", test.name},
                       {"sha256", test.sha256},
                       {"kind", test.is_record ? "record" : "measured"},
                       {"clock", test.clock_known ? "known" : "fitted"},
                       {"conditions", test.conditions}});
    return all;
}

ordered_json parameter_json(const Parameter& p) {
    ordered_json json{{"estimate", p.estimate},
                      {"interval_95", {p.interval.low, p.interval.high}},
                      {"identified", p.identified},
                      {"unit", p.unknown.unit},
                      {"scene", p.start},
                      {"bounds", {p.unknown.variable.low, p.unknown.variable.high}},
                      {"scale", p.unknown.variable.logarithmic ? "logarithmic" : "linear"}};
    if (p.held) json["held"] = true;
    if (!p.held) json["standard_deviation"] = p.sigma;
    if (!p.why.empty()) json["why"] = p.why;
    if (p.unknown.prior) json["prior"] = {{"mean", p.unknown.prior->mean}, {"sigma", p.unknown.prior->sigma}};
    if (p.scatter) json["scatter"] = *p.scatter;
    return json;
}

ordered_json correlation_json(const Calibration& calibration) {
    ordered_json json{
        {"keys", ordered_json::array()}, {"matrix", ordered_json::array()}, {"close", ordered_json::array()}};
    for (std::size_t i = 0; i < calibration.parameters.size(); ++i) {
        if (calibration.parameters[i].held) continue;
        json["keys"].push_back(calibration.parameters[i].label());
        ordered_json row = ordered_json::array();
        for (std::size_t j = 0; j < calibration.parameters.size(); ++j)
            if (!calibration.parameters[j].held) row.push_back(calibration.correlation(i, j));
        json["matrix"].push_back(std::move(row));
    }
    for (const Pairing& pair : calibration.pairs)
        json["close"].push_back(
            {{"keys", {calibration.parameters[pair.one].label(), calibration.parameters[pair.other].label()}},
             {"correlation", pair.correlation}});
    return json;
}

ordered_json residuals_json(const Calibration& calibration) {
    ordered_json json{{"chi_square", calibration.sum},
                      {"readings", calibration.readings},
                      {"fitted", calibration.fitted},
                      {"histories", ordered_json::array()},
                      {"scalars", ordered_json::array()}};
    for (const HistoryFit& fit : calibration.histories) {
        ordered_json one{{"test", fit.test->name},
                         {"history", fit.measured.kind->name},
                         {"unit", fit.measured.kind->unit},
                         {"sigma", fit.noise.sigma},
                         {"sigma_from", fit.noise.given ? "test" : "residuals"},
                         {"noise_memory_s", fit.noise.memory},
                         {"rms", fit.rms},
                         {"first_lag", fit.first_lag},
                         {"structure_probability", fit.structure},
                         {"time", fit.measured.time},
                         {"measured", fit.measured.value},
                         {"model", fit.model}};
        if (fit.measured.bandwidth) one["bandwidth_Hz"] = *fit.measured.bandwidth;
        json["histories"].push_back(std::move(one));
    }
    for (const ScalarFit& fit : calibration.scalars)
        json["scalars"].push_back({{"test", fit.test->name},
                                   {"metric", fit.measured->row->key},
                                   {"measured", fit.measured->value},
                                   {"sigma", fit.measured->sigma},
                                   {"model", fit.model}});
    return json;
}

}  // namespace

std::string calibration_json(const Calibration& calibration, const Scene& scene,
                             const std::vector<DropTest>& tests) {
    ordered_json json{{"schema", 1}, {"generator", "twinchute"}};
    json["scene"] = scene_json(scene_id(scene));
    json["tests"] = tests_json(tests);
    json["consistent"] = calibration.is_consistent();
    json["findings"] = ordered_json::array();
    for (const Finding& f : calibration.findings)
        json["findings"].push_back(
            {{"what", f.what}, {"why", f.why}, {"suggestion", f.suggestion}, {"explains", f.explains}});
    json["parameters"] = ordered_json::object();
    for (const Parameter& p : calibration.parameters)
        json["parameters"][p.label()] = parameter_json(p);
    json["correlation"] = correlation_json(calibration);
    json["residuals"] = residuals_json(calibration);
    json["predictive"] = ordered_json::object();
    for (const Band& band : calibration.predictive) {
        ordered_json one{
            {"estimate", band.best}, {"interval_95", {band.low, band.high}}, {"draws", band.draws.size()}};
        if (band.before) one["before"] = *band.before;
        json["predictive"][std::string(band.row->key)] = std::move(one);
    }
    json["notes"] = calibration.notes;
    json["cost"] = {{"runs", calibration.runs}, {"wall_s", calibration.seconds}};
    json["provenance"] = provenance_json(current_provenance());
    return json_text(json);
}

}  // namespace twinchute::study
