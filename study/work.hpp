// Studies for somebody who keeps no files: a page that shows what comes of them.
#pragma once

#include <functional>
#include <stop_token>
#include <string>

#include "lib/solve/fidelity.hpp"

namespace twinchute::study {

/// Documents of a study, as its command writes them.
struct StudyResult {
    std::string json, page;
    std::string scene_text = {};  ///< of a calibration: calibrated.toml; may be empty
    bool interrupted = false;     ///< json and page are of what was there; empty: nothing was
};

/// Works until it is done or asked to stop. Throws what the command throws.
using StudyWork =
    std::function<StudyResult(const std::stop_token&, const std::function<void(const Progress&)>&)>;

}  // namespace twinchute::study
