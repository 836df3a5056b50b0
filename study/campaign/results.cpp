#include "study/campaign/results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <set>

#include "lib/record/run_record.hpp"
#include "study/campaign/design.hpp"
#include "study/campaign/quantiles.hpp"
#include "study/campaign/random.hpp"

namespace twinchute::study {
namespace {

// Of runs on average, four and a half deviations below the 400 dots of a plot.
constexpr double examples_drawn = 320.0;
constexpr std::size_t most_indices = 10;

bool is_complete(double status) {
    return status == static_cast<double>(StatusCode::completed) ||
           status == static_cast<double>(StatusCode::stopped_by_event);
}

/// It came to no end of its own. One that never opened came to the ground.
bool broke_off(double status) {
    return !is_complete(status) && status != static_cast<double>(StatusCode::not_opened);
}

bool is_hit(const AnswerSpec& answer, double value) {
    return answer.above ? value > answer.threshold : value < answer.threshold;
}

/// Whether a run is drawn by itself: in a block of Saltelli's design those after the first two share all
/// inputs but one with the first, and are for its indices alone.
bool is_independent(const CampaignSpec& spec, std::uint64_t run) {
    return spec.design != DesignKind::saltelli || run % saltelli_block(spec.inputs.size()) < 2;
}

/// An answer that is made while rows come by.
class Tally {
public:
    Tally(const AnswerSpec& spec, const Columns& columns)
        : spec_(spec),
          column_(columns.of(spec.metric)),
          east_(columns.of("landing_east_m")),
          north_(columns.of("landing_north_m")) {}

    void add(std::span<const double> row) {
        if (spec_.kind == AnswerSpec::Kind::ellipse) {
            if (!east_ || !north_ || std::isnan(row[*east_]) || std::isnan(row[*north_])) return;
            plane_.add({row[*east_], row[*north_]});
            return;
        }
        if (!column_ || std::isnan(row[*column_])) return;
        const double value = row[*column_];
        moments_.add(value);
        if (spec_.kind == AnswerSpec::Kind::probability && is_hit(spec_, value)) ++hits_;
        if (moments_.count < next_) return;
        trail_.push_back({moments_.count, value_now()});
        next_ = moments_.count + std::max<std::uint64_t>(1, moments_.count / 6);
    }

    Interval value_now() const {
        return spec_.kind == AnswerSpec::Kind::probability ? share_interval(hits_, moments_.count)
                                                           : mean_interval(moments_);
    }

    Answer answer() const {
        Answer answer;
        answer.spec = &spec_, answer.count = moments_.count, answer.hits = hits_;
        switch (spec_.kind) {
            case AnswerSpec::Kind::probability:
                answer.value = value_now();
                answer.trail = trail_;
                answer.method = hits_ == 0 || hits_ == moments_.count ? "Clopper-Pearson" : "Wilson";
                break;
            case AnswerSpec::Kind::mean:
                answer.value = value_now();
                answer.trail = trail_;
                answer.method = "Student's t";
                break;
            case AnswerSpec::Kind::ellipse:
                answer.count = plane_.count;
                answer.ellipse = normal_ellipse(plane_, spec_.level);
                answer.value = answer.ellipse->major;
                answer.method = "normal distribution";
                break;
            case AnswerSpec::Kind::quantile:
                answer.method = "order statistics";
                break;
        }
        return answer;
    }

private:
    const AnswerSpec& spec_;
    std::optional<std::size_t> column_, east_, north_;
    Moments moments_;
    std::uint64_t hits_ = 0, next_ = 16;
    PlaneMoments plane_;
    std::vector<TrailPoint> trail_;
};

/// Metrics that answers are about, each once; landing points are two.
std::vector<std::string> asked_metrics(const CampaignSpec& spec, const Columns& columns) {
    std::vector<std::string> all;
    const auto add = [&](const std::string& metric) {
        if (columns.of(metric) && std::ranges::count(all, metric) == 0) all.push_back(metric);
    };
    for (const AnswerSpec& answer : spec.answers) {
        if (answer.kind != AnswerSpec::Kind::ellipse) {
            add(answer.metric);
            continue;
        }
        add("landing_east_m");
        add("landing_north_m");
    }
    return all;
}

/// The first look at all rows.
void take_stock(const CampaignSpec& spec, const RunStore& store, const Columns& columns, std::uint64_t runs,
                std::vector<std::vector<double>>& kept, CampaignResults& results,
                std::vector<IndexEstimator>& estimators) {
    std::vector<Tally> tallies;
    for (const AnswerSpec& answer : spec.answers)
        tallies.emplace_back(answer, columns);
    std::vector<std::size_t> places;
    for (const Histogram& histogram : results.histograms)
        places.push_back(*columns.of(histogram.metric));
    // Drawn, not counted out: every 64th point of Sobol's sequence lies in one corner.
    const double share = examples_drawn / static_cast<double>(runs);
    const auto is_example = [&](std::uint64_t run) {
        return unit_number(random_bits(spec.seed, run, 0, RandomStream::examples)) < share;
    };
    each_run(store, columns, runs, [&](std::uint64_t run, std::span<const double> row) {
        ++results.made;
        results.endings.add(store, run, row[0]);
        for (std::size_t m = 0; m < estimators.size(); ++m)
            estimators[m].add(run, row.subspan(1, columns.inputs),
                              row[*columns.of(results.indices[m].metric)]);
        if (is_example(run)) results.examples.emplace_back(row.begin(), row.end());
        if (!is_independent(spec, run)) return;
        ++results.independent;
        for (Tally& tally : tallies)
            tally.add(row);
        for (std::size_t m = 0; m < results.histograms.size(); ++m) {
            Histogram& histogram = results.histograms[m];
            const double value = row[places[m]];
            if (!std::isfinite(value)) continue;
            if (histogram.moments.count == 0) histogram.low = histogram.high = value;
            histogram.moments.add(value);
            histogram.low = std::min(histogram.low, value);
            histogram.high = std::max(histogram.high, value);
            if (!kept.empty()) kept[m].push_back(value);
        }
    });
    for (const Tally& tally : tallies)
        results.answers.push_back(tally.answer());
}

/// Quantiles and histograms: shares of many narrow bins, then the numbers of those bins that matter.
void find_quantiles(const CampaignSpec& spec, const RunStore& store, const Columns& columns,
                    std::uint64_t runs, const std::vector<std::vector<double>>& kept,
                    CampaignResults& results) {
    std::vector<RankFinder> finders;
    for (const Histogram& histogram : results.histograms)
        finders.emplace_back(histogram.low, histogram.high, histogram.moments.count);
    const auto finder_of = [&](const Answer& answer) -> RankFinder* {
        for (std::size_t i = 0; i < finders.size(); ++i)
            if (results.histograms[i].metric == answer.spec->metric) return &finders[i];
        return nullptr;
    };
    const auto pass = [&](auto&& take) {
        if (!kept.empty()) {
            for (std::size_t i = 0; i < finders.size(); ++i)
                for (const double value : kept[i])
                    take(finders[i], value);
            return;
        }
        each_run(store, columns, runs, [&](std::uint64_t run, std::span<const double> row) {
            for (std::size_t i = 0; i < finders.size() && is_independent(spec, run); ++i)
                if (const double value = row[*columns.of(results.histograms[i].metric)]; std::isfinite(value))
                    take(finders[i], value);
        });
    };
    pass([](RankFinder& finder, double value) { finder.count(value); });
    std::vector<QuantileRanks> ranks;
    const auto rank_of_worst = [&](const Answer& answer, const RankFinder& finder) {
        const auto high = quantile_ranks(answer.spec->level, results.independent).high;
        return high && *high < finder.total() ? high : std::nullopt;
    };
    for (Answer& answer : results.answers) {
        RankFinder* finder = answer.spec->kind == AnswerSpec::Kind::quantile ? finder_of(answer) : nullptr;
        ranks.push_back(finder ? quantile_ranks(answer.spec->level, finder->total()) : QuantileRanks{});
        if (!finder || finder->total() == 0) continue;
        answer.count = finder->total();
        for (const auto rank : {std::optional(ranks.back().estimate), ranks.back().low, ranks.back().high,
                                rank_of_worst(answer, *finder)})
            if (rank) finder->want(*rank);
    }
    pass([](RankFinder& finder, double value) { finder.collect(value); });
    for (std::size_t i = 0; i < results.answers.size(); ++i) {
        Answer& answer = results.answers[i];
        RankFinder* finder = answer.spec->kind == AnswerSpec::Kind::quantile ? finder_of(answer) : nullptr;
        if (!finder || finder->total() == 0) continue;
        answer.value.estimate = finder->at(ranks[i].estimate);
        if (ranks[i].low) answer.value.low = finder->at(*ranks[i].low);
        if (ranks[i].high) answer.value.high = finder->at(*ranks[i].high);
        const auto worst = rank_of_worst(answer, *finder);
        answer.worst = worst ? finder->at(*worst) : infinity;
    }
    for (std::size_t i = 0; i < finders.size(); ++i)
        results.histograms[i].counts = finders[i].coarse(histogram_parts);
}

/// Share of the landing points that lie inside each ellipse.
void count_inside(const CampaignSpec& spec, const RunStore& store, const Columns& columns, std::uint64_t runs,
                  CampaignResults& results) {
    const auto east = columns.of("landing_east_m"), north = columns.of("landing_north_m");
    std::vector<Answer*> ellipses;
    for (Answer& answer : results.answers)
        if (answer.ellipse && answer.count > 2) ellipses.push_back(&answer);
    if (ellipses.empty() || !east || !north) return;
    std::vector<std::uint64_t> inside(ellipses.size());
    each_run(store, columns, runs, [&](std::uint64_t run, std::span<const double> row) {
        if (!is_independent(spec, run) || std::isnan(row[*east]) || std::isnan(row[*north])) return;
        for (std::size_t i = 0; i < ellipses.size(); ++i)
            inside[i] += ellipses[i]->ellipse->contains({row[*east], row[*north]}) ? 1 : 0;
    });
    for (std::size_t i = 0; i < ellipses.size(); ++i)
        ellipses[i]->ellipse->inside =
            static_cast<double>(inside[i]) / static_cast<double>(ellipses[i]->count);
}

}  // namespace

std::optional<std::size_t> Columns::of(std::string_view metric) const {
    const auto found = std::ranges::find(metrics, metric);
    if (found == metrics.end()) return std::nullopt;
    return first_metric() + static_cast<std::size_t>(found - metrics.begin());
}

void each_run(const RunStore& store, const Columns& columns, std::uint64_t runs,
              const std::function<void(std::uint64_t, std::span<const double>)>& take) {
    std::vector<std::size_t> extremes;
    for (std::size_t m = 0; m < columns.metrics.size(); ++m)
        if (is_extreme(columns.metrics[m])) extremes.push_back(columns.first_metric() + m);
    for (std::uint64_t chunk = 0; chunk < store.chunks_of(runs); ++chunk) {
        RunStore::Rows rows = store.read(chunk, store.rows_of(chunk, runs));
        for (std::size_t at = 0; at + store.columns() <= rows.size(); at += store.columns()) {
            const auto row = std::span(rows).subspan(at, store.columns());
            if (broke_off(row[0]))
                for (const std::size_t place : extremes)
                    row[place] = std::nan("");
            take(chunk * store.identity().chunk + at / store.columns(), row);
        }
    }
}

void Endings::add(const RunStore& store, std::uint64_t run, double status) {
    if (is_complete(status)) {
        ++complete;
        return;
    }
    FailedRuns& of_kind = failed[store.identity().statuses[static_cast<std::size_t>(status)]];
    if (++of_kind.count <= most_indices) of_kind.first.push_back(run);
}

std::string_view verdict_name(Verdict verdict) {
    constexpr std::array names{"no limit", "met", "undecided", "exceeded"};
    return names[static_cast<std::size_t>(verdict)];
}

const Answer* CampaignResults::find(std::string_view name) const {
    const auto found = std::ranges::find(answers, name, [](const Answer& a) { return a.spec->name; });
    return found == answers.end() ? nullptr : &*found;
}

Verdict verdict_of(const AnswerSpec& spec, const Interval& value) {
    if (!spec.limit) return Verdict::open;
    if (value.high <= *spec.limit) return Verdict::met;
    return value.low > *spec.limit ? Verdict::exceeded : Verdict::undecided;
}

void take_simulation(Answer& answer, RareEvent event) {
    if (!event.gave_up.empty()) {
        answer.note = fmt::format(
            "subset simulation gave up ({}), these are shares of the campaign's own runs", event.gave_up);
        return;
    }
    event.direct = answer.value;
    answer.value = event.value;
    answer.count = event.runs;
    answer.method = fmt::format("subset simulation, {} times", simulations);
    answer.verdict = verdict_of(*answer.spec, answer.value);
    if (answer.verdict == Verdict::met && event.failed > 0) answer.verdict = Verdict::undecided;
    answer.rare = std::move(event);
}

namespace {

/// Runs that are laid out, not drawn, say nothing of how far off their sums are.
void take_interval(Answer& answer) {
    const auto of_estimate = [](Interval& value) { value = {.estimate = value.estimate}; };
    of_estimate(answer.value);
    if (answer.ellipse) of_estimate(answer.ellipse->major), of_estimate(answer.ellipse->minor);
    answer.trail.clear();
    answer.method = "a grid has no interval";
}

/// Counts runs without the metric against a limit: a run without a descent rate may be the one that fell
/// fastest. A limit is met only if it would be with all of them as the worst; what the worst of a mean would
/// be, none can say, so that they are taken to be as bad as the `largest` there is.
void doubt_missing(Answer& answer, std::uint64_t runs, double largest) {
    if (answer.count >= runs || answer.count == 0) return;
    const std::uint64_t missing = runs - answer.count;
    answer.note = missing_text(missing, runs, answer.spec->metric);
    const double share = static_cast<double>(missing) / static_cast<double>(runs);
    if (answer.spec->kind == AnswerSpec::Kind::probability)
        answer.worst = share_interval(answer.hits + missing, runs).high;
    if (answer.spec->kind == AnswerSpec::Kind::mean)
        answer.worst = answer.value.high + share * (largest - answer.value.high);
    if (answer.verdict != Verdict::met || !answer.worst || *answer.worst <= *answer.spec->limit) return;
    answer.verdict = Verdict::undecided;
    answer.note += not_met_at_worst;
}

}  // namespace

std::string missing_text(std::uint64_t missing, std::uint64_t runs, std::string_view metric) {
    return fmt::format("{} of {} runs have no {} and do not count", missing, runs, metric_words(metric));
}

CampaignResults evaluate(const CampaignSpec& spec, const RunStore& store, const Columns& columns,
                         std::uint64_t runs) {
    CampaignResults results;
    results.wanted = runs;
    std::vector<IndexEstimator> estimators;
    for (const std::string& metric : asked_metrics(spec, columns)) {
        results.histograms.push_back({.metric = metric, .counts = {}});
        results.indices.push_back({metric, {}});
        estimators.emplace_back(spec);
    }
    // Numbers of the metrics that are asked about, where there is room; otherwise the runs are read again.
    constexpr std::uint64_t room = 4'000'000;
    std::vector<std::vector<double>> kept(runs * estimators.size() <= room ? estimators.size() : 0);
    take_stock(spec, store, columns, runs, kept, results, estimators);
    for (std::size_t m = 0; m < estimators.size(); ++m)
        results.indices[m].of = estimators[m].indices();
    find_quantiles(spec, store, columns, runs, kept, results);
    count_inside(spec, store, columns, runs, results);
    for (Answer& answer : results.answers) {
        if (spec.design == DesignKind::grid) take_interval(answer);
        answer.verdict = verdict_of(*answer.spec, answer.value);
        const auto of_metric = std::ranges::find(results.histograms, answer.spec->metric, &Histogram::metric);
        doubt_missing(answer, results.independent,
                      of_metric != results.histograms.end() ? of_metric->high : infinity);
        results.has_landing = results.has_landing || answer.ellipse;
    }
    return results;
}

Interval interval_of(const CampaignSpec& spec, const AnswerSpec& answer, const RunStore& store,
                     const Columns& columns, std::uint64_t runs) {
    if (answer.kind == AnswerSpec::Kind::quantile) {
        CampaignSpec one = spec;
        one.answers = {answer};
        return evaluate(one, store, columns, runs).answers.front().value;
    }
    Tally tally(answer, columns);
    each_run(store, columns, runs, [&](std::uint64_t run, std::span<const double> row) {
        if (is_independent(spec, run)) tally.add(row);
    });
    return tally.answer().value;
}

}  // namespace twinchute::study
