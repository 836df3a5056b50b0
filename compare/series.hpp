// The cases of a series side by side: what each came to at both fidelities, as a table and as points of a
// plot.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "compare/gap.hpp"
#include "compare/record_table.hpp"
#include "lib/record/file_batch.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::compare {

/// One fidelity of a case.
struct SeriesSide {
    RecordRow row;
    std::optional<double> energy_residual;  ///< [-] over the work of drag; absent where no energy is booked

    std::optional<double> value_of(const MetricRow& metric) const;
};

struct SeriesCase {
    std::string name, group;
    SeriesSide reference, candidate;
    std::optional<double> gap;  ///< of the peak force [-], relative to the reference
    std::string verdict;
};

/// A series that has been run.
struct CaseSeries {
    std::string title;
    std::string reference_title, candidate_title;  ///< e.g. "full aeroelastic model"
    SeriesSpec spec;
    std::vector<SeriesCase> cases;
    double wall_s = 0.0;  ///< of the whole series
};

SeriesCase series_case(const Scene& scene, const Comparison& comparison);

/// A line for each case: metrics of both fidelities, their gap, what the energy leaves over, wall times.
/// First line names, second line units; what a run does not have is an empty field.
std::string series_csv(const CaseSeries& series);

/// Table for reading, of what says most.
std::string series_markdown(const CaseSeries& series);

/// That table for a terminal, with the verdict of each case.
std::string series_terminal(const CaseSeries& series, const Style& style);

/// spec.y against spec.x, cases of a group joined, with the points of a test where the scene names some.
std::string series_svg(const CaseSeries& series);

/// series.csv, series.svg and, as the marker, series.md.
void add_series(FileBatch& batch, const CaseSeries& series, const std::filesystem::path& directory);

}  // namespace twinchute::compare
