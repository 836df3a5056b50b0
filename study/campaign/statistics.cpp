#include "study/campaign/statistics.hpp"

#include <gsl/gsl_cdf.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace twinchute::study {
namespace {

constexpr double tail = 0.5 * (1.0 - confidence);

double normal_quantile() {
    return gsl_cdf_ugaussian_Qinv(tail);
}

double student_quantile(double freedom) {
    return gsl_cdf_tdist_Qinv(tail, freedom);
}

/// Chi-square that a share of `tail` lies above (1) or below (-1). GSL's inverse goes astray for many degrees
/// of freedom; Wilson and Hilferty's (1931) is good to 1e-5 there.
double chi_square(double freedom, double side) {
    constexpr double many = 1000.0;
    if (freedom < many)
        return side > 0.0 ? gsl_cdf_chisq_Qinv(tail, freedom) : gsl_cdf_chisq_Pinv(tail, freedom);
    const double spread = 2.0 / (9.0 * freedom),
                 root = 1.0 - spread + side * normal_quantile() * std::sqrt(spread);
    return freedom * root * root * root;
}

/// P(Bin(count, level) < k), for k from 0 to count + 1. GSL's takes counts of 32 bits.
double binomial_below(std::uint64_t k, double level, std::uint64_t count) {
    if (k == 0) return 0.0;
    if (k > count) return 1.0;
    return gsl_cdf_beta_Q(level, static_cast<double>(k), static_cast<double>(count - k + 1));
}

}  // namespace

void Moments::add(const Moments& other) {
    if (other.count == 0) return;
    const double n = static_cast<double>(count), m = static_cast<double>(other.count);
    const double step = other.mean - mean;
    count += other.count;
    mean += step * m / (n + m);
    squares += other.squares + step * step * n * m / (n + m);
}

Interval share_interval(std::uint64_t hits, std::uint64_t count) {
    if (count == 0) return {};
    const double n = static_cast<double>(count), p = static_cast<double>(hits) / n;
    if (hits == 0) return {p, 0.0, 1.0 - std::pow(tail, 1.0 / n)};
    if (hits == count) return {p, std::pow(tail, 1.0 / n), 1.0};
    const double z = normal_quantile(), z2 = z * z;
    const double middle = (p + 0.5 * z2 / n) / (1.0 + z2 / n);
    const double half = z / (1.0 + z2 / n) * std::sqrt(p * (1.0 - p) / n + 0.25 * z2 / (n * n));
    return {p, middle - half, middle + half};
}

Interval mean_interval(const Moments& m) {
    if (m.count == 0) return {};
    if (m.count == 1) return {.estimate = m.mean};
    const double n = static_cast<double>(m.count);
    const double half = student_quantile(n - 1.0) * std::sqrt(m.variance() / n);
    return {m.mean, m.mean - half, m.mean + half};
}

QuantileRanks quantile_ranks(double level, std::uint64_t count) {
    QuantileRanks ranks;
    if (count == 0) return ranks;
    const double n = static_cast<double>(count);
    ranks.estimate = std::min(count - 1, static_cast<std::uint64_t>(level * n));
    // P(X_(k) > q) = P(Bin <= k): the largest k that keeps it in the tail.
    std::uint64_t from = 0, to = count;
    while (from < to) {
        const std::uint64_t k = from + (to - from) / 2;
        binomial_below(k + 1, level, count) <= tail ? from = k + 1 : to = k;
    }
    if (from > 0) ranks.low = from - 1;
    // P(X_(k) < q) = P(Bin > k): the smallest.
    from = 0, to = count;
    while (from < to) {
        const std::uint64_t k = from + (to - from) / 2;
        1.0 - binomial_below(k + 1, level, count) <= tail ? to = k : from = k + 1;
    }
    if (from < count) ranks.high = from;
    return ranks;
}

Interval jackknife_interval(double estimate, std::span<const double> without) {
    if (without.size() < 2) return {.estimate = estimate};
    const double groups = static_cast<double>(without.size());
    const double mean = std::accumulate(without.begin(), without.end(), 0.0) / groups;
    double squares = 0.0;
    for (const double one : without)
        squares += (one - mean) * (one - mean);
    const double half = student_quantile(groups - 1.0) * std::sqrt(squares * (groups - 1.0) / groups);
    return {estimate, estimate - half, estimate + half};
}

void PlaneMoments::add(const Eigen::Vector2d& place) {
    ++count;
    const Eigen::Vector2d step = place - mean;
    mean += step / static_cast<double>(count);
    const Eigen::Vector2d left = place - mean;
    squares += step * left.transpose();
}

bool Ellipse::contains(const Eigen::Vector2d& place) const {
    const Eigen::Vector2d from = place - centre;
    const double c = std::cos(angle), s = std::sin(angle);
    // An ellipse without width holds the points on it: to the rounding of its axes.
    const double least = 1e-9 * (major.estimate + centre.norm()) + std::numeric_limits<double>::min();
    const double along = (c * from.x() + s * from.y()) / std::max(major.estimate, least);
    const double across = (c * from.y() - s * from.x()) / std::max(minor.estimate, least);
    return along * along + across * across <= 1.0;
}

Ellipse normal_ellipse(const PlaneMoments& m, double level) {
    Ellipse ellipse;
    ellipse.centre = m.mean;
    if (m.count < 3) return ellipse;
    const double n = static_cast<double>(m.count);
    const Eigen::Matrix2d covariance = 0.5 * (m.squares + m.squares.transpose()) / (n - 1.0);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(covariance);
    const double reach = std::sqrt(-2.0 * std::log1p(-level));  // of chi-square with two degrees of freedom
    const Eigen::Vector2d along = axes.eigenvectors().col(1);
    ellipse.angle = std::atan2(along.y(), along.x());
    const auto half_axis = [&](double variance) {
        const double sd = std::sqrt(std::max(0.0, variance)), freedom = n - 1.0;
        return Interval{reach * sd, reach * sd * std::sqrt(freedom / chi_square(freedom, 1.0)),
                        reach * sd * std::sqrt(freedom / chi_square(freedom, -1.0))};
    };
    ellipse.major = half_axis(axes.eigenvalues()[1]);
    ellipse.minor = half_axis(axes.eigenvalues()[0]);
    const double t = student_quantile(n - 1.0);
    const auto centre = [&](int axis) {
        const double half = t * std::sqrt(covariance(axis, axis) / n);
        return Interval{m.mean[axis], m.mean[axis] - half, m.mean[axis] + half};
    };
    ellipse.centre_x = centre(0), ellipse.centre_y = centre(1);
    return ellipse;
}

}  // namespace twinchute::study
