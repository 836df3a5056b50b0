#include "study/campaign/multi_fidelity.hpp"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "study/campaign/random.hpp"

namespace twinchute::study {
namespace {

constexpr double two_sided = 0.5 * (1.0 - confidence);
constexpr std::size_t most_kept = 20'000;  // cheap runs by which the fit's uncertainty is judged
constexpr std::size_t bootstraps = 200, most_drawn = 1000;

Moments moments_of(const std::vector<double>& values) {
    Moments m;
    for (const double value : values)
        m.add(value);
    return m;
}

double mixed_squares(const Pairs& pairs, double cheap_mean, double dear_mean) {
    double sum = 0.0;
    for (std::size_t i = 0; i < pairs.count(); ++i)
        sum += (pairs.cheap[i] - cheap_mean) * (pairs.dear[i] - dear_mean);
    return sum;
}

/// A run of the cheap model.
struct CheapRun {
    double value = 0.0;
    std::vector<double> inputs;
    double score = 0.0;  ///< its draw from the standard normal distribution: scatter about the correction
};

struct Sample {
    std::vector<CheapRun> runs;
    std::uint64_t all = 0;  ///< that there are
    Moments moments;
    double largest = -std::numeric_limits<double>::infinity();
};

/// Value of the worst dear run: the largest of those there are, and of those that the cheap ones stand for.
double largest_dear(const Pairs& pairs, const Sample& sample) {
    double most = sample.largest;
    for (std::size_t i = 0; i < pairs.count(); ++i) {
        const double ratio = pairs.dear[i] / pairs.cheap[i];
        most = std::max({most, pairs.dear[i], ratio > 0.0 ? ratio * sample.largest : most});
    }
    return most;
}

/// P(dear above or below the threshold) of one cheap run.
double exceedance(const AnswerSpec& answer, const Correction& correction, const CheapRun& run) {
    const double ratio =
        (std::log(run.value / answer.threshold) + correction.at(run.inputs)) / correction.scatter;
    return answer.above ? gsl_cdf_ugaussian_P(ratio) : gsl_cdf_ugaussian_Q(ratio);
}

double quantile(std::vector<double>& values, double level) {
    const auto nth =
        values.begin() +
        static_cast<std::ptrdiff_t>(std::min(
            values.size() - 1, static_cast<std::size_t>(level * static_cast<double>(values.size()))));
    std::nth_element(values.begin(), nth, values.end());
    return *nth;
}

std::vector<double> corrected(const Correction& correction, const Sample& sample) {
    std::vector<double> values;
    for (const CheapRun& run : sample.runs)
        values.push_back(run.value * std::exp(correction.at(run.inputs) + correction.scatter * run.score));
    return values;
}

/// Estimate of an answer with this correction.
double estimate_with(const AnswerSpec& answer, const Correction& correction, const Sample& sample) {
    if (answer.kind == AnswerSpec::Kind::quantile) {
        std::vector<double> values = corrected(correction, sample);
        return quantile(values, answer.level);
    }
    double sum = 0.0;
    for (const CheapRun& run : sample.runs)
        sum += exceedance(answer, correction, run);
    return sum / static_cast<double>(sample.runs.size());
}

/// Some `wanted` of `all`. Drawn, not counted out: every 2^k-th point of Sobol's sequence lies in one slice
/// of the inputs.
bool is_drawn(std::uint64_t seed, std::uint64_t index, std::uint32_t drawing, std::uint64_t wanted,
              std::uint64_t all) {
    const double share = static_cast<double>(wanted) / static_cast<double>(all);
    return share >= 1.0 || unit_number(random_bits(seed, index, drawing, RandomStream::examples)) < share;
}

/// Variance of the logarithm of an estimate by drawing pairs again and again.
double fit_variance(const AnswerSpec& answer, const Pairs& pairs, const Sample& sample, std::uint64_t seed) {
    Moments logs;
    std::vector<std::size_t> take(pairs.count());
    Sample some;
    for (std::size_t i = 0; i < sample.runs.size(); ++i)
        if (is_drawn(seed, i, 2, most_drawn, sample.runs.size())) some.runs.push_back(sample.runs[i]);
    for (std::size_t b = 0; b < bootstraps; ++b) {
        for (std::size_t i = 0; i < take.size(); ++i)
            take[i] =
                random_bits(seed, b, static_cast<std::uint32_t>(i), RandomStream::bootstrap) % take.size();
        const auto correction = fit_correction(pairs, take);
        const double estimate = correction ? estimate_with(answer, *correction, some) : 0.0;
        if (estimate > 0.0) logs.add(std::log(estimate));
    }
    return logs.variance();
}

/// Variance of the logarithm of an estimate that the finite number of cheap runs leaves.
double sampling_variance(const AnswerSpec& answer, const Correction& correction, const Sample& sample,
                         double estimate) {
    const double runs = static_cast<double>(sample.all);
    if (answer.kind == AnswerSpec::Kind::probability) {
        Moments shares;
        for (const CheapRun& run : sample.runs)
            shares.add(exceedance(answer, correction, run));
        return shares.variance() / runs / (estimate * estimate);
    }
    std::vector<double> values = corrected(correction, sample);
    const double sd = std::sqrt(answer.level * (1.0 - answer.level) / runs);
    const double low = quantile(values, std::max(0.0, answer.level - sd)),
                 high = quantile(values, std::min(1.0 - 1e-12, answer.level + sd));
    const double half = 0.5 * std::log(high / low);
    return half * half;
}

/// missing: share of runs without the metric [-].
void correct_answer(PairedAnswer& answer, const Pairs& pairs, const Sample& sample, double missing,
                    std::uint64_t seed) {
    const auto correction = fit_correction(pairs);
    if (!correction || sample.runs.empty()) return;
    answer.scatter = correction->scatter;
    const double estimate = estimate_with(*answer.spec, *correction, sample);
    answer.value = {.estimate = estimate};
    answer.method = fmt::format("corrected ROM, scatter {:.2f} %", 100.0 * correction->scatter);
    if (!(estimate > 0.0)) return;
    const double variance = fit_variance(*answer.spec, pairs, sample, seed) +
                            sampling_variance(*answer.spec, *correction, sample, estimate);
    const double factor =
        std::exp(gsl_cdf_tdist_Qinv(two_sided, static_cast<double>(pairs.count() - 2)) * std::sqrt(variance));
    answer.value.low = estimate / factor;
    answer.value.high = estimate * factor;
    answer.worst = answer.value.high + missing;
    if (answer.spec->kind == AnswerSpec::Kind::probability) {
        answer.value.high = std::min(1.0, answer.value.high);
        return;
    }
    AnswerSpec higher = *answer.spec;
    higher.level += missing;
    answer.worst = higher.level < 1.0 ? estimate_with(higher, *correction, sample) * factor
                                      : std::numeric_limits<double>::infinity();
}

/// A limit is met only if it would be with the runs that lack the metric, of both models, as the worst.
void doubt_missing(PairedAnswer& answer, std::uint64_t dear, std::uint64_t dear_runs, std::uint64_t cheap,
                   std::uint64_t cheap_runs) {
    const std::string& metric = answer.spec->metric;
    std::vector<std::string> parts;
    if (dear < dear_runs)
        parts.push_back("of the full model, " + missing_text(dear_runs - dear, dear_runs, metric));
    if (cheap < cheap_runs)
        parts.push_back("of the reduced one, " + missing_text(cheap_runs - cheap, cheap_runs, metric));
    answer.note = fmt::format("{}", fmt::join(parts, "; "));
    if (parts.empty() || answer.verdict != Verdict::met || answer.worst <= *answer.spec->limit) return;
    answer.verdict = Verdict::undecided;
    answer.note += not_met_at_worst;
}

/// Plain estimate from values of one model.
Interval plain(const AnswerSpec& answer, std::vector<double> values) {
    if (answer.kind == AnswerSpec::Kind::mean) return mean_interval(moments_of(values));
    if (answer.kind == AnswerSpec::Kind::probability) {
        const auto hits = std::ranges::count_if(values, [&](double value) {
            return answer.above ? value > answer.threshold : value < answer.threshold;
        });
        return share_interval(static_cast<std::uint64_t>(hits), values.size());
    }
    if (values.empty()) return {};
    std::ranges::sort(values);
    const QuantileRanks ranks = quantile_ranks(answer.level, values.size());
    Interval found{.estimate = values[ranks.estimate]};
    if (ranks.low) found.low = values[*ranks.low];
    if (ranks.high) found.high = values[*ranks.high];
    return found;
}

}  // namespace

double Pairs::correlation() const {
    const Moments x = moments_of(cheap), y = moments_of(dear);
    return mixed_squares(*this, x.mean, y.mean) / std::sqrt(x.squares * y.squares);
}

Interval control_variate_mean(const Pairs& pairs, const Moments& cheap) {
    const Moments x = moments_of(pairs.cheap), y = moments_of(pairs.dear);
    if (pairs.count() < 4 || !(x.squares > 0.0)) return mean_interval(y);
    const double n = static_cast<double>(pairs.count());
    const double slope = mixed_squares(pairs, x.mean, y.mean) / x.squares, off = cheap.mean - x.mean;
    const double residual = std::max(0.0, y.squares - slope * slope * x.squares) / (n - 2.0);
    const double variance = residual * (1.0 / n + off * off / x.squares) +
                            slope * slope * cheap.variance() / static_cast<double>(cheap.count);
    const double estimate = y.mean + slope * off;
    const double half = gsl_cdf_tdist_Qinv(two_sided, n - 2.0) * std::sqrt(variance);
    return {estimate, estimate - half, estimate + half};
}

Interval control_variate_gain(const Pairs& pairs, std::uint64_t cheap_runs) {
    const double n = static_cast<double>(pairs.count()), r = pairs.correlation();
    const auto gain = [&](double correlation) {
        const double square = correlation * correlation;
        return 1.0 / (1.0 - square + square * n / static_cast<double>(cheap_runs));
    };
    if (pairs.count() < 5) return {.estimate = gain(r)};
    const double z = std::atanh(std::min(std::abs(r), 1.0 - 1e-15));
    const double half = gsl_cdf_ugaussian_Qinv(two_sided) / std::sqrt(n - 3.0);
    return {gain(r), gain(std::tanh(std::max(0.0, z - half))), gain(std::tanh(z + half))};
}

double best_cheap_runs(double correlation, double cost_ratio) {
    const double square = correlation * correlation;
    const double runs = std::sqrt(cost_ratio * square / (1.0 - square));
    return runs < 1.0 ? 1.0 : runs;
}

double Correction::at(std::span<const double> inputs) const {
    double sum = coefficients.front();
    for (std::size_t k = 1; k < coefficients.size(); ++k)
        sum += coefficients[k] * (inputs[k - 1] - centre[k - 1]) / spread[k - 1];
    return sum;
}

std::optional<Correction> fit_correction(const Pairs& pairs, std::span<const std::size_t> take) {
    std::vector<std::size_t> all(take.begin(), take.end());
    for (std::size_t i = 0; take.empty() && i < pairs.count(); ++i)
        all.push_back(i);
    if (all.size() < 4) return std::nullopt;
    const std::size_t inputs = pairs.inputs.front().size();
    Correction fit;
    for (std::size_t k = 0; k < inputs; ++k) {
        Moments m;
        for (const std::size_t i : all)
            m.add(pairs.inputs[i][k]);
        fit.centre.push_back(m.mean);
        fit.spread.push_back(m.variance() > 0.0 ? std::sqrt(m.variance()) : 1.0);
    }
    const bool linear = all.size() >= 3 * (inputs + 1);
    const auto n = static_cast<Eigen::Index>(all.size()),
               p = static_cast<Eigen::Index>(linear ? inputs + 1 : 1);
    Eigen::MatrixXd terms = Eigen::MatrixXd::Ones(n, p);
    Eigen::VectorXd ratio(n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const std::size_t pair = all[static_cast<std::size_t>(i)];
        if (!(pairs.cheap[pair] > 0.0) || !(pairs.dear[pair] > 0.0)) return std::nullopt;
        ratio[i] = std::log(pairs.dear[pair] / pairs.cheap[pair]);
        for (Eigen::Index k = 1; k < p; ++k) {
            const auto input = static_cast<std::size_t>(k - 1);
            terms(i, k) = (pairs.inputs[pair][input] - fit.centre[input]) / fit.spread[input];
        }
    }
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(terms);
    const Eigen::VectorXd found = qr.solve(ratio);
    fit.coefficients.assign(found.begin(), found.end());
    const Eigen::VectorXd residual = ratio - terms * found;
    const Eigen::MatrixXd q = qr.householderQ() * Eigen::MatrixXd::Identity(n, qr.rank());
    double squares = 0.0;
    for (Eigen::Index i = 0; i < n; ++i) {
        const double left =
            1.0 - q.row(i).squaredNorm();  // of one that the fit follows wherever it goes: none
        const double out = left > 1e-9 ? residual[i] / left : 0.0;
        squares += out * out;
    }
    fit.scatter = std::max(1e-9, std::sqrt(squares / static_cast<double>(n)));
    return fit;
}

MultiFidelity combine(const CampaignSpec& spec, const RunStore& cheap, const Columns& cheap_columns,
                      const RunStore& dear, const Columns& dear_columns, std::uint64_t cheap_runs,
                      std::uint64_t dear_runs) {
    MultiFidelity both;
    both.pairs = dear_runs;
    both.pilot = std::min<std::uint64_t>(dear_runs, static_cast<std::uint64_t>(spec.pilot));
    each_run(dear, dear_columns, dear_runs,
             [&](std::uint64_t run, std::span<const double> row) { both.endings.add(dear, run, row[0]); });
    for (const AnswerSpec& answer : spec.answers) {
        if (answer.kind == AnswerSpec::Kind::ellipse) continue;
        const std::size_t of_cheap = *cheap_columns.of(answer.metric),
                          of_dear = *dear_columns.of(answer.metric);
        std::vector<double> dear_values(dear_runs, std::nan(""));
        std::uint64_t have = 0, dear_made = 0, cheap_made = 0;
        each_run(dear, dear_columns, dear_runs, [&](std::uint64_t run, std::span<const double> row) {
            dear_values[run] = row[of_dear];
            ++dear_made;
            have += std::isfinite(row[of_dear]) ? 1 : 0;
        });
        Pairs pairs;
        Sample sample;
        std::vector<double> cheap_values;
        each_run(cheap, cheap_columns, cheap_runs, [&](std::uint64_t run, std::span<const double> row) {
            const double value = row[of_cheap];
            ++cheap_made;
            if (!std::isfinite(value)) return;
            const std::vector<double> inputs(
                row.begin() + 1, row.begin() + 1 + static_cast<std::ptrdiff_t>(cheap_columns.inputs));
            sample.moments.add(value);
            sample.largest = std::max(sample.largest, value);
            ++sample.all;
            if (run < dear_runs && std::isfinite(dear_values[run])) {
                pairs.cheap.push_back(value);
                pairs.dear.push_back(dear_values[run]);
                pairs.inputs.push_back(inputs);
            }
            if (!is_drawn(spec.seed, run, 1, most_kept, cheap_runs)) return;
            const double u = unit_number(random_bits(spec.seed, run, 0xffffffffu, RandomStream::bootstrap));
            sample.runs.push_back({value, inputs, gsl_cdf_ugaussian_Pinv(u)});
            cheap_values.push_back(value);
        });
        PairedAnswer& found = both.answers.emplace_back();
        found.spec = &answer;
        found.cheap_runs = sample.all;
        found.correlation = pairs.count() > 2 ? pairs.correlation() : std::nan("");
        found.dear_alone = plain(answer, pairs.dear);
        found.cheap = plain(answer, std::move(cheap_values)).estimate;
        const double missing =
            2.0 - static_cast<double>(have) / static_cast<double>(dear_made) -
            static_cast<double>(sample.all) / static_cast<double>(cheap_made);  // shares of both
        if (answer.kind == AnswerSpec::Kind::mean) {
            found.cheap = sample.moments.mean;
            found.value = control_variate_mean(pairs, sample.moments);
            found.gain = control_variate_gain(pairs, sample.all);
            found.method = "control variate";
            const double most = largest_dear(pairs, sample);
            found.worst = found.value.high + missing * (most - found.value.high);
        } else {
            correct_answer(found, pairs, sample, missing, spec.seed);
        }
        found.verdict = verdict_of(answer, found.value);
        doubt_missing(found, have, dear_made, sample.all, cheap_made);
    }
    return both;
}

}  // namespace twinchute::study
