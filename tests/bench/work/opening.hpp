// Parts shared by studies of whole openings: their answers, a run that gives them, and the pictures.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "lib/scene/scene.hpp"
#include "tests/bench/work/study.hpp"

namespace twinchute::bench {

struct Opening {
    double peak = 0.0;       ///< [N] of the opening force, mean over 5 ms
    double peak_time = 0.0;  ///< [s] since snatch
    double filling = 0.0;    ///< [s] since snatch
};

struct Measured {
    Opening opening;
    std::int64_t evaluations = 0;  ///< of all forces
    double element_steps = 0.0;    ///< evaluations of elements
    double seconds = 0.0;          ///< wall time
    double steady_area = 0.0;      ///< [m2] projected, of a run
};

/// A run of the full model. Throws std::runtime_error where it does not end as its scene says, or has not
/// filled.
Measured run_opening(const Scene& scene);

/// Relative distances, in the order of the members.
std::array<double, 3> errors_of(const Opening& found, const Opening& truth);
/// Largest less smallest of each.
Opening range_of(const std::vector<Opening>& all);
/// Median of each answer.
Opening median_of(std::vector<Opening> all);

/// Its error is that of the peak force, the other one that of its time; see opening_study for the rest.
Sample sample_of(const std::string& setting, const Measured& run, const Opening& truth);
/// Prints the last sample.
void say(const Curve& curve);
void say(const char* what, const Measured& run);

/// Range of openings whose canopies start a micrometre apart: neither step nor mesh makes that smaller.
Opening micrometre_apart(Scene scene);
inline constexpr const char* micrometre = "starts 1 um apart";

/// Pictures of the peak force over wall time and over element-steps, of its time and of the filling time over
/// element-steps. `floor`: a scatter that is drawn as a level in each, over `about`.
Study opening_study(std::string name, std::string title, std::string subtitle, const std::string& floor_word,
                    const Opening& floor, const Opening& about);

struct TimeSettings {
    std::string name;
    std::vector<double> factors, tolerances;  ///< of the model's own step, of pairs
    double truth_rtol = 0.0;                  ///< of the pair of order 4 that is the truth in time
    int lowest_order = 3, highest_order = 5;  ///< of pairs
};
struct MeshSettings {
    std::string name;
    std::vector<double> whole, sector;  ///< elements in each direction, in those of the scene
    std::vector<int> columns;           ///< elements across a gore, the rest as it is
    double reference = 0.0;             ///< of one sector, in those of the scene
};

/// The demo on its own mesh, by the model's own steps and by ARKODE's pairs.
void study_opening_in_time(const Scene& demo, const TimeSettings& with,
                           const std::filesystem::path& directory);
/// The demo on other meshes.
void study_opening_by_mesh(const Scene& demo, const MeshSettings& with,
                           const std::filesystem::path& directory);
/// Springs until filling against finite elements from the pack on, in the crane drop.
void study_opening_from_pack(const std::filesystem::path& directory, bool quick);

}  // namespace twinchute::bench
