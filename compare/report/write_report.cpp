#include "compare/report/write_report.hpp"

#include "compare/report/gap_json.hpp"
#include "compare/report/html.hpp"
#include "compare/report/junit.hpp"
#include "compare/report/markdown.hpp"
#include "compare/report/plots.hpp"
#include "lib/record/checksum.hpp"
#include "lib/record/write_record.hpp"

namespace twinchute::compare {

void add_gap_files(FileBatch& batch, const Comparison& comparison, const std::filesystem::path& directory,
                   const LadderBeside& beside, const Trend* trend) {
    const PageSides sides = page_sides(comparison);
    const DropTestHistories* test = comparison.test ? &*comparison.test : nullptr;
    batch.add(directory / "force.svg", force_svg(sides, test));
    batch.add(directory / "speed.svg", speed_svg(sides, test));
    batch.add(directory / "report.md", report_markdown(comparison));
    batch.add(directory / "report.html", report_html(comparison, beside));
    batch.add(directory / "junit.xml", junit_xml(comparison, trend));
    batch.add(directory / "gap.json", with_checksum(gap_json(comparison)), FileBatch::Kind::marker);
}

void add_report(FileBatch& batch, const Comparison& comparison, const std::filesystem::path& directory,
                const LadderBeside& beside, const Trend* trend, CsvHead head) {
    add_record(batch, comparison.candidate, directory / comparison.candidate.fidelity,
               comparison.candidate_frames, head);
    add_record(batch, comparison.reference, directory / comparison.reference.fidelity,
               comparison.reference_frames, head);
    add_gap_files(batch, comparison, directory, beside, trend);
}

void write_report(const Comparison& comparison, const std::filesystem::path& directory,
                  const LadderBeside& beside) {
    FileBatch batch;
    add_report(batch, comparison, directory, beside);
    batch.commit();
}

}  // namespace twinchute::compare
