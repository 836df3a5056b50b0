#include "study/many_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <memory>
#include <set>

#include "compare/parallel.hpp"
#include "lib/cli/command.hpp"
#include "lib/scene/scene_error.hpp"

namespace twinchute::study {
namespace {

constexpr std::size_t runs_at_once = 4096;  // of one thread; a whole number of batches

bool is_whole_number(const Scene& base, const std::string& key) {
    std::string path = key;
    for (const Parachute& chute : base.parachutes)
        if (const std::string own = fmt::format("parachute.{}.", chute.name); key.starts_with(own))
            path = "parachute." + key.substr(own.size());
    const Key* row = find_key(scene_keys(), path);
    return row != nullptr && row->kind == KeyKind::integer;
}

class ManyRunsOf {
public:
    ManyRunsOf(const SceneWith& scene_with, const ManyInputs& inputs, const std::vector<std::string>& metrics,
               const Fidelity& fidelity, const std::stop_token& stop)
        : inputs_(inputs),
          metrics_(metrics),
          fidelity_(fidelity),
          stop_(stop),
          runs_(inputs.values.front().size()) {
        const Scene base = scene_with({});
        for (const std::string& key : inputs.keys)
            whole_.push_back(is_whole_number(base, key));
        require_whole();
        begin(scene_with);
        in_batches_ = fidelity.batches && fidelity.batches(varied_->base(), metrics);
        made_.metrics.assign(metrics.size(),
                             std::vector<double>(runs_, std::numeric_limits<double>::quiet_NaN()));
        made_.statuses.assign(runs_, StatusCode::interrupted);
        refusals_.resize((runs_ + runs_at_once - 1) / runs_at_once);
    }

    ManyRuns run(int threads) {
        compare::in_parallel(refusals_.size(), threads, [this](std::size_t part) { make_part(part); });
        made_.interrupted = stop_.stop_requested();
        for (const std::string& refusal : refusals_)
            if (made_.refusal.empty()) made_.refusal = refusal;
        return std::move(made_);
    }

private:
    void require_whole() const {
        for (std::size_t k = 0; k < whole_.size(); ++k)
            for (const double value : inputs_.values[k])
                if (whole_[k] && std::nearbyint(value) != value)
                    throw UsageError(fmt::format("{}: {:g} is no whole number (the key counts), round it",
                                                 inputs_.keys[k], value));
    }

    std::vector<KeyValue> values_at(std::size_t run) const {
        std::vector<KeyValue> values;
        values.reserve(whole_.size());
        for (std::size_t k = 0; k < whole_.size(); ++k)
            values.push_back(value_of(k, inputs_.values[k][run]));
        return values;
    }
    KeyValue value_of(std::size_t key, double value) const {
        return whole_[key] ? KeyValue(static_cast<std::int64_t>(value)) : KeyValue(value);
    }

    /// Putting values in is held against reading at both ends of each input and of each two. Runs that the
    /// scene must not have are refused one by one, all of them here.
    void begin(const SceneWith& scene_with) {
        std::set<std::size_t> ends;
        for (const std::vector<double>& values : inputs_.values) {
            const auto [low, high] = std::ranges::minmax_element(values);
            ends.insert({static_cast<std::size_t>(low - values.begin()),
                         static_cast<std::size_t>(high - values.begin())});
        }
        std::exception_ptr refused;
        for (const std::size_t run : ends) {
            try {
                if (varied_)
                    varied_->check(values_at(run));
                else
                    varied_ = std::make_unique<VariedScene>(scene_with, inputs_.keys, values_at(run));
            } catch (const SceneError&) {
                refused = std::current_exception();
            }
        }
        if (!varied_) std::rethrow_exception(refused);
        std::vector<KeyValue> low, high;
        for (std::size_t k = 0; k < inputs_.keys.size(); ++k) {
            const auto [least, most] = std::ranges::minmax_element(inputs_.values[k]);
            low.push_back(value_of(k, *least)), high.push_back(value_of(k, *most));
        }
        varied_->check_corners(low, high);
    }

    /// False where the scene must not have the values.
    bool put(Scene& scene, std::size_t run, std::size_t part) {
        try {
            varied_->put(scene, values_at(run));
            return true;
        } catch (const SceneError& error) {
            if (refusals_[part].empty()) refusals_[part] = fmt::format("run {}: {}", run, error.what());
            scene = varied_->base();
            return false;
        }
    }

    void make_part(std::size_t part) {
        const std::size_t first = part * runs_at_once, end = std::min(first + runs_at_once, runs_);
        const std::size_t step = in_batches_ ? fidelity_.batch : 1;
        std::vector<Scene> scenes(step, varied_->base());
        std::vector<double> values(step * metrics_.size());
        std::vector<StatusCode> statuses(step);
        std::vector<char> taken(step);
        for (std::size_t at = first; at < end && !stop_.stop_requested(); at += step) {
            // A last batch that is not full repeats its last run.
            for (std::size_t l = 0; l < step; ++l)
                taken[l] = put(scenes[l], std::min(at + l, runs_ - 1), part) ? 1 : 0;
            Run asked{stop_, {}};
            if (in_batches_)
                fidelity_.metrics_of_batch(scenes, asked, metrics_, values, statuses);
            else if (taken[0])
                statuses[0] = fidelity_.metrics(scenes[0], asked, metrics_, values).code;
            for (std::size_t l = 0; l < step && at + l < end; ++l) {
                made_.statuses[at + l] = taken[l] ? statuses[l] : StatusCode::refused;
                for (std::size_t m = 0; m < metrics_.size() && taken[l]; ++m)
                    made_.metrics[m][at + l] = values[l * metrics_.size() + m];
            }
        }
    }

    const ManyInputs& inputs_;
    const std::vector<std::string>& metrics_;
    const Fidelity& fidelity_;
    const std::stop_token& stop_;
    std::size_t runs_;
    std::vector<bool> whole_;
    std::unique_ptr<VariedScene> varied_;
    bool in_batches_ = false;
    ManyRuns made_;
    std::vector<std::string> refusals_;  // of each part
};

}  // namespace

ManyRuns run_many(const SceneWith& scene_with, const ManyInputs& inputs,
                  const std::vector<std::string>& metrics, const Fidelity& fidelity, int threads,
                  const std::stop_token& stop) {
    assert(fidelity.metrics && !inputs.keys.empty() && !inputs.values.front().empty());
    return ManyRunsOf(scene_with, inputs, metrics, fidelity, stop).run(threads);
}

}  // namespace twinchute::study
