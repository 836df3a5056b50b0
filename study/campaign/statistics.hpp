// Estimates with 95 % intervals.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace twinchute::study {

/// An estimate and its interval; an end that is not known is not a number.
struct Interval {
    double estimate = std::numeric_limits<double>::quiet_NaN();
    double low = std::numeric_limits<double>::quiet_NaN();
    double high = std::numeric_limits<double>::quiet_NaN();

    double halfwidth() const { return 0.5 * (high - low); }
};

inline constexpr double confidence = 0.95;

/// Count, mean and sum of squared deviations of numbers that come one by one (Welford 1962), to be added up
/// (Chan, Golub, LeVeque 1979).
struct Moments {
    std::uint64_t count = 0;
    double mean = 0.0, squares = 0.0;

    void add(double x) {
        ++count;
        const double step = x - mean;
        mean += step / static_cast<double>(count);
        squares += step * (x - mean);
    }
    void add(const Moments& other);
    double variance() const { return count > 1 ? squares / static_cast<double>(count - 1) : 0.0; }
};

/// Share of `hits` among `count` independent trials: Wilson's score interval (1927); where there was no hit,
/// or nothing else, that of Clopper and Pearson (1934), which Wilson's is too short for.
Interval share_interval(std::uint64_t hits, std::uint64_t count);

/// Mean by Student's t; no ends for less than two numbers.
Interval mean_interval(const Moments& moments);

/// Numbers, from 0, of the order statistics that enclose a quantile: P(X_(low) <= q <= X_(high)) >= 95 %
/// whatever the distribution. An end that no order statistic is far out enough for is absent.
struct QuantileRanks {
    std::uint64_t estimate = 0;
    std::optional<std::uint64_t> low = {}, high = {};
};
QuantileRanks quantile_ranks(double level, std::uint64_t count);

/// Interval of an estimate from those with one group left out each time (delete-a-group jackknife, Student's
/// t).
Interval jackknife_interval(double estimate, std::span<const double> without);

/// Mean and covariance of places in a plane.
struct PlaneMoments {
    std::uint64_t count = 0;
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();

    void add(const Eigen::Vector2d& place);
};

/// Ellipse that holds a share of places that are normally distributed.
struct Ellipse {
    Eigen::Vector2d centre = Eigen::Vector2d::Zero();
    Interval centre_x = {}, centre_y = {};
    Interval major = {}, minor = {};  ///< half axes
    double angle = 0.0;               ///< [rad] of the major axis, from x toward y
    double inside = 0.0;              ///< [-] share of the places that do lie inside
    bool contains(const Eigen::Vector2d& place) const;
};
/// Axes from the eigenvalues of the covariance, their intervals from its chi-square distribution.
Ellipse normal_ellipse(const PlaneMoments& moments, double level);

}  // namespace twinchute::study
