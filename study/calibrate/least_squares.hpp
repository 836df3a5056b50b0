// Non-linear least squares within bounds (GSL's trust region, Levenberg and Marquardt), from many starts, and
// how far values may be from the best before the data say no.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace twinchute::study {

/// A value that is fitted. A logarithmic one has positive bounds: steps, starts and covariance are those of
/// its logarithm.
struct FitVariable {
    double start = 0.0, low = 0.0, high = 0.0;
    bool logarithmic = false;
    double step = 1e-3;  ///< of difference quotients, in the scale

    double to_scale(double value) const;
    double from_scale(double scale) const;
    double range() const { return to_scale(high) - to_scale(low); }  ///< in the scale
    bool is_at_bound(double value) const;                            ///< to a thousandth of the range
};

/// Residuals [-], each of unit variance, at values of the variables; false where there are none.
using Residuals = std::function<bool(std::span<const double> values, std::span<double> residuals)>;

struct FitProblem {
    std::vector<FitVariable> variables;
    std::size_t residuals = 0;  ///< their number
    Residuals evaluate;
};

struct FitResult {
    std::vector<double> values;
    double sum = 0.0;  ///< of squares; infinite where nothing could be evaluated
    bool converged = false;
};

/// Sum of the squares at values; infinite where there are none.
double sum_of_squares(const FitProblem& problem, std::span<const double> values);

/// The best values from `start`, of those variables that are free.
FitResult fit_from(const FitProblem& problem, const std::vector<double>& start, const std::vector<bool>& free,
                   int most_iterations);

/// d residual/d scale at values, a column a variable; those that are not free are zero. By central
/// differences, one-sided on a bound. Nothing where a neighbour cannot be evaluated.
std::optional<Eigen::MatrixXd> jacobian(const FitProblem& problem, std::span<const double> values,
                                        const std::vector<bool>& free);

/// Covariance in the scale, zero for variables that are not free.
Eigen::MatrixXd covariance_of(const Eigen::MatrixXd& jacobian, const std::vector<bool>& free);

/// The variable that the data see least: index, and the standard deviation [-] of the weakest direction as a
/// share of the ranges. Nothing where none is free.
struct Weakest {
    std::size_t variable = 0;
    double share = 0.0;
};
std::optional<Weakest> weakest(const Eigen::MatrixXd& jacobian, const FitProblem& problem,
                               const std::vector<bool>& free);

/// Where the smallest sum of squares at a fixed value of one variable is `rise` above the best (profile
/// likelihood); an end that is not found lies on the bound, and is open.
struct ProfileInterval {
    double low = 0.0, high = 0.0;
    bool low_open = false, high_open = false;
};
ProfileInterval profile_interval(const FitProblem& problem, const FitResult& best,
                                 const Eigen::MatrixXd& covariance, const std::vector<bool>& free,
                                 std::size_t variable, double rise);

/// Points in the ranges of the free variables, the start first, then Halton's; others stay at their start.
std::vector<std::vector<double>> start_points(const FitProblem& problem, const std::vector<bool>& free,
                                              int count);

}  // namespace twinchute::study
