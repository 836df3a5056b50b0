#include "compare/stability.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "compare/stability/cases.hpp"
#include "lib/scene/assemble.hpp"

namespace twinchute::compare {
namespace {

/// The complaint without the place in a file that does not exist.
std::string complaint(const SceneError& error) {
    const std::string text = error.what();
    const std::size_t at = error.key().empty() ? std::string::npos : text.find(error.key());
    return at == std::string::npos ? text : text.substr(at);
}

/// The least margin says how near the answer is to being wrong; a NaN is nearest of all.
const Finding* worst_of(const std::vector<Finding>& findings) {
    const auto worse = [](const Finding& a, const Finding& b) {
        if (a.holds() != b.holds()) return !a.holds();
        return a.margin() < b.margin();
    };
    const auto worst = std::ranges::min_element(findings, worse);
    return worst == findings.end() ? nullptr : &*worst;
}

/// `beside`: what the method on trial is held against, besides its case.
void judge_answer(StabilityCell& cell, const Trial& trial, const Check& beside) {
    if (!cell.row->check) {
        cell.verdict = CellVerdict::silently_wrong;
        cell.reason = "it was answered, although there is nothing to answer";
        return;
    }
    cell.findings = cell.row->check(trial);
    if (beside)
        for (Finding& finding : beside(trial))
            cell.findings.push_back(std::move(finding));
    const Finding* worst = worst_of(cell.findings);
    if (!worst) {
        cell.verdict = CellVerdict::silently_wrong;
        cell.reason = "its check looked at nothing";
        return;
    }
    cell.verdict = worst->holds() ? CellVerdict::stable : CellVerdict::silently_wrong;
    cell.reason = worst->what;
    cell.margin = worst->margin();
    cell.error = worst->error;
    cell.limit = worst->limit;
}

void judge_ending(StabilityCell& cell, const RunStatus& status, CellVerdict verdict) {
    const bool is_true = std::ranges::find(cell.row->causes, status.code) != cell.row->causes.end();
    cell.verdict = is_true ? verdict : CellVerdict::misnamed;
    cell.status = status_name(status.code);
    cell.reason = status.detail;
}

}  // namespace

std::string_view cell_verdict_name(CellVerdict verdict) {
    switch (verdict) {
        case CellVerdict::stable:
            return "stable";
        case CellVerdict::refused:
            return "refused";
        case CellVerdict::stopped:
            return "stopped";
        case CellVerdict::silently_wrong:
            return "silently wrong";
        case CellVerdict::misnamed:
            return "misnamed";
    }
    return "unknown";
}

bool is_failure(CellVerdict verdict) {
    return verdict == CellVerdict::silently_wrong || verdict == CellVerdict::misnamed;
}

std::optional<std::string> refusal(const StabilityCase& row, const Scene& scene, const Fidelity& fidelity) {
    try {
        if (!row.asked.empty()) {
            const std::string path = row.asked.substr(0, row.asked.find('='));
            const DocumentKind kind{{find_key(scene_keys(), path), 1}, "", InputOrigin::given, "", {}};
            const Values refuses_what_is_out_of_range(read_override(row.asked, kind), kind);
        }
        // Consistency of the keys is checked by the reader's own rules; the scene comes from no file.
        Scene copy = scene;
        check_scene(copy, {Values(Document{}, DocumentKind{})});
    } catch (const SceneError& error) {
        return complaint(error);
    }
    if (const auto keys = fidelity.unsupported_keys(scene); !keys.empty())
        return fmt::format("{} lacks the physics of {}", fidelity.title, keys.front());
    return std::nullopt;
}

std::optional<StabilityCell> judge(const StabilityCase& row, const StabilityMethod& method,
                                   const Fidelity& fidelity, std::stop_token stop) {
    StabilityCell cell;
    cell.row = &row;
    cell.method = method.name;
    Scene scene = row.base();
    scene.name = row.name;
    if (row.change) row.change(scene);
    method.choose(scene);
    if (auto why = refusal(row, scene, fidelity)) {
        judge_ending(cell, {StatusCode::refused, std::move(*why)}, CellVerdict::refused);
        return cell;
    }
    Run run;
    run.stop = stop;
    run.force_unstructured = method.force_unstructured;
    const RunRecord record = fidelity.run(scene, run);
    if (record.status.code == StatusCode::interrupted) return std::nullopt;
    cell.steps = record.cost.steps;
    cell.seconds = record.cost.wall_s;
    cell.status = status_name(record.status.code);
    const Trial trial{scene, record, fidelity, stop, method.force_unstructured};
    if (const Channel* time = record.find_channel("time"); time && !time->values.empty())
        cell.end = time->values.back();
    if (record.status.code == StatusCode::refused)
        judge_ending(cell, record.status, CellVerdict::refused);
    else if (is_numerical_failure(record.status.code)) {
        judge_ending(cell, record.status, CellVerdict::stopped);
        if (row.latency) cell.latency = row.latency(trial);
    } else
        judge_answer(cell, trial, method.check);
    if (stop.stop_requested()) return std::nullopt;  // what it is compared with may not be complete
    return cell;
}

const std::vector<StabilityCase>& stability_cases() {
    static const std::vector<StabilityCase> rows = [] {
        std::vector<StabilityCase> all = rom_cases();
        std::ranges::move(full_cases(), std::back_inserter(all));
        return all;
    }();
    return rows;
}

}  // namespace twinchute::compare
