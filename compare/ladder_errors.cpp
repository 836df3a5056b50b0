// What the rungs of a ladder are held against, and how far from it they are.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

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

/// The rungs of a sequence that have a metric, coarsest first; no sequence gives nothing.
std::vector<RungResult*> sequence_of(Ladder& ladder, std::string_view fidelity, std::string_view sequence,
                                     const MetricRow& row) {
    std::vector<RungResult*> found;
    for (RungResult& result : ladder.rungs) {
        const bool member = !sequence.empty() && result.rung.sequence == sequence;
        if (member && result.rung.fidelity == fidelity && result.ended() && result.find(row.name) != nullptr)
            found.push_back(&result);
    }
    return found;
}

/// The sequence that leads to a fidelity's reference: the one that the scene as it is belongs to.
std::string_view main_sequence(const Ladder& ladder, std::string_view fidelity) {
    for (const RungResult& result : ladder.rungs)
        if (result.rung.fidelity == fidelity && result.rung.given) return result.rung.sequence;
    return {};
}

std::optional<LadderReference> reference_of(Ladder& ladder, std::string_view fidelity, const MetricRow& row,
                                            const Scene& scene) {
    const std::string_view sequence = main_sequence(ladder, fidelity);
    const std::vector<RungResult*> rungs = sequence_of(ladder, fidelity, sequence, row);
    if (rungs.empty()) return {};
    const RungResult& finest = *rungs.back();
    const RungMetric& metric = *finest.find(row.name);
    LadderReference reference{fidelity,        &row, metric.value, metric.standing, finest.rung.name,
                              finest.rung.name};
    if (sequence != "mesh") return reference;
    if (rungs.size() < 3) {
        reference.how += " (fewer than three meshes)";
        return reference;
    }
    std::array<double, 3> size{}, value{};
    std::string names;
    for (std::size_t i = 0; i < 3; ++i) {
        const RungResult& rung = *rungs[rungs.size() - 3 + i];
        size[i] = mesh_size(scene_of(rung.rung, scene));
        value[i] = rung.find(row.name)->value;
        names += fmt::format("{}{}", i == 0 ? "" : ", ", rung.rung.label);
    }
    if (const auto exact = richardson(size, value)) {
        reference.value = exact->value;
        reference.rung.clear();
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

const RungResult* given_rung(const Ladder& ladder, std::string_view fidelity) {
    const auto found = std::ranges::find_if(ladder.rungs, [&](const RungResult& r) {
        return r.rung.given && r.rung.fidelity == fidelity && r.ended();
    });
    return found == ladder.rungs.end() ? nullptr : &*found;
}

void add_errors(const Ladder& ladder, RungResult& result) {
    if (result.rung.physics == Physics::other) return;
    for (RungMetric& metric : result.metrics) {
        const LadderReference* reference = find_reference(ladder, result.rung.fidelity, metric.row);
        if (reference == nullptr || reference->rung == result.rung.name) continue;
        metric.error = relative(metric.value, reference->value);
    }
}

/// To the references of the other fidelities; a closed form has none of its own.
void add_gaps(const Ladder& ladder, RungResult& result) {
    const bool closed = !result.rung.metric.empty();
    for (RungMetric& metric : result.metrics) {
        for (const std::string_view fidelity : ladder.fidelities) {
            if (!closed && fidelity == result.rung.fidelity) continue;
            const LadderReference* reference = find_reference(ladder, fidelity, metric.row);
            if (reference == nullptr) continue;
            if (const auto gap = relative(metric.value, reference->value))
                metric.gaps.push_back({fidelity, *gap});
        }
    }
}

void add_effects(const Ladder& ladder, RungResult& result) {
    if (result.rung.physics == Physics::same || !result.rung.metric.empty()) return;
    const RungResult* given = given_rung(ladder, result.rung.fidelity);
    if (given == nullptr) return;
    for (RungMetric& metric : result.metrics)
        if (const RungMetric* complete = given->find(metric.row->name))
            metric.effect = relative(metric.value, complete->value);
}

/// Closed forms and rungs without a piece as well: a test knows of no model.
void add_distances_to_test(const Ladder& ladder, RungResult& result) {
    if (!ladder.test) return;
    for (RungMetric& metric : result.metrics) {
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
            std::vector<RungResult*> rungs = sequence_of(ladder, fidelity, sequence, row);
            // The longest step is that of the scene as it is.
            if (sequence == "time step" && !rungs.empty())
                for (RungResult& result : ladder.rungs)
                    if (result.rung.given && result.rung.fidelity == fidelity &&
                        result.find(row.name) != nullptr)
                        rungs.insert(rungs.begin(), &result);
            for (std::size_t i = 0; i < rungs.size() && rungs.size() > 1; ++i) {
                if (rungs[i]->rung.sequence != sequence) continue;
                const std::size_t other = i + 1 < rungs.size() ? i + 1 : i - 1;
                RungMetric& metric = *rungs[i]->find(row.name);
                metric.estimate = relative(metric.value, rungs[other]->find(row.name)->value);
            }
        }
    }
}

void take(std::optional<Worst>& worst, double value, std::string_view metric) {
    if (!worst || value > worst->value) worst = Worst{value, metric};
}

/// What sums up a rung is its largest distance in what the ladder is judged by; an input of the model has no
/// error.
void sum_up(const Ladder& ladder, RungResult& result) {
    for (const RungMetric& metric : result.metrics) {
        const bool judged = std::ranges::count(ladder.judged, metric.row->name) > 0;
        if (!judged && result.rung.metric.empty()) continue;
        for (const LadderGap& gap : metric.gaps) {
            auto at = std::ranges::find_if(result.gaps, [&](const auto& g) { return g.first == gap.to; });
            if (at == result.gaps.end())
                result.gaps.push_back({gap.to, Worst{gap.value, metric.row->name}});
            else if (gap.value > at->second.value)
                at->second = Worst{gap.value, metric.row->name};
        }
        if (metric.effect) take(result.effect, *metric.effect, metric.row->name);
        if (metric.standing == Standing::input) continue;
        if (metric.error) take(result.error, *metric.error, metric.row->name);
        if (metric.estimate) take(result.estimate, *metric.estimate, metric.row->name);
        const LadderReference* reference = find_reference(ladder, result.rung.fidelity, metric.row);
        if (reference != nullptr && reference->rung == result.rung.name) result.is_reference = true;
    }
    // An error of some metrics only would flatter the rung that is the reference in the others.
    if (result.is_reference) result.error.reset();
}

/// By default what two fidelities are judged by; where the scene ends before there is any of that, all that
/// it has.
void choose_judged(Ladder& ladder) {
    const auto occurs = [&](const MetricRow& row) {
        return std::ranges::any_of(ladder.references,
                                   [&](const LadderReference& r) { return r.row == &row; });
    };
    for (const MetricRow& row : metric_rows())
        if (row.tolerance && occurs(row)) ladder.judged.push_back(row.name);
    if (!ladder.judged.empty()) return;
    for (const MetricRow& row : metric_rows())
        if (row.show == Show::always && occurs(row)) ladder.judged.push_back(row.name);
}

void mark_fronts(Ladder& ladder) {
    for (const std::string_view fidelity : ladder.fidelities) {
        std::vector<RungResult*> rungs;
        std::vector<CostAndError> points;
        for (RungResult& result : ladder.rungs) {
            if (result.rung.fidelity != fidelity || !result.error) continue;
            rungs.push_back(&result);
            points.push_back({result.wall_s, result.error->value});
        }
        const std::vector<bool> front = pareto_front(points);
        for (std::size_t i = 0; i < rungs.size(); ++i)
            rungs[i]->on_front = front[i];
    }
}

}  // namespace

void evaluate(Ladder& ladder, const Scene& scene) {
    for (const std::string_view fidelity : ladder.fidelities)
        for (const MetricRow& row : metric_rows())
            if (auto reference = reference_of(ladder, fidelity, row, scene))
                ladder.references.push_back(std::move(*reference));
    choose_judged(ladder);
    for (const MetricRow& row : metric_rows())
        add_estimates(ladder, row);
    for (RungResult& result : ladder.rungs) {
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
