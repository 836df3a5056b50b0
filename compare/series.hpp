// The cases of a series side by side: results of each at one fidelity or both, as a table, as points of a
// plot, and as a page.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "compare/gap.hpp"
#include "compare/histories.hpp"
#include "compare/record_table.hpp"
#include "compare/render/plot.hpp"
#include "lib/record/file_batch.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::compare {

/// One fidelity of a case.
struct SeriesSide {
    RecordRow row;
    std::optional<double> energy_residual;  ///< [-] over the work of drag; absent where no energy is booked
    Curve force, speed;                     ///< over time since snatch; empty where the record has none
    double opening_end = 0.0;  ///< [s] on that clock: canopy filled, at the latest; 0 where it is not

    std::optional<double> value_of(const MetricRow& metric) const;
};

struct SeriesCase {
    std::string name, group;
    SeriesSide reference;
    std::optional<SeriesSide> candidate;  ///< absent in a series of one fidelity
    std::optional<double> gap;            ///< of the peak force [-], relative to the reference
    std::string verdict;                  ///< empty in a series of one fidelity
    std::string page = {};                ///< of the case, from the directory of the series; empty: none
};

/// A series that has been run.
struct CaseSeries {
    std::string title;
    std::string reference_title, candidate_title;  ///< e.g. "full aeroelastic model"; one may be empty
    SeriesSpec spec;
    std::vector<SeriesCase> cases;
    double wall_s = 0.0;  ///< of the whole series
};

/// Title and specification, from a scene of the series.
CaseSeries series_of(const Scene& scene);

SeriesCase series_case(const Scene& scene, const Comparison& comparison);
SeriesCase series_case(const Scene& scene, const RunRecord& record);

/// A line for each case: metrics of each fidelity, their gap, what the energy leaves over, wall times.
/// First line names, second line units; what a run does not have is an empty field.
std::string series_csv(const CaseSeries& series);

/// Table for reading, of what says most.
std::string series_markdown(const CaseSeries& series);

/// That table for a terminal, with the verdict of each case where two fidelities are compared.
std::string series_terminal(const CaseSeries& series, const Style& style);

/// spec.y against spec.x, cases of a group joined, with the points of a test where the scene names some.
Plot series_plot(const CaseSeries& series);

/// Opening force and speed of each case above each other, of the reference where there are two: a colour for
/// each group, or for each case where there are no groups.
std::vector<Plot> opening_plots(const CaseSeries& series);

/// The text of the page: the cases with links to their own pages, the plot, and the openings above each
/// other.
std::string series_html(const CaseSeries& series);

/// series.csv, .svg, .html and, as the marker, .md; of one fidelity e.g. series-rom.csv, so that a comparison
/// in the same directory keeps its own. Returns the page.
std::filesystem::path add_series(FileBatch& batch, const CaseSeries& series,
                                 const std::filesystem::path& directory);

}  // namespace twinchute::compare
