#include "compare/run_reports.hpp"

#include "compare/report/html.hpp"
#include "compare/series.hpp"

namespace twinchute::compare {
namespace {

CaseSeries series_from(const std::vector<CaseRun>& runs, const Fidelity& fidelity) {
    CaseSeries series = series_of(*runs.front().scene);
    series.reference_title = fidelity.title;
    for (const CaseRun& run : runs) {
        SeriesCase& one = series.cases.emplace_back(series_case(*run.scene, run.record));
        if (run.record.status.code != StatusCode::refused) one.page = run.scene->case_name + "/run.html";
        series.wall_s += run.record.cost.wall_s;
    }
    return series;
}

}  // namespace

RunReports run_reports(const Fidelity& fidelity, bool is_reference) {
    RunReports reports;
    reports.page = [&fidelity, is_reference](const RunRecord& record, const ShapeFrames& frames) {
        return record_html(record, frames, fidelity.title, is_reference);
    };
    reports.add_series = [&fidelity](FileBatch& batch, const std::vector<CaseRun>& runs,
                                     const std::filesystem::path& directory) {
        return add_series(batch, series_from(runs, fidelity), directory);
    };
    reports.series_text = [&fidelity](const std::vector<CaseRun>& runs, const Style& style) {
        return series_terminal(series_from(runs, fidelity), style);
    };
    return reports;
}

}  // namespace twinchute::compare
