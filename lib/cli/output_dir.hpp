// Where results go, and what must not be overwritten.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>

namespace twinchute {

/// "./<stem of the scene file>.out" in the current directory, made safe by file_stem_of.
std::filesystem::path default_output_dir(const std::filesystem::path& scene_file);

/// True if a directory holds results of this program: a summary.json, gap.json, calibration.json or
/// ladder.json of ours, or a checkpoint; or such directories alone, as deep as those of a series lie.
bool is_our_output(const std::filesystem::path& directory);

/// Called before anything runs. "" is the current directory. Throws UsageError for a non-empty directory that
/// is not ours (what killed runs left unfinished does not count), and
/// WriteError where nothing can be written (something in the way, no permission).
void check_output_dir(const std::filesystem::path& directory);

/// Nobody else's file is overwritten: one of ours has one of these `notes` in its first lines. `what` it is,
/// e.g. "mesh". Throws UsageError.
void check_output_file(const std::filesystem::path& file, std::initializer_list<const char*> notes,
                       std::string_view what);

}  // namespace twinchute
