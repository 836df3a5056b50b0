// Histories that a drop test recorded, beside both models. How far they are from it is neither an error of
// numbers nor a gap between models, see test_reference.hpp: it is shown and not judged.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "compare/histories.hpp"

namespace twinchute::compare {

struct DropTestHistories {
    std::string file;                                  ///< as given
    std::map<std::string, Curve, std::less<>> curves;  ///< by channel of a record; [s] since release, SI
    std::vector<std::string> notes = {};               ///< what was left aside
    const Curve* find(std::string_view channel) const;
};

/// Reads a table as loggers and spreadsheets write it (read_logged_table): time, and at least one channel of
/// history_rows(); other columns are noted. `release` [s]: what its clock reads at release. Throws SceneError
/// with file and line.
DropTestHistories read_test_histories(std::string_view text, const std::string& file, double release = 0.0);

/// "force, speed, ...": the columns that a file may have beside the time.
std::string test_channels();

/// A measured history and how far two records are from it, over the time that all three have.
struct TestScore {
    const MetricRow* row = nullptr;
    double largest = 0.0;                     ///< of what was measured, in the row's unit
    std::array<std::optional<double>, 2> l2;  ///< by record: that of the difference over that of the test
};

/// In the order of history_rows(). A record without the channel, see curve_of(), or without time in common
/// with the test has no score. `records`: whose clocks begin at release, as the test's.
std::vector<TestScore> test_scores(const DropTestHistories& test,
                                   const std::array<const RunRecord*, 2>& records);

}  // namespace twinchute::compare
