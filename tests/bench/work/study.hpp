// Error against evaluations of the right-hand side: what is measured of one problem, as a table and as a
// plot.
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace twinchute::bench {

/// One integration.
struct Sample {
    std::string setting;           ///< e.g. "1e-6": the tolerance, or the factor of a step
    std::int64_t evaluations = 0;  ///< of the right-hand side
    double seconds = 0.0;          ///< least of its repeats
    double error = 0.0;            ///< [-] relative; of what, the study says
    double other_error = NAN;      ///< [-] of a second quantity, where there is one
};

/// What one method makes of it, at looser settings first.
struct Curve {
    std::string method, family;
    std::vector<Sample> samples;
};

struct Study {
    std::string name;  ///< of its files: "work-<name>.csv" and ".svg"
    std::string title, subtitle;
    std::string error;  ///< of what, e.g. "altitude and speed"
    std::vector<Curve> curves;
};

/// Families in the order of their colours (Okabe and Ito).
void write(const Study& study, const std::filesystem::path& directory);

/// Four stages and flights of the reduced-order model. `quick`: tolerances down to 1e-5 only.
void study_rom(const std::filesystem::path& directory, bool quick);
/// The line-stretch demo of the full model: its beginning, and until after the peak force. `quick`: a coarse
/// mesh for a hundredth of a second.
void study_full(const std::filesystem::path& directory, bool quick);

}  // namespace twinchute::bench
