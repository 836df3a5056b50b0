// References of the levels of a ladder, and how far from them they are.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "compare/convergence.hpp"
#include "compare/ladder.hpp"

namespace twinchute::compare {
namespace {

std::optional<double> relative(double value, double reference) {
    if (reference == 0.0) return {};
    const double distance = std::abs(value - reference) / std::abs(reference);
    if (!std::isfinite(distance)) return {};
    return distance;
}

/// Rows of the table, then those of parachutes that any level has.
std::vector<const MetricRow*> rows_of(const Ladder& ladder) {
    std::vector<const MetricRow*> rows;
    for (const MetricRow& row : metric_rows())
        rows.push_back(&row);
    for (const LevelResult& result : ladder.levels)
        for (const LevelMetric& metric : result.metrics)
            if (std::ranges::find(rows, metric.row) == rows.end()) rows.push_back(metric.row);
    return rows;
}

/// The levels of a sequence that have a metric, coarsest first; no sequence gives nothing.
std::vector<LevelResult*> sequence_of(Ladder& ladder, std::string_view fidelity, std::string_view sequence,
                                      const MetricRow& row) {
    std::vector<LevelResult*> found;
    for (LevelResult& result : ladder.levels) {
        const bool member = !sequence.empty() && result.level.sequence == sequence;
        if (member && result.level.fidelity == fidelity && result.ended() && result.find(row.name) != nullptr)
            found.push_back(&result);
    }
    return found;
}

/// The sequence that leads to a fidelity's reference: the one that the scene as it is belongs to.
std::string_view main_sequence(const Ladder& ladder, std::string_view fidelity) {
    for (const LevelResult& result : ladder.levels)
        if (result.level.fidelity == fidelity && result.level.given) return result.level.sequence;
    return {};
}

std::optional<LadderReference> reference_of(Ladder& ladder, std::string_view fidelity, const MetricRow& row,
                                            const Scene& scene) {
    const std::string_view sequence = main_sequence(ladder, fidelity);
    const std::vector<LevelResult*> levels = sequence_of(ladder, fidelity, sequence, row);
    if (levels.empty()) return {};
    const LevelResult& finest = *levels.back();
    const LevelMetric& metric = *finest.find(row.name);
    LadderReference reference{fidelity,         &row, metric.value, metric.kind, finest.level.name,
                              finest.level.name};
    if (sequence != "mesh") return reference;
    if (levels.size() < 3) {
        reference.how += " (fewer than three meshes)";
        return reference;
    }
    std::array<double, 3> size{}, value{};
    std::string names;
    for (std::size_t i = 0; i < 3; ++i) {
        const LevelResult& level = *levels[levels.size() - 3 + i];
        size[i] = mesh_size(scene_of(level.level, scene));
        value[i] = level.find(row.name)->value;
        names += fmt::format("{}{}", i == 0 ? "" : ", ", level.level.label);
    }
    if (const auto exact = richardson(size, value)) {
        reference.value = exact->value;
        reference.level.clear();
        reference.how =
            fmt::format("Richardson extrapolation of {}, observed order {:.2g}", names, exact->order);
    } else {
        reference.how += is_monotone(value) ? " (the three finest are monotone, but of no order)"
                                            : " (the three finest meshes are not monotone)";
    }
    return reference;
}

const LadderReference* find_reference(const Ladder& ladder, std::string_view fidelity, const MetricRow* row) {
    const auto found = std::ranges::find_if(
        ladder.references, [&](const LadderReference& r) { return r.fidelity == fidelity && r.row == row; });
    return found == ladder.references.end() ? nullptr : &*found;
}

const LevelResult* given_level(const Ladder& ladder, std::string_view fidelity) {
    const auto found = std::ranges::find_if(ladder.levels, [&](const LevelResult& r) {
        return r.level.given && r.level.fidelity == fidelity && r.ended();
    });
    return found == ladder.levels.end() ? nullptr : &*found;
}

void add_errors(const Ladder& ladder, LevelResult& result) {
    if (result.level.physics == Physics::other) return;
    for (LevelMetric& metric : result.metrics) {
        const LadderReference* reference = find_reference(ladder, result.level.fidelity, metric.row);
        if (reference == nullptr || reference->level == result.level.name) continue;
        metric.error = relative(metric.value, reference->value);
    }
}

/// To the references of the other fidelities; a closed form has none of its own.
void add_gaps(const Ladder& ladder, LevelResult& result) {
    const bool closed = !result.level.metric.empty();
    for (LevelMetric& metric : result.metrics) {
        for (const std::string_view fidelity : ladder.fidelities) {
            if (!closed && fidelity == result.level.fidelity) continue;
            const LadderReference* reference = find_reference(ladder, fidelity, metric.row);
            if (reference == nullptr) continue;
            if (const auto gap = relative(metric.value, reference->value))
                metric.gaps.push_back({fidelity, *gap});
        }
    }
}

void add_effects(const Ladder& ladder, LevelResult& result) {
    if (result.level.physics == Physics::same || !result.level.metric.empty()) return;
    const LevelResult* given = given_level(ladder, result.level.fidelity);
    if (given == nullptr) return;
    for (LevelMetric& metric : result.metrics)
        if (const LevelMetric* complete = given->find(metric.row->name))
            metric.effect = relative(metric.value, complete->value);
}

/// Closed forms and levels without a physics effect as well: a test knows of no model.
void add_distances_to_test(const Ladder& ladder, LevelResult& result) {
    if (!ladder.test) return;
    for (LevelMetric& metric : result.metrics) {
        const auto measured = std::ranges::find(ladder.test->values, metric.row, &TestValue::row);
        if (measured == ladder.test->values.end()) continue;
        metric.to_test = relative(metric.value, measured->value);
        if (metric.to_test && (!result.to_test || *metric.to_test > result.to_test->value))
            result.to_test = Worst{*metric.to_test, metric.row->name};
    }
}

void add_estimates(Ladder& ladder, const MetricRow& row) {
    for (const std::string_view fidelity : ladder.fidelities) {
        for (const std::string_view sequence : {"tolerance", "mesh", "time step"}) {
            std::vector<LevelResult*> levels = sequence_of(ladder, fidelity, sequence, row);
            // The longest step is that of the scene as it is.
            if (sequence == "time step" && !levels.empty())
                for (LevelResult& result : ladder.levels)
                    if (result.level.given && result.level.fidelity == fidelity &&
                        result.find(row.name) != nullptr)
                        levels.insert(levels.begin(), &result);
            for (std::size_t i = 0; i < levels.size() && levels.size() > 1; ++i) {
                if (levels[i]->level.sequence != sequence) continue;
                const std::size_t other = i + 1 < levels.size() ? i + 1 : i - 1;
                LevelMetric& metric = *levels[i]->find(row.name);
                metric.estimate = relative(metric.value, levels[other]->find(row.name)->value);
            }
        }
    }
}

void take(std::optional<Worst>& worst, double value, std::string_view metric) {
    if (!worst || value > worst->value) worst = Worst{value, metric};
}

/// Sums up a level by its largest distance in what the ladder is judged by; an input of the model has no
/// error.
void sum_up(const Ladder& ladder, LevelResult& result) {
    for (const LevelMetric& metric : result.metrics) {
        const bool judged = std::ranges::count(ladder.judged, metric.row->name) > 0;
        if (!judged && result.level.metric.empty()) continue;
        for (const LadderGap& gap : metric.gaps) {
            auto at = std::ranges::find_if(result.gaps, [&](const auto& g) { return g.first == gap.to; });
            if (at == result.gaps.end())
                result.gaps.push_back({gap.to, Worst{gap.value, metric.row->name}});
            else if (gap.value > at->second.value)
                at->second = Worst{gap.value, metric.row->name};
        }
        if (metric.effect) take(result.effect, *metric.effect, metric.row->name);
        if (metric.kind == MetricKind::input) continue;
        if (metric.error) take(result.error, *metric.error, metric.row->name);
        if (metric.estimate) take(result.estimate, *metric.estimate, metric.row->name);
        const LadderReference* reference = find_reference(ladder, result.level.fidelity, metric.row);
        if (reference != nullptr && reference->level == result.level.name) result.is_reference = true;
    }
    // An error of some metrics only would flatter the level that is the reference in the others.
    if (result.is_reference) result.error.reset();
}

/// By default what two fidelities are judged by; where the scene ends before there is any of that, all that
/// it has.
void choose_judged(Ladder& ladder, std::span<const MetricRow* const> rows) {
    const auto occurs = [&](const MetricRow* row) {
        return std::ranges::find(ladder.references, row, &LadderReference::row) != ladder.references.end();
    };
    for (const MetricRow* row : rows)
        if (row->tolerance && occurs(row)) ladder.judged.push_back(row->name);
    if (!ladder.judged.empty()) return;
    for (const MetricRow* row : rows)
        if (row->show == Show::always && occurs(row)) ladder.judged.push_back(row->name);
}

void mark_fronts(Ladder& ladder) {
    for (const std::string_view fidelity : ladder.fidelities) {
        std::vector<LevelResult*> levels;
        std::vector<CostAndError> points;
        for (LevelResult& result : ladder.levels) {
            if (result.level.fidelity != fidelity || !result.error) continue;
            levels.push_back(&result);
            points.push_back({result.wall_s, result.error->value});
        }
        const std::vector<bool> front = pareto_front(points);
        for (std::size_t i = 0; i < levels.size(); ++i)
            levels[i]->on_front = front[i];
    }
}

}  // namespace

void evaluate(Ladder& ladder, const Scene& scene) {
    const std::vector<const MetricRow*> rows = rows_of(ladder);
    for (const std::string_view fidelity : ladder.fidelities)
        for (const MetricRow* row : rows)
            if (auto reference = reference_of(ladder, fidelity, *row, scene))
                ladder.references.push_back(std::move(*reference));
    choose_judged(ladder, rows);
    for (const MetricRow* row : rows)
        add_estimates(ladder, *row);
    for (LevelResult& result : ladder.levels) {
        add_errors(ladder, result);
        add_gaps(ladder, result);
        add_effects(ladder, result);
        add_distances_to_test(ladder, result);
        sum_up(ladder, result);
    }
    mark_fronts(ladder);
    if (ladder.fidelities.size() < 2) return;
    for (const std::string_view name : ladder.judged) {
        const MetricRow* row = find_metric_row(name);
        const LadderReference* one = find_reference(ladder, ladder.fidelities[0], row);
        const LadderReference* other = find_reference(ladder, ladder.fidelities[1], row);
        if (one == nullptr || other == nullptr) continue;
        if (const auto gap = relative(one->value, other->value)) take(ladder.gap, *gap, name);
    }
}

}  // namespace twinchute::compare
