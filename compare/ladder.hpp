// Error against run time: the levels of a ladder, run, timed, and held against the reference of the same
// physics. The gap to other physics is kept beside that, never in it.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "compare/levels.hpp"
#include "compare/test_reference.hpp"
#include "lib/cli/exit_code.hpp"
#include "lib/record/metrics.hpp"
#include "lib/record/run_record.hpp"
#include "lib/solve/fidelity.hpp"

namespace twinchute::compare {

/// How far a value lies from the reference of another fidelity: relative, without sign.
struct LadderGap {
    std::string_view to;  ///< the fidelity
    double value = 0.0;
};

struct LevelMetric {
    const MetricRow* row = nullptr;
    double value = 0.0;            ///< median over seeds
    double low = 0.0, high = 0.0;  ///< over seeds
    MetricKind kind = MetricKind::result;
    /// Relative, against the reference of the same physics. Absent: other physics, no such reference, or the
    /// level is the reference.
    std::optional<double> error;
    /// Estimate of the level's own sequence, without the reference: relative difference from the next finer
    /// level, of the finest from the one before it.
    std::optional<double> estimate;
    std::vector<LadderGap> gaps;
    /// Effect of what is left out: relative difference from the scene as it is, on the same mesh, so that
    /// what both have of numerical error cancels.
    std::optional<double> effect;
    /// From what a test measured, where there is one: relative. Neither an error nor a gap.
    std::optional<double> to_test;
};

/// The largest of something over the metrics that a level is judged by.
struct Worst {
    double value = 0.0;
    std::string_view metric;
};

struct LevelResult {
    Level level;
    std::string setting;
    bool was_run = false;
    RunStatus status;  ///< of the run; of the first that did not end as it should where there are several
    int runs = 0;      ///< repeats and seeds
    int seeds = 1;
    double wall_s = 0.0;  ///< least of the repeats; median over seeds
    std::int64_t steps = 0, rhs_calls = 0;
    std::vector<LevelMetric> metrics;
    std::optional<Worst> error, estimate;
    std::vector<std::pair<std::string_view, Worst>> gaps;  ///< by fidelity
    std::optional<Worst> effect, to_test;
    bool on_front = false;      ///< of its fidelity: nothing is cheaper and as good
    bool is_reference = false;  ///< of its fidelity, in at least one judged metric

    const LevelMetric* find(std::string_view metric) const;
    LevelMetric* find(std::string_view metric);
    std::optional<Worst> gap_to(std::string_view fidelity) const;
    /// It ran and came to the end that the scene asks for.
    bool ended() const;
};

/// Reference of the levels of one fidelity in one metric.
struct LadderReference {
    std::string_view fidelity;
    const MetricRow* row = nullptr;
    double value = 0.0;
    MetricKind kind = MetricKind::result;
    std::string how;    ///< e.g. "Richardson extrapolation, order 1.9, of ..." or "rom, rtol 1e-13"
    std::string level;  ///< the one that is the reference itself; empty where it is extrapolated
};

struct Ladder {
    static constexpr int schema = 1;

    SceneId scene;
    std::vector<Input> inputs;  ///< of the scene as it is
    Provenance provenance;
    int threads = 1;
    bool quick = false;
    std::vector<std::string_view> fidelities;
    std::vector<std::string_view> judged;  ///< metrics, by name
    std::vector<LevelResult> levels;       ///< in the order of ladder_levels
    std::vector<LadderReference> references;
    std::optional<Worst> gap;  ///< between the references of the first two fidelities
    std::optional<TestReference> test = {};
};

struct LadderOptions {
    int seeds = 3;  ///< of scenes that start packed and have noise
    bool quick = false;
    int threads = 1;
    std::optional<TestReference> test = {};
};

/// Runs one scene; how is the caller's business (progress line, stop token).
using RunOne = std::function<RunRecord(const Fidelity&, const Scene&)>;

/// Runs all levels and evaluates them. An interrupted level is the last that is run.
Ladder climb(const Scene& scene, std::span<const Fidelity* const> fidelities, const LadderOptions& options,
             const RunOne& run);

/// Fills in references, errors, estimates, gaps and fronts from the metrics of the levels.
void evaluate(Ladder& ladder, const Scene& scene);

/// Errors that somebody may be content with, and their words.
inline constexpr std::array<std::pair<double, std::string_view>, 4> wanted_accuracies{
    {{1e-2, "1 %"}, {1e-3, "0.1 %"}, {1e-4, "1e-4"}, {1e-6, "1e-6"}}};

/// The cheapest level of a fidelity whose error is no larger than `wanted`, or null.
const LevelResult* cheapest(const Ladder& ladder, std::string_view fidelity, double wanted);

/// One line: which level to use for a wanted accuracy.
std::string advice(const Ladder& ladder);

/// 0; 130 where a level was interrupted; 3 where the scene as it is failed. Other levels that fail are rows.
ExitCode exit_code(const Ladder& ladder);

}  // namespace twinchute::compare
