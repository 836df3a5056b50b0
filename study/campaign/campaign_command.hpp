// `twinchute campaign`.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lib/cli/command.hpp"
#include "lib/solve/fidelity.hpp"
#include "study/varied_scene.hpp"
#include "study/work.hpp"

namespace twinchute::study {

/// Exit code 0 where all limits are met, 1 where one is not, or not known to be. Without HDF5 or Random123 in
/// the build every call is refused.
Command campaign_command(const Fidelity& rom, const Fidelity& full);

/// A campaign that came as text, and the scene that varies in place of the one that it names.
struct CampaignText {
    std::string text, name;           ///< of its file
    std::filesystem::path directory;  ///< beneath which files lie that it names
    SceneWith scene_with;
    std::string scene_file;              ///< for the record
    std::vector<std::string> overrides;  ///< "--set key=value", above the campaign's own
    int threads = 1;
};
/// Reads the campaign; its runs are kept among the system's temporary files while it works. Throws SceneError
/// and UsageError.
StudyWork campaign_work(CampaignText campaign, const Fidelity& rom, const Fidelity& full);

}  // namespace twinchute::study
