#include <fmt/format.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>

#include <algorithm>
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "lib/solve/stopwatch.hpp"
#include "lib/solve/sundials.hpp"
#include "tests/bench/work/problems.hpp"
#include "tests/bench/work/study.hpp"

namespace twinchute::bench {
namespace {

using Values = std::vector<double>;

/// One stage: from `t` [s] with `y` to its end, which is in `y` then. False where the integrator gave up.
using Integrate = std::function<bool(const Stage& stage, double t, Values& y, double rtol)>;

bool by_sundials(const OdeMethod& method, const Stage& stage, double t, Values& y, double rtol) {
    OdeSolver solver(
        method,
        [&](double at, std::span<const double> x, std::span<double> f) { stage.rhs(at, x.data(), f.data()); },
        t, y, rtol, Values(y.size(), rtol));
    solver.stop_at(stage.end);
    auto outcome = OdeSolver::Outcome::stepped;
    while (outcome == OdeSolver::Outcome::stepped)
        outcome = solver.advance();
    y.assign(solver.state().begin(), solver.state().end());
    return outcome == OdeSolver::Outcome::reached_stop;
}

bool by_gsl(const Stage& stage, double t, Values& y, double rtol) {
    gsl_odeiv2_system system{[](double at, const double* x, double* f, void* what) -> int {
                                 static_cast<const Stage*>(what)->rhs(at, x, f);
                                 return GSL_SUCCESS;
                             },
                             nullptr, y.size(), const_cast<Stage*>(&stage)};
    const std::unique_ptr<gsl_odeiv2_driver, decltype(&gsl_odeiv2_driver_free)> driver(
        gsl_odeiv2_driver_alloc_y_new(&system, gsl_odeiv2_step_rkf45, first_step * (stage.end - t), rtol,
                                      rtol),
        &gsl_odeiv2_driver_free);
    return gsl_odeiv2_driver_apply(driver.get(), &t, stage.end, y.data()) == GSL_SUCCESS;
}

bool by_odeint(const Stage& stage, double t, Values& y, double rtol) {
    namespace odeint = boost::numeric::odeint;
    odeint::integrate_adaptive(
        odeint::make_controlled<odeint::runge_kutta_dopri5<Values>>(rtol, rtol),
        [&](const Values& x, Values& f, double at) { stage.rhs(at, x.data(), f.data()); }, y, t, stage.end,
        first_step * (stage.end - t));
    return true;
}

bool solve(const Problem& problem, const Integrate& integrate, double rtol, Values& y) {
    y = problem.start;
    double t = 0.0;
    for (const Stage& stage : problem.stages) {
        if (stage.enter) y = stage.enter(y);
        if (!integrate(stage, t, y, rtol)) return false;
        t = stage.end;
    }
    return true;
}

double error_of(const Problem& problem, const Values& y, const Values& truth) {
    double worst = 0.0;
    for (std::size_t i = 0; i < y.size(); ++i)
        worst = std::max(worst, std::abs(y[i] - truth[i]) / problem.scale[i]);
    return worst;
}

constexpr std::int64_t max_evaluations = 300'000;  // beyond which a method of order 2 shows nothing new

Curve curve_of(const Problem& problem, const char* family, std::string_view method,
               const Integrate& integrate, const Values& truth, int max_digits) {
    Curve curve{std::string(method), family, {}};
    for (int digits = 3; digits <= max_digits; ++digits) {
        const double rtol = std::pow(10.0, -digits);
        Sample sample{fmt::format("1e-{}", digits), 0, INFINITY, 0.0};
        Values y;
        bool good = true;
        for (int repeat = 0; repeat < 3 && good; ++repeat) {
            problem.calls = 0;
            const Stopwatch watch;
            good = solve(problem, integrate, rtol, y);
            sample.seconds = std::min(sample.seconds, watch.wall());
        }
        sample.evaluations = problem.calls;
        sample.error = error_of(problem, y, truth);
        if (!good || !std::isfinite(sample.error)) {
            fmt::print("{}: {} gave up at {}\n", problem.name, method, sample.setting);
            continue;
        }
        curve.samples.push_back(std::move(sample));
        if (problem.calls > max_evaluations) break;
    }
    return curve;
}

}  // namespace

void study_rom(const std::filesystem::path& directory, bool quick) {
    const int max_digits = quick ? 5 : 12;
    for (const auto& problem : work_problems()) {
        Study study{problem->name, problem->title, problem->subtitle, problem->error, {}};
        const auto with = [](const OdeMethod& method) {
            return [&method](const Stage& stage, double t, Values& y, double rtol) {
                return by_sundials(method, stage, t, y, rtol);
            };
        };
        // The truth by a method of each kind; they have to agree before anything is held against them.
        Values truth, other;
        if (!solve(*problem, with(*find_ode_method("dormand-prince")), 1e-13, truth) ||
            !solve(*problem, with(*find_ode_method("kvaerno-5")), 1e-13, other) ||
            !(error_of(*problem, other, truth) < 1e-11))
            throw std::runtime_error(fmt::format("{}: there is no truth, two methods differ by {:.2g}",
                                                 problem->name, error_of(*problem, other, truth)));
        for (const OdeMethod& method : ode_methods())
            study.curves.push_back(curve_of(*problem,
                                            method.multistep  ? "multistep (CVODE)"
                                            : method.implicit ? "implicit Runge-Kutta (ARKODE)"
                                                              : "explicit Runge-Kutta (ARKODE)",
                                            method.name, with(method), truth, max_digits));
        study.curves.push_back(
            curve_of(*problem, "GSL and Boost.odeint", "GSL rkf45", by_gsl, truth, max_digits));
        study.curves.push_back(
            curve_of(*problem, "GSL and Boost.odeint", "odeint dopri5", by_odeint, truth, max_digits));
        write(study, directory);
        fmt::print("{}\n", problem->name);
    }
}

}  // namespace twinchute::bench
