#include <fmt/format.h>

#include "lib/cli/record_text.hpp"
#include "study/calibrate/calibration_files.hpp"
#include "study/calibrate/calibration_tables.hpp"

namespace twinchute::study {

std::string calibration_text(const Calibration& calibration, const Scene& scene,
                             const std::vector<DropTest>& tests, const Style& style) {
    std::string text = fmt::format("{}  calibrated to {} {}\n\n", printable(scene.name), tests.size(),
                                   tests.size() == 1 ? "test" : "tests");
    text += terminal_table(parameters_table(calibration), style) + "\n";
    text += terminal_table(fits_table(calibration), style);
    if (!calibration.predictive.empty()) text += "\n" + terminal_table(bands_table(calibration), style);
    text += "\n";
    for (const std::string& remark : remarks_of(calibration))
        text += printable("note      " + remark) + "\n";
    for (const Finding& finding : calibration.findings) {
        text += style.paint("doubt", Colour::yellow) +
                printable(fmt::format("     {} ({}), {}", finding.what, finding.why, finding.suggestion)) +
                "\n";
        for (const std::string& what : finding.explains)
            text += printable("          which explains: " + what) + "\n";
    }
    text += calibration.is_consistent()
                ? style.paint("consistent", Colour::green) + ": the model and the tests go together\n"
                : style.paint("inconsistent", Colour::red) +
                      ": fitted, but the model and the tests do not go together\n";
    text += fmt::format("cost      {} runs of the model in {}, {:.0f} a second\n", calibration.runs,
                        time_text(calibration.seconds), calibration.runs / calibration.seconds);
    return text;
}

}  // namespace twinchute::study
