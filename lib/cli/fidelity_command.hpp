// The command of one fidelity: run the scene with it and say what came out.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "lib/cli/command.hpp"
#include "lib/cli/text.hpp"
#include "lib/record/file_batch.hpp"
#include "lib/solve/fidelity.hpp"

namespace twinchute {

/// Where a single run leaves its record when --out does not say.
enum class DefaultOutput {
    none,      ///< standard output only
    directory  ///< "./<scene file>.out"
};

/// A case of a series that was run; of its histories time, force and speed.
struct CaseRun {
    const Scene* scene;
    RunRecord record;
};

/// Reports of runs of one fidelity, made by whoever can draw them.
struct RunReports {
    /// The text of run.html, which stands beside a record.
    std::function<std::string(const RunRecord&, const ShapeFrames&)> page;
    /// Adds files about all cases to the directory of the series and returns the page among them.
    std::function<std::filesystem::path(FileBatch&, const std::vector<CaseRun>&,
                                        const std::filesystem::path&)>
        add_series;
    /// A table of all cases for a terminal.
    std::function<std::string(const std::vector<CaseRun>&, const Style&)> series_text;
};

/// `others`: fidelities to point to when this one lacks physics that the scene asks for. The rows must
/// outlive the command.
Command fidelity_command(const Fidelity& fidelity, std::string summary, DefaultOutput output,
                         std::vector<const Fidelity*> others, RunReports reports);

}  // namespace twinchute
