#include "study/campaign/design.hpp"

#include <gsl/gsl_cdf.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <bit>

#include "study/campaign/random.hpp"

namespace twinchute::study {
namespace {

/// Dimensions of the sequence: Saltelli's two samples are halves of one point.
std::size_t sequence_dimensions(const CampaignSpec& spec) {
    return spec.inputs.size() * (spec.design == DesignKind::saltelli ? 2 : 1);
}

/// Share of a standard normal variable that lies below, never an end of the interval from 0 to 1.
double share_below(double score) {
    return std::clamp(gsl_cdf_ugaussian_P(score), 0x1p-54, 1.0 - 0x1p-53);
}

}  // namespace

Design::Design(const CampaignSpec& spec)
    : spec_(spec),
      point_(spec.inputs.size()),
      scores_(spec.inputs.size()),
      sequence_(std::max<std::size_t>(1, sequence_dimensions(spec))) {
    if (!spec.correlation.isIdentity(0.0)) root_ = Eigen::LLT<Eigen::MatrixXd>(spec.correlation).matrixL();
    for (std::size_t k = 0; k < sequence_dimensions(spec); ++k)
        shift_.push_back(random_bits(spec.seed, 0, static_cast<std::uint32_t>(k), RandomStream::shift));
}

void Design::values(std::uint64_t run, std::span<double> values) {
    if (spec_.design == DesignKind::points) {
        std::ranges::copy(spec_.point_rows[run], values.begin());
        return;
    }
    point(run, point_);
    if (root_.size() > 0) {
        for (std::size_t i = 0; i < point_.size(); ++i)
            scores_[i] =
                point_[i] < 0.5 ? gsl_cdf_ugaussian_Pinv(point_[i]) : gsl_cdf_ugaussian_Qinv(1.0 - point_[i]);
        for (std::size_t i = 0; i < point_.size(); ++i) {
            // An uncorrelated input keeps its bits.
            if (root_(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)) != 1.0)
                point_[i] = share_below(correlated_score(scores_, i));
        }
    }
    for (std::size_t i = 0; i < point_.size(); ++i)
        values[i] = spec_.inputs[i].distribution->at(point_[i]);
}

void Design::values_at(std::span<const double> scores, std::span<double> values) {
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = spec_.inputs[i].distribution->at(
            share_below(root_.size() > 0 ? correlated_score(scores, i) : scores[i]));
}

double Design::correlated_score(std::span<const double> scores, std::size_t input) const {
    double score = 0.0;
    for (std::size_t j = 0; j <= input; ++j)
        score += root_(static_cast<Eigen::Index>(input), static_cast<Eigen::Index>(j)) * scores[j];
    return score;
}

void Design::point(std::uint64_t run, std::span<double> point) {
    switch (spec_.design) {
        case DesignKind::sobol:
            return sobol(run, point);
        case DesignKind::grid:
            return grid(run, point);
        case DesignKind::saltelli:
            return saltelli(run, point);
        case DesignKind::lhs:
            for (std::size_t k = 0; k < point.size(); ++k)
                point[k] = stratified(run, static_cast<std::uint32_t>(k));
            return;
        case DesignKind::random:
        case DesignKind::points:
            for (std::size_t k = 0; k < point.size(); ++k)
                point[k] = unit_number(
                    random_bits(spec_.seed, run, static_cast<std::uint32_t>(k), RandomStream::sample));
            return;
    }
}

void Design::sobol(std::uint64_t index, std::span<double> point) {
    // Boost's sequence begins behind the point at zero, which belongs to every balanced start of it.
    if (index > 0 && next_ != index) sequence_.seed(index - 1);
    for (std::size_t k = 0; k < point.size(); ++k)
        point[k] = unit_number(shift_[k] ^ (index > 0 ? sequence_() : 0));
    next_ = index > 0 ? index + 1 : 0;
}

double Design::stratified(std::uint64_t run, std::uint32_t dimension) const {
    const std::uint64_t stratum = permuted(run, spec_.runs, spec_.seed, dimension);
    const double inside = unit_number(random_bits(spec_.seed, run, dimension, RandomStream::sample));
    return (static_cast<double>(stratum) + inside) / static_cast<double>(spec_.runs);
}

void Design::grid(std::uint64_t run, std::span<double> point) const {
    for (std::size_t k = 0; k < point.size(); ++k) {
        const auto levels = static_cast<std::uint64_t>(spec_.inputs[k].levels);
        point[k] = (static_cast<double>(run % levels) + 0.5) / static_cast<double>(levels);
        run /= levels;
    }
}

void Design::saltelli(std::uint64_t run, std::span<double> point) {
    const std::size_t d = point.size();
    const std::uint64_t block = run % saltelli_block(d);
    std::vector<double> both(2 * d);
    sobol(run / saltelli_block(d), both);
    next_ = 0;
    for (std::size_t k = 0; k < d; ++k)
        point[k] = both[block == 1 || block == k + 2 ? d + k : k];
}

std::uint64_t permuted(std::uint64_t index, std::uint64_t count, std::uint64_t seed,
                       std::uint32_t dimension) {
    if (count < 2) return 0;
    const auto half = static_cast<int>((std::bit_width(count - 1) + 1) / 2);
    const std::uint64_t mask = (std::uint64_t{1} << half) - 1;
    constexpr std::uint64_t rounds = 4;
    do {
        std::uint64_t left = index >> half, right = index & mask;
        for (std::uint64_t round = 0; round < rounds; ++round) {
            const std::uint64_t mixed =
                random_bits(seed, right << 8 | round, dimension, RandomStream::permutation) & mask;
            left = std::exchange(right, left ^ mixed);
        }
        index = left << half | right;
    } while (index >= count);
    return index;
}

}  // namespace twinchute::study
