#include "study/calibrate/likelihood.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "lib/scene/scene_error.hpp"

namespace twinchute::study {
namespace {

constexpr double first_guess = 0.05;  // [-] of the largest reading: noise before anything is fitted
constexpr int most_offsets = 500, most_scanned = 150;

}  // namespace

FittedTest::FittedTest(const DropTest& measured, const Fidelity& fidelity, VariedScene varied)
    : test(measured), prediction(measured, fidelity), scene(std::move(varied)) {
    for (const MeasuredHistory& history : test.histories) {
        noise.push_back(
            {history.sigma.value_or(first_guess * history.largest()), 0.0, history.sigma.has_value()});
        if (!(noise.back().sigma > 0.0)) noise.back().sigma = 1.0;
        used.emplace_back(history.time.size(), true);
    }
}

Likelihood::Likelihood(std::vector<FittedTest>& tests, std::vector<Unknown> unknowns)
    : tests_(tests), unknowns_(std::move(unknowns)), last_(tests.size()) {}

Likelihood::Likelihood(std::vector<FittedTest>& tests, std::vector<Unknown> unknowns, std::size_t only)
    : tests_(tests), unknowns_(std::move(unknowns)), first_(only), last_(only + 1) {}

std::size_t Likelihood::readings() const {
    std::size_t count = 0;
    for (std::size_t t = first_; t < last_; ++t) {
        count += tests_[t].test.scalars.size();
        for (const std::vector<bool>& used : tests_[t].used)
            count += static_cast<std::size_t>(std::ranges::count(used, true));
    }
    return count;
}

std::size_t Likelihood::priors() const {
    return static_cast<std::size_t>(
        std::ranges::count_if(unknowns_, [](const Unknown& u) { return u.prior.has_value(); }));
}

bool Likelihood::all_sigma_given() const {
    for (std::size_t t = first_; t < last_; ++t)
        for (const Noise& noise : tests_[t].noise)
            if (!noise.given) return false;
    return true;
}

std::vector<double> Likelihood::keys_of(std::span<const double> values) const {
    std::vector<double> keys;
    for (std::size_t i = 0; i < unknowns_.size(); ++i)
        if (unknowns_[i].kind == Unknown::Kind::key) keys.push_back(values[i]);
    return keys;
}

double Likelihood::offset_of(std::size_t test, std::span<const double> values) const {
    for (std::size_t i = 0; i < unknowns_.size(); ++i)
        if (unknowns_[i].kind == Unknown::Kind::clock && unknowns_[i].test == test) return values[i];
    return 0.0;
}

double Likelihood::scale_of(std::size_t test, std::size_t history, std::span<const double> values) const {
    for (std::size_t i = 0; i < unknowns_.size(); ++i)
        if (unknowns_[i].kind == Unknown::Kind::scale && unknowns_[i].test == test &&
            unknowns_[i].history == history)
            return values[i];
    return 1.0;
}

std::optional<Predicted> Likelihood::predicted(std::size_t test, std::span<const double> values) const {
    try {
        auto found = tests_[test].prediction.at(scene_of(test, values), offset_of(test, values));
        if (!found) return {};
        for (std::size_t h = 0; h < found->histories.size(); ++h)
            if (const double scale = scale_of(test, h, values); scale != 1.0)
                for (double& value : found->histories[h])
                    value *= scale;
        return found;
    } catch (const SceneError&) {
        return {};  // values that do not fit together
    }
}

bool Likelihood::evaluate(std::span<const double> values, std::span<double> residuals) const {
    std::size_t row = 0;
    for (std::size_t t = first_; t < last_; ++t) {
        const FittedTest& one = tests_[t];
        const auto model = predicted(t, values);
        if (!model) return false;
        for (std::size_t h = 0; h < one.test.histories.size(); ++h) {
            const MeasuredHistory& history = one.test.histories[h];
            const Noise& noise = one.noise[h];
            double before = 0.0, time = 0.0;
            bool first = true;
            for (std::size_t i = 0; i < history.time.size(); ++i) {
                if (!one.used[h][i]) continue;
                const double left = (history.value[i] - model->histories[h][i]) / noise.sigma;
                const double memory =
                    first || !(noise.memory > 0.0) ? 0.0 : std::exp(-(history.time[i] - time) / noise.memory);
                residuals[row++] = (left - memory * before) / std::sqrt(1.0 - memory * memory);
                before = left;
                time = history.time[i];
                first = false;
            }
        }
        for (std::size_t s = 0; s < one.test.scalars.size(); ++s)
            residuals[row++] = (one.test.scalars[s].value - model->scalars[s]) / one.test.scalars[s].sigma;
    }
    for (std::size_t i = 0; i < unknowns_.size(); ++i)
        if (const auto& prior = unknowns_[i].prior)
            residuals[row++] = (values[i] - prior->mean) / prior->sigma;
    std::ranges::fill(residuals.subspan(row), 0.0);
    return true;
}

FitProblem Likelihood::problem() const {
    FitProblem problem;
    for (const Unknown& unknown : unknowns_)
        problem.variables.push_back(unknown.variable);
    problem.residuals = residuals();
    problem.evaluate = [this](std::span<const double> values, std::span<double> out) {
        return evaluate(values, out);
    };
    return problem;
}

std::optional<double> Likelihood::look_for_clocks(std::vector<double>& values) const {
    double total = 0.0;
    for (std::size_t t = first_; t < last_; ++t) {
        const FittedTest& one = tests_[t];
        if (one.test.histories.empty()) continue;
        std::vector<double> offsets{offset_of(t, values)};
        std::size_t place = unknowns_.size();
        for (std::size_t i = 0; i < unknowns_.size(); ++i)
            if (unknowns_[i].kind == Unknown::Kind::clock && unknowns_[i].test == t) place = i;
        if (place < unknowns_.size()) {
            const FitVariable& v = unknowns_[place].variable;
            for (int k = 0; k <= most_offsets; ++k)
                offsets.push_back(v.low + (v.high - v.low) * k / most_offsets);
        }
        std::optional<std::vector<Predicted>> all;
        try {
            all = one.prediction.scan(one.scene.at(keys_of(values)), offsets);
        } catch (const SceneError&) {
        }
        if (!all) return {};
        double best = std::numeric_limits<double>::infinity();
        for (std::size_t k = 0; k < offsets.size(); ++k) {
            double sum = 0.0;
            for (std::size_t h = 0; h < one.test.histories.size(); ++h) {
                const MeasuredHistory& history = one.test.histories[h];
                const std::size_t stride = std::max<std::size_t>(1, history.time.size() / most_scanned);
                for (std::size_t i = 0; i < history.time.size(); i += stride) {
                    const double left = (history.value[i] - (*all)[k].histories[h][i]) / one.noise[h].sigma;
                    sum += left * left * static_cast<double>(stride);
                }
            }
            if (!(sum < best)) continue;
            best = sum;
            if (place < unknowns_.size()) values[place] = offsets[k];
        }
        total += best;
    }
    return total;
}

bool Likelihood::leave_out_before_release(std::span<const double> values) {
    bool enough = true;
    for (std::size_t t = first_; t < last_; ++t) {
        FittedTest& one = tests_[t];
        for (std::size_t h = 0; h < one.test.histories.size(); ++h) {
            const std::vector<double>& time = one.test.histories[h].time;
            for (std::size_t i = 0; i < time.size(); ++i)
                one.used[h][i] = time[i] >= offset_of(t, values);
            enough = enough && std::ranges::count(one.used[h], true) > 1;
        }
    }
    return enough;
}

void Likelihood::learn_noise(std::span<const double> values, std::size_t parameters) {
    const double count = static_cast<double>(readings());
    for (std::size_t t = first_; t < last_; ++t) {
        FittedTest& one = tests_[t];
        const auto model = predicted(t, values);
        if (!model) continue;
        for (std::size_t h = 0; h < one.test.histories.size(); ++h) {
            const MeasuredHistory& history = one.test.histories[h];
            std::vector<double> left, gaps;
            double last = 0.0;
            for (std::size_t i = 0; i < history.time.size(); ++i) {
                if (!one.used[h][i]) continue;
                if (!left.empty()) gaps.push_back(history.time[i] - last);
                last = history.time[i];
                left.push_back(history.value[i] - model->histories[h][i]);
            }
            if (left.size() < 3) continue;
            const auto own = static_cast<double>(left.size());
            const double share = static_cast<double>(parameters) * own / count;
            double sum = 0.0, product = 0.0;
            for (std::size_t i = 0; i < left.size(); ++i) {
                sum += left[i] * left[i];
                if (i > 0) product += left[i] * left[i - 1];
            }
            if (!(sum > 0.0)) continue;
            constexpr double least = 1e-9;  // [-] of the largest reading: data that a model made itself
            if (one.test.is_record) {
                // The gap between two models is one thing, and not as many as there are readings: all of them
                // weigh as one, and the record's answers lead.
                one.noise[h] = {std::max(std::sqrt(sum), least * history.largest()), 0.0, false};
                continue;
            }
            // Noise that passes a filter of first order is correlated as it forgets; noise that is added
            // behind the filter is not. Of the two, and of all between them, the residuals show which.
            std::vector<double> sorted = gaps;
            std::ranges::nth_element(sorted, sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2));
            const double gap = sorted[sorted.size() / 2];
            constexpr double most = 0.98;
            const double ceiling =
                history.bandwidth ? std::exp(-2.0 * std::numbers::pi * *history.bandwidth * gap) : most;
            // A least-squares fit takes a little of the correlation with it.
            const double found = product / sum + share / own;
            const double correlation = std::clamp(found, 0.0, std::min(most, ceiling));
            Noise& noise = one.noise[h];
            noise.memory = correlation > 2.0 / std::sqrt(own) ? -gap / std::log(correlation) : 0.0;
            if (noise.given) continue;
            double innovations = left[0] * left[0];
            for (std::size_t i = 1; i < left.size(); ++i) {
                const double memory = noise.memory > 0.0 ? std::exp(-gaps[i - 1] / noise.memory) : 0.0;
                const double step = left[i] - memory * left[i - 1];
                innovations += step * step / (1.0 - memory * memory);
            }
            const double sigma = std::sqrt(innovations / std::max(1.0, own - share));
            noise.sigma = std::max(sigma, least * history.largest());
        }
    }
}

int Likelihood::runs() const {
    int runs = 0;
    for (std::size_t t = first_; t < last_; ++t)
        runs += tests_[t].prediction.runs();
    return runs;
}

}  // namespace twinchute::study
