#include "compare/drop_test_histories.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "lib/scene/logged_table.hpp"
#include "lib/scene/scene_error.hpp"

namespace twinchute::compare {
namespace {

std::optional<double> distance(const Curve& test, const std::optional<Curve>& run) {
    if (!run) return {};
    const double from = std::max(test.time.front(), run->time.front()),
                 to = std::min(test.time.back(), run->time.back());
    if (!(to > from)) return {};
    const double size = l2_norm(cut(test, from, to));
    if (!(size > 0.0)) return {};
    return l2_norm(difference(*run, test, from, to)) / size;
}

}  // namespace

std::string test_channels() {
    std::string text;
    for (const MetricRow& row : history_rows())
        text += (text.empty() ? "" : ", ") + std::string(row.key);
    return text;
}

const Curve* DropTestHistories::find(std::string_view channel) const {
    const auto found = curves.find(channel);
    return found == curves.end() ? nullptr : &found->second;
}

DropTestHistories read_test_histories(std::string_view text, const std::string& file, double release) {
    const LoggedTable table = read_logged_table(text, file);
    std::vector<double> times = logged_times(table);
    for (double& time : times)
        time -= release;
    DropTestHistories test{file, {}, {}};
    for (const LoggedColumn& column : table.columns) {
        if (column.name == "time" || column.name == "t") continue;
        const auto row = std::ranges::find(history_rows(), column.name, &MetricRow::key);
        if (row == history_rows().end()) {
            test.notes.push_back(
                fmt::format("column '{}' is left aside: no history of that name", column.name));
            continue;
        }
        const auto [time, value] = logged_history(table, times, column, row->unit);
        if (time.size() > 1)
            test.curves.emplace(row->key, Curve{time, value});
        else
            test.notes.push_back(
                fmt::format("column '{}' is left aside: a curve needs two readings", column.name));
    }
    if (test.curves.empty())
        throw SceneError({file, table.head_line, 1}, "", "there is no history beside the time",
                         "a test is drawn over the histories of the runs",
                         fmt::format("the columns are time and any of {}", test_channels()));
    if (!(times.back() > 0.0))
        throw SceneError({file, table.lines.back(), 1}, "", "the history lies wholly before the release",
                         fmt::format("its last line is at {:g} s, time counts from release", times.back()),
                         "give the reading of its clock at release, --test-clock");
    return test;
}

std::vector<TestScore> test_scores(const DropTestHistories& test,
                                   const std::array<const RunRecord*, 2>& records) {
    std::vector<TestScore> scores;
    for (const MetricRow& row : history_rows()) {
        const Curve* measured = test.find(row.key);
        if (measured == nullptr) continue;
        TestScore score{&row, std::ranges::max(measured->value), {}};
        for (std::size_t s = 0; s < 2; ++s)
            score.l2[s] = distance(*measured, curve_of(*records[s], row.key));
        scores.push_back(score);
    }
    return scores;
}

}  // namespace twinchute::compare
