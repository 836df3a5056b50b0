#include "compare/validate/run_suite.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "compare/parallel.hpp"
#include "compare/validate/case_scene.hpp"
#include "compare/validate/series_run.hpp"
#include "lib/cli/exit_code.hpp"
#include "lib/scene/keys.hpp"
#include "lib/scene/nearest.hpp"
#include "lib/solve/hand_over.hpp"
#include "lib/solve/stopwatch.hpp"

namespace twinchute::compare {
namespace {

/// Answer of a run to the rows of its case.
struct Prediction {
    std::vector<std::optional<double>> values;  ///< by row
    std::string failure;                        ///< of the run; empty: it ended well
};

/// Spread of predictions by row.
struct Spread {
    std::vector<std::optional<double>> middle, low, high, sigma;
};

class CaseRun {
public:
    CaseRun(const ValidationCase& one, const CaseScene& scenes, std::optional<std::size_t> line,
            const Fidelity& fidelity, std::span<const Fidelity* const> others,
            const ValidationOptions& options)
        : case_(one), scenes_(scenes), line_(line), fidelity_(fidelity), others_(others), options_(options) {}

    std::vector<RowResult> results() {
        const Scene nominal = scenes_.scene(line_);
        std::vector<RowResult> rows;
        for (const ExpectedRow& row : case_.rows)
            rows.push_back(begin_row(row));
        if (const auto lacking = fidelity_.unsupported_keys(nominal); !lacking.empty()) {
            for (RowResult& row : rows)
                row.verdict = RowVerdict::not_run,
                row.why = fmt::format("the {} lacks the physics of {}", fidelity_.title, lacking.front());
            return of_this_fidelity(std::move(rows));
        }
        if (case_.fit) {
            const std::string trouble = fit(rows.front());
            if (!trouble.empty()) {
                for (std::size_t i = 0; i < rows.size(); ++i) {
                    rows[i].verdict = verdict_of(rows[i], case_.rows[i], false);  // nothing is predicted
                    rows[i].why = trouble;
                }
                return of_this_fidelity(std::move(rows));
            }
        }
        if (case_.calibration) calibrate();
        predict(rows);
        if (case_.calibration) {
            const Spread spread = spread_of(run_all(draws_));
            for (std::size_t i = 0; i < rows.size(); ++i)
                rows[i].sigma_inputs = spread.sigma[i];
        }
        const Scene found = fitted_.empty() ? nominal : scenes_.scene(line_, fitted_);
        if (!case_.uncertain.empty()) propagate(rows, found);
        if (case_.bracket) bracket(rows, found);
        for (std::size_t i = 0; i < rows.size(); ++i)
            judge(rows[i], case_.rows[i], i == 0 && case_.fit);
        return of_this_fidelity(std::move(rows));
    }

    /// Inputs that results() calibrated; empty: none.
    const std::string& calibration() const { return calibration_text_; }

private:
    std::vector<RowResult> of_this_fidelity(std::vector<RowResult> rows) const {
        std::vector<RowResult> kept;
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const auto& wanted = case_.rows[i].fidelities;
            if (wanted.empty() || std::ranges::find(wanted, fidelity_.name) != wanted.end())
                kept.push_back(std::move(rows[i]));
        }
        return kept;
    }

    RowResult begin_row(const ExpectedRow& row) const {
        RowResult result;
        result.name = case_.name;
        result.fidelity = fidelity_.name;
        result.quantity = quantity_words(row.quantity, row.arguments);
        const std::string_view unit = quantity_unit(row.quantity);
        result.unit = unit == "1" ? "" : unit == "g0" ? "g" : unit;
        result.line = scenes_.line_number(line_);
        result.expected = scenes_.expected(row, line_);
        result.source = row.source, result.grade = row.grade, result.where = row.where;
        result.note = row.note, result.group = row.group;
        return result;
    }

    /// Runs the case with each of these on top.
    std::vector<Prediction> run_all(const std::vector<std::vector<std::string>>& changes) const {
        std::vector<Prediction> all(changes.size());
        in_parallel(changes.size(), options_.threads, [&](std::size_t i) {
            std::vector<std::string> more = fitted_;
            more.insert(more.end(), changes[i].begin(), changes[i].end());
            const Scene scene = scenes_.scene(line_, more);
            Run run;
            run.stop = options_.stop;
            const RunRecord record = run_scene(fidelity_, scene, run, others_);
            if (twinchute::exit_code(record.status.code) != ExitCode::done &&
                record.status.code != StatusCode::interrupted)
                all[i].failure = fmt::format("{}: {}", status_name(record.status.code), record.status.detail);
            for (const ExpectedRow& row : case_.rows)
                all[i].values.push_back(quantity_value(row.quantity, record, scene, row.arguments));
        });
        return all;
    }

    /// By row; nothing for a row that a run does not give.
    Spread spread_of(const std::vector<Prediction>& predictions) const {
        Spread spread;
        for (std::size_t row = 0; row < case_.rows.size(); ++row) {
            std::vector<double> values;
            for (const Prediction& one : predictions)
                if (one.values[row]) values.push_back(*one.values[row]);
            const bool whole = values.size() == predictions.size();
            const auto put = [&](auto& list, auto&& value) {
                list.push_back(whole ? std::optional<double>(value()) : std::nullopt);
            };
            put(spread.middle, [&] { return median(values); });
            put(spread.low, [&] { return *std::ranges::min_element(values); });
            put(spread.high, [&] { return *std::ranges::max_element(values); });
            put(spread.sigma, [&] { return standard_deviation(values); });
        }
        return spread;
    }

    void predict(std::vector<RowResult>& rows) const {
        // Noise is a matter of the structure; a model without one runs once.
        const Key& seed = *find_key(scene_keys(), "full.noise.seed");
        const bool many = case_.seeds > 0 && user_name(seed.user) == fidelity_.name;
        std::vector<std::vector<std::string>> changes;
        for (int i = 1; many && i <= (options_.quick ? quick_seeds : case_.seeds); ++i)
            changes.push_back({fmt::format("{}={}", seed.path, i)});
        if (!many) changes.emplace_back();
        const std::vector<Prediction> runs = run_all(changes);
        const Spread spread = spread_of(runs);
        const auto failed =
            std::ranges::find_if(runs, [](const Prediction& p) { return !p.failure.empty(); });
        for (std::size_t i = 0; i < rows.size(); ++i) {
            rows[i].predicted = spread.middle[i];
            if (many) rows[i].low = spread.low[i], rows[i].high = spread.high[i];
            if (many)
                rows[i].why =
                    changes.size() == 1 ? "one seed" : fmt::format("median of {} seeds", changes.size());
            if (failed != runs.end()) rows[i].predicted.reset(), rows[i].why = failed->failure;
        }
    }

    double nominal_of(const Scene& scene, const std::string& key) const {
        const auto input = std::ranges::find(scene.inputs, key, &Input::key);
        const auto* value = input == scene.inputs.end() ? nullptr : std::get_if<double>(&input->value);
        if (!value)
            throw SceneError(case_.place, key, "is no number of this scene", "", "name a key that it gives");
        return *value;
    }

    void propagate(std::vector<RowResult>& rows, const Scene& nominal) const {
        const auto count = static_cast<std::size_t>(options_.quick ? quick_samples : most_samples);
        std::vector<std::vector<std::string>> changes(count);
        unsigned long seed = 0;
        for (const auto& [key, sigma] : case_.uncertain) {
            const double middle = nominal_of(nominal, key);
            const double width = sigma.relative ? sigma.value * std::abs(middle) : sigma.value;
            const std::vector<double> z = normal_numbers(count, ++seed);
            for (std::size_t i = 0; i < count; ++i)
                changes[i].push_back(fmt::format("{}={}", key, middle + width * z[i]));
        }
        const Spread spread = spread_of(run_all(changes));
        for (std::size_t i = 0; i < rows.size(); ++i)  // beside those of a calibration
            if (const auto& sigma = spread.sigma[i])
                rows[i].sigma_inputs = std::hypot(rows[i].sigma_inputs.value_or(0.0), *sigma);
    }

    void bracket(std::vector<RowResult>& rows, const Scene& nominal) const {
        const auto& [key, share] = *case_.bracket;
        const double middle = nominal_of(nominal, key);
        const Spread spread = spread_of(run_all({{fmt::format("{}={}", key, middle * (1.0 - share))},
                                                 {fmt::format("{}={}", key, middle * (1.0 + share))}}));
        for (std::size_t i = 0; i < rows.size(); ++i)
            rows[i].low = spread.low[i], rows[i].high = spread.high[i];
    }

    /// Looks for the largest value of the key at which the first row is met. Returns why there is none.
    std::string fit(const RowResult& row) {
        constexpr int pieces = 32;
        const ValidationCase::Fit& wanted = *case_.fit;
        const double step = std::log(wanted.low / wanted.high) / pieces;
        const auto key_at = [&](double value) { return fmt::format("{}={}", wanted.key, value); };
        const auto excess = [&](const Prediction& p) {
            return p.values.front() && p.failure.empty()
                       ? std::optional<double>(*p.values.front() - *row.expected)
                       : std::nullopt;
        };
        if (!row.expected) return "there is no expected value to fit to";
        std::vector<double> places;
        std::vector<std::vector<std::string>> changes;
        for (int i = 0; i <= pieces; ++i) {
            places.push_back(wanted.high * std::exp(step * i));
            changes.push_back({key_at(places.back())});
        }
        const std::vector<Prediction> runs = run_all(changes);
        for (std::size_t i = 1; i < runs.size(); ++i) {
            const auto before = excess(runs[i - 1]), here = excess(runs[i]);
            if (!before || !here || (*before > 0.0) == (*here > 0.0)) continue;
            double a = places[i - 1], b = places[i];
            for (int n = 0; n < 40; ++n) {
                const double middle = std::sqrt(a * b);
                const auto there = excess(run_all({{key_at(middle)}}).front());
                if (!there) return "a run between two that ended well did not";
                ((*there > 0.0) == (*before > 0.0) ? a : b) = middle;
            }
            fitted_ = {key_at(b)};
            fit_text_ = fmt::format("{} = {:.3g}", wanted.key, b);
            return {};
        }
        return fmt::format("no {} from {:g} to {:g} gives the expected value", wanted.key, wanted.low,
                           wanted.high);
    }

    void calibrate() {
        if (!options_.calibrate)
            throw SceneError(case_.place, "case.calibrate", "nothing calibrates here",
                             "only `twinchute validate` brings what does", "run it there");
        std::vector<std::string> tests;
        for (const std::string& name : case_.calibration->to)
            tests.push_back(scenes_.file(name, "case.calibrate.to").string());
        CalibratedCase found = options_.calibrate(
            [this](const std::vector<std::string>& more) { return scenes_.before_set(more); }, tests,
            case_.calibration->vary, options_.quick ? quick_samples : most_samples);
        fitted_ = std::move(found.values);
        draws_ = std::move(found.draws);
        calibration_text_ = std::move(found.text);
    }

    void judge(RowResult& row, const ExpectedRow& asked, bool was_fitted) const {
        const auto amount = [&](const std::optional<Tolerance>& given) -> std::optional<double> {
            if (!given || !row.expected) return {};
            return given->relative ? given->value * std::abs(*row.expected) : given->value;
        };
        row.sigma_measured = amount(asked.sigma);
        const double measured = row.sigma_measured.value_or(0.0);
        if (asked.tolerance)
            row.tolerance = amount(asked.tolerance);
        else if (case_.bracket)
            row.tolerance = measured;
        else if (asked.sigma)
            row.tolerance = 2.0 * std::hypot(measured, row.sigma_inputs.value_or(0.0));
        if (was_fitted) row.why = fit_text_;
        row.verdict = verdict_of(row, asked, was_fitted);
        if (!row.predicted && row.why.empty()) row.why = "the run does not give it";
        if (!row.expected && row.why.empty()) row.why = "there is no expected value";
    }

    RowVerdict verdict_of(const RowResult& row, const ExpectedRow& asked, bool was_fitted) const {
        if (was_fitted) return RowVerdict::fitted;
        if (!asked.judged || row.grade.starts_with('D') || row.grade.starts_with('R'))
            return RowVerdict::not_judged;
        if (!row.predicted || !row.expected || !row.tolerance) return RowVerdict::exceeded;
        const bool spans = case_.bracket && !asked.tolerance;
        if (spans && !(row.low && row.high)) return RowVerdict::exceeded;
        const double low = spans ? *row.low : *row.predicted, high = spans ? *row.high : *row.predicted;
        // Written so that a NaN is not within.
        const bool holds = *row.expected >= low - *row.tolerance && *row.expected <= high + *row.tolerance;
        return holds ? RowVerdict::within : RowVerdict::exceeded;
    }

    const ValidationCase& case_;
    const CaseScene& scenes_;
    std::optional<std::size_t> line_;
    const Fidelity& fidelity_;
    std::span<const Fidelity* const> others_;
    const ValidationOptions& options_;
    std::vector<std::string> fitted_;
    std::vector<std::vector<std::string>> draws_;
    std::string fit_text_, calibration_text_;
};

/// The rows of a case that is not run.
std::vector<RowResult> left_out(const ValidationCase& one, RowVerdict verdict, const std::string& why) {
    std::vector<RowResult> rows;
    for (const ExpectedRow& row : one.rows) {
        RowResult result;
        result.name = one.name;
        result.quantity = quantity_words(row.quantity, row.arguments);
        const std::string_view unit = quantity_unit(row.quantity);
        result.unit = unit == "1" ? "" : unit == "g0" ? "g" : unit;
        result.expected = row.expected;
        result.source = row.source, result.grade = row.grade, result.where = row.where,
        result.note = row.note;
        rows.push_back(std::move(result));
    }
    if (rows.empty()) rows.emplace_back().name = one.name;
    for (RowResult& row : rows) {
        row.verdict = verdict;
        row.why = why;
    }
    return rows;
}

/// The line "name, full: snatch time -0.485 s, switch time -0.23 s", of one run of a case; empty without such
/// rows.
std::string offsets_of(const ValidationCase& one, std::span<const RowResult> rows) {
    std::string text;
    for (const std::string& name : one.offsets) {
        const ExpectedRow& asked = *std::ranges::find(one.rows, name, &ExpectedRow::quantity);
        const std::string words = quantity_words(name, asked.arguments);
        const auto row = std::ranges::find(rows, words, &RowResult::quantity);
        if (row == rows.end() || !row->error()) continue;
        const std::string head = text.empty() ? fmt::format("{}, {}: ", one.name, row->fidelity) : ", ";
        text += fmt::format("{}{} {:+.3g}{}{}", head, words, *row->error(), row->unit.empty() ? "" : " ",
                            row->unit);
    }
    return text;
}

const Fidelity& fidelity_of(const ValidationCase& one, const std::string& name,
                            std::span<const Fidelity* const> fidelities) {
    const auto found = std::ranges::find(fidelities, name, &Fidelity::name);
    if (found != fidelities.end()) return **found;
    std::vector<std::string_view> names;
    for (const Fidelity* fidelity : fidelities)
        names.push_back(fidelity->name);
    throw SceneError(one.place, "case.fidelities", fmt::format("there is no fidelity '{}'", name), "",
                     suggest(name, names));
}

}  // namespace

SuiteResult run_suite(const ValidationSuite& suite, std::span<const Fidelity* const> fidelities,
                      const ValidationOptions& options, bool& interrupted) {
    const Stopwatch watch;
    SuiteResult result;
    result.name = suite.name, result.title = suite.title, result.about = suite.about;
    result.file = suite.file.string();
    result.evidence = suite.evidence;
    const auto add = [&](std::vector<RowResult> rows) {
        std::ranges::move(rows, std::back_inserter(result.rows));
    };
    for (std::size_t i = 0; i < suite.cases.size(); ++i) {
        const ValidationCase& one = suite.cases[i];
        if (options.progress)
            options.progress(
                {one.name, 0.0, static_cast<double>(i) / static_cast<double>(suite.cases.size())});
        const CaseScene scenes(suite, one);
        if (!one.what.empty()) result.remarks.push_back(fmt::format("{}: {}", one.name, one.what));
        if (!one.shown_by.empty()) {
            add(left_out(one, RowVerdict::by_test, one.shown_by));
            continue;
        }
        if (const std::string missing = scenes.missing(); !missing.empty()) {
            add(left_out(one, RowVerdict::not_run, "missing: " + missing));
            continue;
        }
        std::vector<RowResult> rows;
        std::vector<std::string> offsets;
        for (const std::string& name : one.fidelities) {
            if (one.is_series) {
                std::ranges::move(run_series(one, scenes, fidelity_of(one, name, fidelities), options),
                                  std::back_inserter(rows));
                continue;
            }
            for (const auto line : scenes.lines()) {
                CaseRun run(one, scenes, line, fidelity_of(one, name, fidelities), fidelities, options);
                std::vector<RowResult> of_run = run.results();
                if (!run.calibration().empty())
                    result.calibrations.push_back(fmt::format("{}: {}", one.name, run.calibration()));
                if (std::string text = offsets_of(one, of_run); !text.empty())
                    offsets.push_back(std::move(text));
                std::ranges::move(of_run, std::back_inserter(rows));
            }
        }
        interrupted = interrupted || options.stop.stop_requested();
        if (interrupted) break;
        add(std::move(rows));
        std::ranges::move(offsets, std::back_inserter(result.offsets));
    }
    result.seconds = watch.wall();
    return result;
}

}  // namespace twinchute::compare
