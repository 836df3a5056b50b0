// `compare --baseline DIR`: where the earlier comparison is read and the trend is written.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "compare/trend.hpp"
#include "lib/cli/command.hpp"
#include "lib/record/file_batch.hpp"
#include "lib/solve/fidelity.hpp"

namespace twinchute::compare {

/// --baseline DIR and --baseline-tolerance METRIC=VALUE.
std::vector<Option> baseline_options();

/// The comparisons of an earlier run, one a scene.
class Baseline {
public:
    /// Reads the records of all scenes, before anything runs: what is missing or broken costs nothing and
    /// changes nothing. Without --baseline there is none. Throws UsageError and RecordError.
    Baseline(const Arguments& arguments, const std::vector<Scene>& scenes, const Fidelity& reference,
             const Fidelity& candidate);

    bool asked() const { return directory_.has_value(); }
    const std::string& directory() const { return *directory_; }

    /// The trend of scene number `i`.
    Trend trend_of(std::size_t i, const Comparison& now) const {
        return measure_trend(before_[i], now, tolerances_);
    }

    /// Adds trend.md and trend.json to what a comparison writes in `place`. Without a trend those of an
    /// earlier run go: they would be of other records.
    void add_files(FileBatch& batch, const std::optional<Trend>& trend, const Comparison& now,
                   const std::filesystem::path& place) const;

private:
    std::optional<std::string> directory_;
    std::map<std::string, Tolerance> tolerances_;
    std::vector<Comparison> before_;
};

}  // namespace twinchute::compare
