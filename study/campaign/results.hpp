// Results of a campaign: answers with their intervals, which input matters, what failed.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "study/campaign/rare.hpp"
#include "study/campaign/sensitivity_indices.hpp"
#include "study/campaign/spec.hpp"
#include "study/campaign/statistics.hpp"
#include "study/campaign/store.hpp"

namespace twinchute::study {

/// Columns of a store: status, inputs, metrics.
struct Columns {
    std::vector<std::string> metrics;  ///< keys in a record
    std::size_t inputs = 0;

    std::size_t first_metric() const { return 1 + inputs; }
    /// Place of a metric in a row; nothing where it is not kept.
    std::optional<std::size_t> of(std::string_view metric) const;
};

enum class Verdict {
    open,       ///< no limit
    met,        ///< the whole interval lies within it
    undecided,  ///< the limit lies inside the interval
    exceeded
};
std::string_view verdict_name(Verdict verdict);

/// Interval of an answer after so many runs.
struct TrailPoint {
    std::uint64_t runs = 0;
    Interval value = {};
};

struct Answer {
    const AnswerSpec* spec = nullptr;
    std::uint64_t count = 0;  ///< runs that have the metric
    std::uint64_t hits = 0;   ///< of a probability
    Interval value = {};      ///< of an ellipse its major half axis
    /// Upper end of `value`, were the runs without the metric the worst of all; of a mean, as bad as the
    /// worst of those that have it.
    std::optional<double> worst = {};
    std::optional<Ellipse> ellipse = {};
    std::vector<TrailPoint> trail = {};  ///< of probabilities and means
    Verdict verdict = Verdict::open;
    std::string method;                  ///< of the interval
    std::string note;                    ///< a sentence, may be empty
    std::optional<RareEvent> rare = {};  ///< empty: counted directly
};

/// Runs that ended in one way other than complete.
struct FailedRuns {
    std::uint64_t count = 0;
    std::vector<std::uint64_t> first = {};  ///< indices of some
};

/// Frequencies of a metric in equal parts from `low` to `high`.
struct Histogram {
    std::string metric;
    double low = 0.0, high = 0.0;
    Moments moments = {};
    std::vector<std::uint64_t> counts;
};

struct MetricIndices {
    std::string metric;
    std::vector<Index> of;  ///< each input
};

/// Calls take(run, row) for each of the first `runs` runs that is there, in order. Extremes of a run that
/// broke off (a failure, a limit) are not numbers: what they would have come to is not known.
void each_run(const RunStore& store, const Columns& columns, std::uint64_t runs,
              const std::function<void(std::uint64_t, std::span<const double>)>& take);

/// Counts runs by how they ended.
struct Endings {
    std::uint64_t complete = 0;
    std::map<std::string, FailedRuns> failed = {};

    void add(const RunStore& store, std::uint64_t run, double status);
};

struct CampaignResults {
    std::uint64_t wanted = 0, made = 0;
    std::uint64_t independent = 0;  ///< of those made: answers are from these
    Endings endings;
    std::vector<Answer> answers;
    std::vector<Histogram> histograms;
    std::vector<MetricIndices> indices;
    /// Rows of some runs, evenly spread, for pictures.
    std::vector<std::vector<double>> examples;
    bool has_landing = false;

    const Answer* find(std::string_view name) const;
};

/// Reads the chunks of the first `runs` runs of a store, some times over, in constant memory; runs that are
/// missing are counted.
CampaignResults evaluate(const CampaignSpec& spec, const RunStore& store, const Columns& columns,
                         std::uint64_t runs);

/// Probabilities and means alone, for a campaign that goes on until one is known well enough.
Interval interval_of(const CampaignSpec& spec, const AnswerSpec& answer, const RunStore& store,
                     const Columns& columns, std::uint64_t runs);

/// "29 of 40 runs have no peak force and do not count".
std::string missing_text(std::uint64_t missing, std::uint64_t runs, std::string_view metric);
/// Its end where the missing runs decide on the verdict.
inline constexpr auto not_met_at_worst = "; if they were the worst of all, the limit would not be met";

/// Judges the interval of an answer by its limit.
Verdict verdict_of(const AnswerSpec& spec, const Interval& value);

/// Puts simulations in the place of the share of hits, which stays where they gave up. A limit is not met
/// where some of their runs failed: rare events and failures are often one.
void take_simulation(Answer& answer, RareEvent event);

}  // namespace twinchute::study
