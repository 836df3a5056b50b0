// Summary of the rows of a suite.
#include <algorithm>
#include <cmath>

#include "compare/validate/run_suite.hpp"

namespace twinchute::compare {

std::string_view row_verdict_name(RowVerdict verdict) {
    switch (verdict) {
        case RowVerdict::within:
            return "within";
        case RowVerdict::exceeded:
            return "exceeded";
        case RowVerdict::not_judged:
            return "not judged";
        case RowVerdict::fitted:
            return "fitted";
        case RowVerdict::not_run:
            return "not run";
        case RowVerdict::by_test:
            return "by test";
    }
    return "unknown";
}

std::optional<double> RowResult::error() const {
    if (!expected || !predicted) return {};
    return *predicted - *expected;
}

std::optional<double> RowResult::relative_error() const {
    const auto found = error();
    if (!found || *expected == 0.0) return {};
    return *found / std::abs(*expected);
}

int SuiteResult::count(RowVerdict verdict) const {
    return static_cast<int>(std::ranges::count(rows, verdict, &RowResult::verdict));
}

std::vector<GroupResult> SuiteResult::groups() const {
    std::vector<GroupResult> found;
    for (const RowResult& row : rows) {
        const bool compared = row.expected && row.predicted && row.verdict != RowVerdict::fitted &&
                              row.verdict != RowVerdict::not_run;
        if (row.group.empty() || !compared || row.grade.starts_with('D')) continue;
        auto group = std::ranges::find(found, row.group, &GroupResult::name);
        if (group == found.end()) group = found.insert(found.end(), GroupResult{row.group, {}, {}});
        group->rows.push_back(&row);
    }
    for (GroupResult& group : found) {
        std::vector<Pair> pairs;
        for (const RowResult* row : group.rows)
            pairs.push_back({*row->predicted, *row->expected,
                             std::hypot(row->sigma_measured.value_or(0.0) / *row->expected,
                                        row->sigma_inputs.value_or(0.0) / *row->predicted)});
        group.agreement = agreement(pairs);
    }
    return found;
}

bool Validation::failed() const {
    return std::ranges::any_of(suites, [this](const SuiteResult& suite) {
        return (suite.evidence == Evidence::exact || !exact_alone) && suite.count(RowVerdict::exceeded) > 0;
    });
}

}  // namespace twinchute::compare
