// `twinchute size`.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <stop_token>
#include <string>

#include "lib/cli/command.hpp"
#include "rom/size/size.hpp"

namespace twinchute::study {

/// Exit code 0 where the limits are met and 1 where they cannot be.
Command size_command();

/// Throws UsageError for a scene without what sizing needs.
void require_sizable(const Scene& scene);

/// The answer of `size --json` for one scene, with the text of each candidate as a scene besides:
/// "scene_text", where it was found. Throws UsageError for a scene without what sizing needs, and
/// rom::Interrupted.
nlohmann::ordered_json sized_json(const Scene& scene, const std::stop_token& stop);

/// The sized scene as a file, for other commands to run.
std::string sized_scene_text(const Scene& scene, const rom::Candidate& best);

}  // namespace twinchute::study
