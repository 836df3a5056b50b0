// Which physics effect makes which part of the gap: what `compare` found, and reports show.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace twinchute::compare {

/// Change that one effect makes to a metric when it alone is brought from the candidate's side to the
/// reference's.
struct AttributionTerm {
    std::string name;    ///< as on the command line, e.g. "added-mass"
    std::string title;   ///< e.g. "Added mass"
    double effect = 0;   ///< in the metric's unit; positive: it raises the metric
    std::string detail;  ///< what was switched, in words; empty when the title says it
};

/// One metric's way from the candidate's value to the reference's:
/// candidate + sum of effects + interaction = reference, to round-off.
struct MetricAttribution {
    std::string metric;    ///< name of a MetricRow
    double candidate = 0;  ///< where the way begins
    double reference = 0;  ///< where it ends
    std::vector<AttributionTerm> terms;
    double interaction = 0;  ///< what the effects do only together
    /// Largest less smallest value of the reference over seeds; absent where the scene has no random numbers.
    /// A gap smaller than this is within the scatter.
    std::optional<double> scatter;
};

struct Attribution {
    std::vector<MetricAttribution> metrics;
    std::vector<std::uint64_t> seeds;  ///< that the scatter was taken over; empty: none
    std::vector<std::string> notes;    ///< what was not switched, and why
};

}  // namespace twinchute::compare
