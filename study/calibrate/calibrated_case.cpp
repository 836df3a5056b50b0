#include "study/calibrate/calibrated_case.hpp"

#include <fmt/format.h>

#include "lib/cli/text.hpp"
#include "study/calibrate/calibration.hpp"

namespace twinchute::study {
namespace {

compare::CalibratedCase calibrate_case(const Fidelity& rom, const SceneWith& scene_with,
                                       const std::vector<std::string>& names,
                                       const std::vector<std::string>& vary, int draws) {
    CalibrationSettings settings;
    settings.predict = false;
    for (const std::string& text : vary)
        settings.vary.push_back(read_vary(text));
    const Scene scene = scene_with({});
    std::vector<DropTest> tests;
    for (const std::string& name : names)
        tests.push_back(read_drop_test(name, scene));
    const Calibration calibration = calibrate(scene_with, tests, rom, settings);
    const InputDraws drawn = draw_inputs(calibration, draws);
    const auto overrides = [&](const std::vector<double>& values) {
        std::vector<std::string> all;
        for (std::size_t i = 0; i < values.size(); ++i)
            all.push_back(fmt::format("{}={}", drawn.keys[i], values[i]));
        return all;
    };
    compare::CalibratedCase found;
    found.values = overrides(drawn.best);
    for (const std::vector<double>& values : drawn.values)
        found.draws.push_back(overrides(values));
    for (const Parameter& p : calibration.parameters)
        if (p.unknown.kind == Unknown::Kind::key)
            found.text += fmt::format("{}{} = {}{}", found.text.empty() ? "calibrated: " : ", ",
                                      p.unknown.name, readable(p.estimate), p.held ? " (held)" : "");
    for (const Finding& finding : calibration.findings)
        found.text += fmt::format("; doubt: {} ({})", finding.what, finding.why);
    return found;
}

}  // namespace

compare::Calibrator case_calibrator(const Fidelity& rom) {
    return [&rom](const std::function<Scene(const std::vector<std::string>&)>& scene_with,
                  const std::vector<std::string>& tests, const std::vector<std::string>& vary,
                  int draws) { return calibrate_case(rom, scene_with, tests, vary, draws); };
}

}  // namespace twinchute::study
