#include "study/campaign/rare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "lib/cli/loaded_library.hpp"
#include "study/campaign/engine.hpp"
#include "study/campaign/random.hpp"

namespace twinchute::study {
namespace {

struct Interrupted {};

/// The metric of an answer at points of a simulation, and what becomes of its runs.
class MetricAt {
public:
    MetricAt(const Engine& engine, const AnswerSpec& answer, RareEvent& event)
        : engine_(engine),
          column_(*engine.columns.of(answer.metric)),
          width_(engine.columns.first_metric() + engine.columns.metrics.size()),
          no_hit_(answer.above ? -1e300 : 1e300),
          event_(event) {}

    void operator()(std::span<const double> points, std::span<double> values) {
        engine_.scores = points;
        rows_.resize(values.size() * width_);
        if (!engine_.run_at_scores(rows_)) throw Interrupted();
        for (std::size_t i = 0; i < values.size(); ++i) {
            const double value = rows_[i * width_ + column_];
            event_.failed += std::isnan(value) ? 1 : 0;
            values[i] = std::isnan(value) ? no_hit_ : value;
        }
        event_.runs += values.size();
    }

private:
    Engine engine_;
    std::size_t column_, width_;
    double no_hit_;
    RareEvent& event_;
    std::vector<double> rows_;
};

/// Sums of the inputs at the points of an event.
void add_inputs(const CampaignSpec& spec, std::span<const double> points, std::vector<double>& sums) {
    Design design(spec);
    std::vector<double> values(spec.inputs.size());
    sums.resize(values.size());
    for (std::size_t at = 0; at < points.size(); at += values.size()) {
        design.values_at(points.subspan(at, values.size()), values);
        for (std::size_t k = 0; k < values.size(); ++k)
            sums[k] += values[k];
    }
}

}  // namespace

std::optional<RareEvent> estimate_rare(const Engine& engine, const AnswerSpec& answer, std::size_t number) {
    RareEvent event;
    SubsetTask task;
    task.dimensions = engine.spec.inputs.size();
    task.block = engine.spec.runs / (10 * simulations);
    task.above = answer.above;
    task.threshold = answer.threshold;
    task.at = MetricAt(engine, answer, event);
    Moments moments;
    std::size_t points = 0;
    for (std::uint64_t i = 0; i < simulations; ++i) {
        task.seed =
            random_bits(engine.spec.seed, i, static_cast<std::uint32_t>(number), RandomStream::subsets);
        SubsetEstimate found;
        try {
            found = simulate_subsets(task);
        } catch (const Interrupted&) {
            return std::nullopt;
        }
        if (!found.gave_up.empty()) {
            event.gave_up = found.gave_up;
            event.inputs.clear();
            return event;
        }
        if (found.probability <= least_probability) {
            event.value = {0.0, 0.0, least_probability};
            event.levels = found.levels;
            event.inputs.clear();
            return event;
        }
        moments.add(found.probability);
        event.levels = std::max(event.levels, found.levels);
        add_inputs(engine.spec, found.points, event.inputs);
        points += found.points.size() / task.dimensions;
    }
    for (double& input : event.inputs)
        input /= static_cast<double>(points);
    event.value = mean_interval(moments);
    event.value.low = std::max(0.0, event.value.low);
    return event;
}

#ifdef TWINCHUTE_OPENTURNS

bool has_subset_simulation() {
    return true;
}

SubsetEstimate simulate_subsets(const SubsetTask& task) {
    using Simulate = void (*)(const SubsetTask&, SubsetEstimate&);
    static const Simulate simulate = [] {
        const LoadedFunction loaded =
            load_function(TWINCHUTE_OPENTURNS, "study", "twinchute_simulate_subsets");
        if (!loaded.function)
            throw std::runtime_error(
                fmt::format("{} cannot be loaded ({}), install Debian's libopenturns0.21 or build again",
                            TWINCHUTE_OPENTURNS, loaded.complaint));
        return reinterpret_cast<Simulate>(loaded.function);
    }();
    SubsetEstimate found;
    simulate(task, found);
    return found;
}

#else

bool has_subset_simulation() {
    return false;
}

SubsetEstimate simulate_subsets(const SubsetTask&) {
    throw std::logic_error("subset simulation is not in this build");
}

#endif

}  // namespace twinchute::study
