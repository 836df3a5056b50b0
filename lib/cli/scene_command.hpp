// Options, scenes and output shared by the commands that take a scene.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lib/cli/command.hpp"
#include "lib/record/field_files.hpp"
#include "lib/record/record_csv.hpp"
#include "lib/solve/fidelity.hpp"

namespace twinchute {

/// --out, --set, --check, --json, --quiet.
std::vector<Option> scene_options(std::string out_meaning);

/// --plain-csv, for commands that write records, and the head of the tables that it asks for.
Option plain_csv_option();

/// "--units us": what is shown on the terminal and on report pages; JSON and CSV stay SI.
Option units_option();
/// Throws UsageError on a word that is none.
void choose_units(const Arguments& arguments);
CsvHead csv_head(const Arguments& arguments);

/// --fields, for commands that run a fidelity which gives fields.
Option fields_option();

/// Overrides that --fields makes in a scene for this fidelity; none where it is absent, or the fidelity gives
/// no fields. Throws UsageError.
std::vector<std::string> fields_overrides(const Arguments& arguments, const Fidelity& fidelity);

/// --threads, for those that have some; 1 where it is absent. Throws UsageError.
Option threads_option();
int threads_of(const Arguments& arguments);
/// An option's number from 1 to `max`; `fallback` where it is absent. Throws UsageError, which shows
/// `example`.
int whole_number(const Arguments& arguments, std::string_view option, int fallback, int max, int example);

/// The scene of the operand, or the cases of its series, with every --set, and whatever else overrides
/// them, applied. Throws SceneError and UsageError.
std::vector<Scene> scenes_of(const Arguments& arguments, const std::vector<std::string>& more_overrides = {});

/// --parachute NAME, for what is of one parachute.
Option parachute_option();
/// The scene with that of its parachutes alone, or with the only one. Throws UsageError.
Scene with_one_parachute(Scene scene, const Arguments& arguments);

/// Where results of a scene go: `directory`, for a case of a series its own below that.
std::filesystem::path directory_of(const Scene& scene, const std::filesystem::path& directory);

/// One JSON text for standard output: that of the one scene, or an array over the cases.
std::string joined_json(const std::vector<Scene>& scenes, const std::vector<std::string>& texts);
/// Prints one text a scene: as JSON, apart by an empty line, or with --quiet not at all.
void print_each(const Arguments& arguments, const std::vector<Scene>& scenes,
                const std::vector<std::string>& texts);

/// The exit code of a series: the gravest of its cases.
ExitCode gravest(ExitCode one, ExitCode other);

/// Throws UsageError naming the first key whose physics `fidelity` lacks, and the command of `others` that
/// has it.
void require_physics(const Scene& scene, const Fidelity& fidelity, std::span<const Fidelity* const> others);

/// For --check: says that the scenes are valid.
void say_valid(const std::vector<Scene>& scenes, const Arguments& arguments);

/// Runs one fidelity with a progress line where one can be seen. Fields that the scene asks for go into
/// `fields` where there is one, the shapes for a report into `frames`; the rest of the fall, where it asks
/// for that, is flown by one of `others`. Throws WriteError where fields do not fit.
RunRecord run_watched(const Fidelity& fidelity, const Scene& scene, std::stop_token stop, bool quiet,
                      int threads, FieldFiles* fields = nullptr, ShapeFrames* frames = nullptr,
                      Checkpoints checkpoints = {}, std::span<const Fidelity* const> others = {});

/// For reading: where the fields are, or nothing where there are none.
std::string fields_text(const FieldFiles& fields);

/// Writes to standard output.
void print(const std::string& text);

}  // namespace twinchute
