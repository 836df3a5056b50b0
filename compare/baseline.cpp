#include "compare/baseline.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "compare/records.hpp"
#include "compare/report/trend_text.hpp"
#include "compare/tolerances.hpp"
#include "lib/cli/output_dir.hpp"
#include "lib/cli/scene_command.hpp"
#include "lib/record/record_json.hpp"
#include "lib/scene/read_scene.hpp"

namespace twinchute::compare {

std::vector<Option> baseline_options() {
    return {{"baseline", "DIR", "hold every metric against an earlier comparison, too", false},
            {"baseline-tolerance", "METRIC=VALUE",
             "largest allowed change, e.g. peak_force=1%; 0.1 % for metrics that are judged", true}};
}

Baseline::Baseline(const Arguments& arguments, const std::vector<Scene>& scenes, const Fidelity& reference,
                   const Fidelity& candidate)
    : directory_(arguments.value("baseline")) {
    if (!directory_) {
        if (arguments.has("baseline-tolerance"))
            throw UsageError(
                "--baseline-tolerance without --baseline (there is nothing to hold against), "
                "name the directory of an earlier comparison with --baseline DIR");
        return;
    }
    const auto real = [](const std::filesystem::path& place) {
        std::error_code ignored;
        return (std::filesystem::weakly_canonical(place, ignored) / "").lexically_normal();
    };
    const std::filesystem::path out =
        real(arguments.value("out").value_or(default_output_dir(arguments.operand).string()));
    if (real(*directory_) == out)
        throw UsageError(fmt::format(
            "--baseline '{}' is where the results go (they would be the baseline of the next run), "
            "keep it elsewhere, or write the results to another directory with --out",
            *directory_));
    tolerances_ = read_tolerances(tolerance_overrides(arguments, "baseline-tolerance"));
    for (const Scene& scene : scenes) {
        const std::filesystem::path place = directory_of(scene, *directory_);
        Comparison before;
        before.candidate = record_of(place, candidate);
        before.reference = record_of(place, reference);
        before.gap = measure_gap(before.reference, before.candidate, {});
        before_.push_back(std::move(before));
    }
}

void Baseline::add_files(FileBatch& batch, const std::optional<Trend>& trend, const Comparison& now,
                         const std::filesystem::path& place) const {
    if (!trend) {
        for (const char* name : {"trend.md", "trend.json"})
            batch.remove(place / name);
        return;
    }
    batch.add(place / "trend.md", trend_markdown(*trend, *directory_, now.reference.scene.name));
    batch.add(place / "trend.json", json_text(trend_json(*trend, *directory_)));
}

}  // namespace twinchute::compare
