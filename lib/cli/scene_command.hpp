// What every verb that takes a scene does in the same way.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lib/cli/verb.hpp"
#include "lib/solve/fidelity.hpp"

namespace twinchute {

/// --out, --set, --check, --json, --quiet.
std::vector<Option> scene_options(std::string out_meaning);

/// The scene of the operand with every --set, and whatever else overrides it, applied.
/// Throws SceneError and UsageError.
Scene scene_of(const Arguments& arguments, const std::vector<std::string>& more_overrides = {});

/// Throws UsageError naming the first key whose physics `fidelity` lacks, and the verb of `others` that has
/// it.
void require_physics(const Scene& scene, const Fidelity& fidelity, std::span<const Fidelity* const> others);

/// For --check: says that the scene is valid and what would run.
void say_valid(const Scene& scene, const Arguments& arguments);

/// Runs one fidelity with a progress line where one can be seen.
RunRecord run_watched(const Fidelity& fidelity, const Scene& scene, std::stop_token stop, bool quiet);

/// Writes to standard output.
void print(const std::string& text);

}  // namespace twinchute
