// `twinchute size`.
#pragma once

#include <string>

#include "lib/cli/command.hpp"
#include "rom/size/size.hpp"

namespace twinchute::study {

/// Exit code 0 where the limits are met and 1 where they cannot be.
Command size_command();

/// Throws UsageError for a scene without what sizing needs.
void require_sizable(const Scene& scene);

/// The sized scene as a file, for other commands to run.
std::string sized_scene_text(const Scene& scene, const rom::Candidate& best);

}  // namespace twinchute::study
