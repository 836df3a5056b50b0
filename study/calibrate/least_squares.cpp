#include "study/calibrate/least_squares.hpp"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_multifit_nlinear.h>
#include <gsl/gsl_qrng.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

namespace twinchute::study {
namespace {

constexpr double out_of_the_way = 1e4;  // [-] a residual of values that cannot be evaluated

/// Internal variable of the solver: the scale is the logistic function of it between the bounds.
double logistic(double u) {
    return 1.0 / (1.0 + std::exp(-u));
}
double logit(double share) {
    constexpr double edge = 1e-4;
    const double inside = std::clamp(share, edge, 1.0 - edge);
    return std::log(inside / (1.0 - inside));
}

/// The problem in the solver's variables.
struct Inner {
    const FitProblem& problem;
    std::vector<double> values;       // the free ones change
    std::vector<std::size_t> places;  // of the free ones
    const std::vector<bool>& free;

    void set(const gsl_vector* u) {
        for (std::size_t k = 0; k < places.size(); ++k) {
            const FitVariable& v = problem.variables[places[k]];
            const double scale = v.to_scale(v.low) + v.range() * logistic(gsl_vector_get(u, k));
            values[places[k]] = std::clamp(v.from_scale(scale), v.low, v.high);
        }
    }
};

int inner_residuals(const gsl_vector* u, void* data, gsl_vector* f) {
    Inner& inner = *static_cast<Inner*>(data);
    inner.set(u);
    const std::span<double> out(f->data, f->size);
    if (!inner.problem.evaluate(inner.values, out)) std::ranges::fill(out, out_of_the_way);
    return GSL_SUCCESS;
}

int inner_jacobian(const gsl_vector* u, void* data, gsl_matrix* J) {
    Inner& inner = *static_cast<Inner*>(data);
    inner.set(u);
    const auto by_scale = jacobian(inner.problem, inner.values, inner.free);
    if (!by_scale) return GSL_EFAILED;
    for (std::size_t k = 0; k < inner.places.size(); ++k) {
        const double share = logistic(gsl_vector_get(u, k));
        const double factor = inner.problem.variables[inner.places[k]].range() * share * (1.0 - share);
        for (std::size_t i = 0; i < J->size1; ++i)
            gsl_matrix_set(J, i, k,
                           factor * (*by_scale)(static_cast<Eigen::Index>(i),
                                                static_cast<Eigen::Index>(inner.places[k])));
    }
    return GSL_SUCCESS;
}

std::vector<std::size_t> places_of(const std::vector<bool>& free) {
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < free.size(); ++i)
        if (free[i]) places.push_back(i);
    return places;
}

/// One side of a profile: the value at which its square root of the rise is that wanted.
class ProfileSide {
public:
    ProfileSide(const FitProblem& problem, const FitResult& best, const Eigen::MatrixXd& covariance,
                const std::vector<bool>& free, std::size_t variable)
        : problem_(problem),
          best_(best),
          covariance_(covariance),
          others_(free),
          variable_(variable),
          v_(problem.variables[variable]),
          centre_(v_.to_scale(best.values[variable])) {
        others_[variable] = false;
    }

    /// Value in the scale; nothing: beyond the bound.
    std::optional<double> find(double direction, double rise) const {
        const auto k = static_cast<Eigen::Index>(variable_);
        const double wanted = std::sqrt(rise),
                     bound = direction > 0.0 ? v_.to_scale(v_.high) : v_.to_scale(v_.low);
        const double reach = std::abs(bound - centre_);
        double inner = 0.0, inner_root = 0.0, outer = reach, outer_root = -1.0;
        double step = std::min(reach, wanted * std::sqrt(std::max(0.0, covariance_(k, k))));
        if (!(step > 0.0)) return {};
        for (int i = 0; i < 8; ++i) {
            const double root = root_of_rise(centre_ + direction * step);
            if (std::abs(root - wanted) < 0.01 * wanted) return centre_ + direction * step;
            if (root < wanted) {
                if (step >= reach) return {};
                inner = step, inner_root = root;
            } else {
                outer = step, outer_root = root;
            }
            // The root grows nearly in proportion to the distance.
            double next = outer_root < 0.0
                              ? (root > 0.0 ? step * std::clamp(wanted / root, 1.1, 3.0) : 3.0 * step)
                              : inner + (outer - inner) * (wanted - inner_root) / (outer_root - inner_root);
            step = std::min(next, reach);
        }
        return centre_ + direction * step;
    }

private:
    double root_of_rise(double scale) const {
        const auto k = static_cast<Eigen::Index>(variable_);
        std::vector<double> start = best_.values;
        for (std::size_t j = 0; j < start.size(); ++j) {
            const FitVariable& v = problem_.variables[j];
            if (!others_[j]) continue;
            const double along = covariance_(static_cast<Eigen::Index>(j), k) / covariance_(k, k);
            const double moved = v.to_scale(start[j]) + along * (scale - centre_);
            start[j] = v.from_scale(std::clamp(moved, v.to_scale(v.low), v.to_scale(v.high)));
        }
        start[variable_] = std::clamp(v_.from_scale(scale), v_.low, v_.high);
        const double sum = std::ranges::count(others_, true) > 0 ? fit_from(problem_, start, others_, 4).sum
                                                                 : sum_of_squares(problem_, start);
        return std::sqrt(std::max(0.0, sum - best_.sum));
    }

    const FitProblem& problem_;
    const FitResult& best_;
    const Eigen::MatrixXd& covariance_;
    std::vector<bool> others_;
    std::size_t variable_;
    const FitVariable& v_;
    double centre_;
};

}  // namespace

double FitVariable::to_scale(double value) const {
    return logarithmic ? std::log(value) : value;
}
double FitVariable::from_scale(double scale) const {
    return logarithmic ? std::exp(scale) : scale;
}
bool FitVariable::is_at_bound(double value) const {
    constexpr double near = 1e-3;
    const double at = to_scale(value);
    return at - to_scale(low) < near * range() || to_scale(high) - at < near * range();
}

double sum_of_squares(const FitProblem& problem, std::span<const double> values) {
    std::vector<double> residuals(problem.residuals);
    if (!problem.evaluate(values, residuals)) return std::numeric_limits<double>::infinity();
    double sum = 0.0;
    for (const double r : residuals)
        sum += r * r;
    return sum;
}

FitResult fit_from(const FitProblem& problem, const std::vector<double>& start, const std::vector<bool>& free,
                   int most_iterations) {
    // GSL ends the program where something is wrong, unless it is told not to.
    [[maybe_unused]] static const auto handler_off = gsl_set_error_handler_off();
    Inner inner{problem, start, places_of(free), free};
    FitResult result{start, sum_of_squares(problem, start), false};
    const std::size_t n = problem.residuals, p = inner.places.size();
    if (p == 0 || n < p || !std::isfinite(result.sum)) return result;
    gsl_multifit_nlinear_parameters settings = gsl_multifit_nlinear_default_parameters();
    settings.solver = gsl_multifit_nlinear_solver_svd;
    gsl_multifit_nlinear_fdf fdf{};
    fdf.f = &inner_residuals;
    fdf.df = &inner_jacobian;
    fdf.n = n;
    fdf.p = p;
    fdf.params = &inner;
    const std::unique_ptr<gsl_multifit_nlinear_workspace, decltype(&gsl_multifit_nlinear_free)> work(
        gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &settings, n, p), gsl_multifit_nlinear_free);
    const std::unique_ptr<gsl_vector, decltype(&gsl_vector_free)> u(gsl_vector_alloc(p), gsl_vector_free);
    for (std::size_t k = 0; k < p; ++k) {
        const FitVariable& v = problem.variables[inner.places[k]];
        gsl_vector_set(u.get(), k,
                       logit((v.to_scale(start[inner.places[k]]) - v.to_scale(v.low)) / v.range()));
    }
    if (gsl_multifit_nlinear_init(u.get(), &fdf, work.get()) != GSL_SUCCESS) return result;
    double last = result.sum;
    for (int i = 0; i < most_iterations; ++i) {
        const int status = gsl_multifit_nlinear_iterate(work.get());
        const gsl_vector* f = gsl_multifit_nlinear_residual(work.get());
        double sum = 0.0;
        for (std::size_t k = 0; k < n; ++k)
            sum += gsl_vector_get(f, k) * gsl_vector_get(f, k);
        // No progress: GSL has shrunk its region as far as it goes, which is the minimum to rounding.
        if (status != GSL_SUCCESS) {
            result.converged = status == GSL_ENOPROG;
            last = sum;
            break;
        }
        constexpr double enough = 1e-4;  // of a unit of variance
        result.converged = last - sum < enough;
        last = sum;
        if (result.converged && i > 0) break;
    }
    if (last < result.sum) {
        inner.set(gsl_multifit_nlinear_position(work.get()));
        result.values = inner.values;
        result.sum = last;
    }
    return result;
}

std::optional<Eigen::MatrixXd> jacobian(const FitProblem& problem, std::span<const double> values,
                                        const std::vector<bool>& free) {
    const auto rows = static_cast<Eigen::Index>(problem.residuals),
               columns = static_cast<Eigen::Index>(problem.variables.size());
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(rows, columns);
    std::vector<double> at(values.begin(), values.end());
    Eigen::VectorXd up(rows), down(rows);
    for (std::size_t k = 0; k < problem.variables.size(); ++k) {
        if (!free[k]) continue;
        const FitVariable& v = problem.variables[k];
        const double here = v.to_scale(values[k]);
        const double high = std::min(here + v.step, v.to_scale(v.high)),
                     low = std::max(here - v.step, v.to_scale(v.low));
        at[k] = std::clamp(v.from_scale(high), v.low, v.high);
        if (!problem.evaluate(at, std::span(up.data(), problem.residuals))) return {};
        at[k] = std::clamp(v.from_scale(low), v.low, v.high);
        if (!problem.evaluate(at, std::span(down.data(), problem.residuals))) return {};
        at[k] = values[k];
        J.col(static_cast<Eigen::Index>(k)) = (up - down) / (high - low);
    }
    return J;
}

Eigen::MatrixXd covariance_of(const Eigen::MatrixXd& jacobian, const std::vector<bool>& free) {
    const std::vector<std::size_t> places = places_of(free);
    const auto p = static_cast<Eigen::Index>(places.size());
    Eigen::MatrixXd J(jacobian.rows(), p);
    Eigen::VectorXd norms(p);
    for (Eigen::Index k = 0; k < p; ++k) {
        J.col(k) = jacobian.col(static_cast<Eigen::Index>(places[static_cast<std::size_t>(k)]));
        norms[k] = std::max(J.col(k).norm(), std::numeric_limits<double>::min());
        J.col(k) /= norms[k];
    }
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(J.transpose() * J, Eigen::ComputeThinU | Eigen::ComputeThinV);
    Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(p, p);
    for (Eigen::Index k = 0; k < p; ++k)
        inverse += svd.matrixV().col(k) * svd.matrixU().col(k).transpose() /
                   std::max(svd.singularValues()[k], std::numeric_limits<double>::epsilon());
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(jacobian.cols(), jacobian.cols());
    for (Eigen::Index i = 0; i < p; ++i)
        for (Eigen::Index j = 0; j < p; ++j)
            all(static_cast<Eigen::Index>(places[static_cast<std::size_t>(i)]),
                static_cast<Eigen::Index>(places[static_cast<std::size_t>(j)])) =
                0.5 * (inverse(i, j) + inverse(j, i)) / (norms[i] * norms[j]);
    return all;
}

std::optional<Weakest> weakest(const Eigen::MatrixXd& jacobian, const FitProblem& problem,
                               const std::vector<bool>& free) {
    const std::vector<std::size_t> places = places_of(free);
    if (places.empty()) return {};
    Eigen::MatrixXd J(jacobian.rows(), static_cast<Eigen::Index>(places.size()));
    for (std::size_t k = 0; k < places.size(); ++k)
        J.col(static_cast<Eigen::Index>(k)) =
            jacobian.col(static_cast<Eigen::Index>(places[k])) * problem.variables[places[k]].range();
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(J.transpose() * J, Eigen::ComputeThinV);
    const Eigen::Index last = svd.singularValues().size() - 1;
    Eigen::Index place = 0;
    svd.matrixV().col(last).cwiseAbs().maxCoeff(&place);
    const double size = std::sqrt(std::max(0.0, svd.singularValues()[last]));
    return Weakest{places[static_cast<std::size_t>(place)],
                   size > 0.0 ? 1.0 / size : std::numeric_limits<double>::infinity()};
}

ProfileInterval profile_interval(const FitProblem& problem, const FitResult& best,
                                 const Eigen::MatrixXd& covariance, const std::vector<bool>& free,
                                 std::size_t variable, double rise) {
    const FitVariable& v = problem.variables[variable];
    const ProfileSide side(problem, best, covariance, free, variable);
    const auto low = side.find(-1.0, rise), high = side.find(1.0, rise);
    return {low ? v.from_scale(*low) : v.low, high ? v.from_scale(*high) : v.high, !low, !high};
}

std::vector<std::vector<double>> start_points(const FitProblem& problem, const std::vector<bool>& free,
                                              int count) {
    const std::vector<std::size_t> places = places_of(free);
    std::vector<double> start;
    for (const FitVariable& v : problem.variables)
        start.push_back(v.start);
    std::vector<std::vector<double>> points{start};
    if (places.empty()) return points;
    const std::unique_ptr<gsl_qrng, decltype(&gsl_qrng_free)> halton(
        gsl_qrng_alloc(gsl_qrng_halton, static_cast<unsigned>(places.size())), gsl_qrng_free);
    std::vector<double> share(places.size());
    while (static_cast<int>(points.size()) < count) {
        gsl_qrng_get(halton.get(), share.data());
        for (std::size_t k = 0; k < places.size(); ++k) {
            const FitVariable& v = problem.variables[places[k]];
            start[places[k]] =
                std::clamp(v.from_scale(v.to_scale(v.low) + share[k] * v.range()), v.low, v.high);
        }
        points.push_back(start);
    }
    return points;
}

}  // namespace twinchute::study
