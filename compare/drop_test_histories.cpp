#include "compare/drop_test_histories.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "lib/scene/csv_table.hpp"
#include "lib/scene/scene_error.hpp"

namespace twinchute::compare {
namespace {

constexpr double longest = 36000.0;  // [s]

std::vector<CsvColumn> columns() {
    std::vector<CsvColumn> known{{"time", "s", {-longest, longest}}};
    for (const MetricRow& row : history_rows())
        known.push_back({row.key, row.unit, {-1e9, 1e9}});
    return known;
}

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

DropTestHistories read_test_histories(std::string_view text, const std::string& file) {
    const CsvTable table = read_csv_table(text, file, columns());
    DropTestHistories test{file, {}};
    for (const MetricRow& row : history_rows())
        if (table.has(row.key)) test.curves.emplace(row.key, Curve{table.at("time"), table.at(row.key)});
    if (test.curves.empty())
        throw SceneError({file, 1, 1}, "", "there is nothing beside the time",
                         "a test is drawn over the histories of the runs",
                         fmt::format("the columns are time and any of {}", test_channels()));
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
