// Error against evaluations of the right-hand side, or against what a run costs otherwise: what is measured
// of one problem, as a table and as plots.
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace twinchute::bench {

/// One integration.
struct Sample {
    std::string setting;            ///< e.g. "1e-6": the tolerance, or the factor of a step
    std::int64_t evaluations = 0;   ///< of the right-hand side
    double seconds = 0.0;           ///< least of its repeats
    double error = 0.0;             ///< [-] relative; of what, the study says
    double other_error = NAN;       ///< [-] of a second quantity, where there is one
    std::vector<double> more = {};  ///< further columns of the table
};

/// Families of methods for the full model.
constexpr const char *own_rule = "explicit midpoint, this toolkit", *adaptive_steps = "ARKODE, adaptive",
                     *even_steps = "ARKODE, even steps";

/// Work and error of one method, at looser settings first.
struct Curve {
    std::string method, family;
    std::vector<Sample> samples;
};

/// A level across a picture, e.g. what nothing on its horizontal axis makes smaller.
struct Level {
    std::string label;
    double error = 0.0;  ///< [-]
};

/// One picture of a study.
struct View {
    std::string suffix;            ///< of its file: "work-<name><suffix>.svg"
    std::string x_label, y_label;  ///< with units
    double (*x)(const Sample&);
    double (*y)(const Sample&);
    std::vector<Level> levels = {};
};

struct Study {
    std::string name;  ///< of its files: "work-<name>.csv" and ".svg"
    std::string title, subtitle;
    std::string error;  ///< of what, e.g. "altitude and speed"
    std::vector<Curve> curves;
    std::vector<std::string> more = {};  ///< names of the further columns, with their units
    std::vector<View> views = {};        ///< none: error against evaluations
};

/// Families in the order of their colours (Okabe and Ito).
void write(const Study& study, const std::filesystem::path& directory);

/// Four stages and flights of the reduced-order model. `quick`: tolerances down to 1e-5 only.
void study_rom(const std::filesystem::path& directory, bool quick);
/// The beginning of the line-stretch demo of the full model. `quick`: a coarse mesh for a hundredth of a
/// second.
void study_full(const std::filesystem::path& directory, bool quick);
/// Its opening: peak force, when it comes, and filling time, against time step and mesh; then springs against
/// finite elements from the pack. `quick`: coarse meshes, few settings.
void study_openings(const std::filesystem::path& directory, bool quick);

}  // namespace twinchute::bench
