#include <benchmark/benchmark.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>

#include <array>
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <deque>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "lib/solve/sundials.hpp"
#include "rom/rigid_composite.hpp"
#include "tests/bench/bench.hpp"

namespace twinchute::bench {
namespace {

using State = std::array<double, 2>;  // altitude [m], its rate [m/s]
using Model = rom::RigidComposite<1>;

/// One stage of a run of the C-9, with the right-hand side of the reduced-order model.
struct Problem {
    std::string_view name;
    Model model;
    State start{};
    double end = 0.0;  // [s]
    mutable std::int64_t calls = 0;

    void rhs(double t, const double* y, double* dydt) const {
        ++calls;
        dydt[0] = y[1];
        dydt[1] = model.acceleration(t, rom::motion_of<1>({y, 2}))[0];
    }
};

Model c9(const char* air, Phase phase) {
    Model model;
    model.atmosphere = {find_atmosphere(air), 1.225};
    model.gravity = standard_gravity;
    model.payload_mass = 152.4;
    static const Parachute chute = [] {
        Parachute p;
        p.mass = 5.19;
        return p;
    }();
    Inflation inflation;
    inflation.filling_time = 1.625;
    inflation.steady_drag_area = 42.56;
    inflation.eta = 0.2;
    inflation.law = find_drag_area_law("ludtke");
    static std::deque<OpeningSequence> kept;  // by the models of all problems
    model.canopies = &kept.emplace_back(chute, inflation, phase);
    return model;
}

const std::vector<Problem>& problems() {
    static const std::vector<Problem> list{
        {"filling", c9("us76", Phase::filling), {300.0, -21.0}, 1.625},
        {"descent, 170 s", c9("us76", Phase::open), {1500.0, -8.0}, 170.0},
        {"descent, 1000 s", c9("us76", Phase::open), {12'000.0, -14.0}, 1000.0},
    };
    return list;
}

constexpr double smallest_scale = 1.0;  // absolute tolerance over the relative one, as the model's own

State by_sundials(const Problem& p, const OdeMethod& method, double rtol) {
    OdeSolver solver(
        method,
        [&](double t, std::span<const double> y, std::span<double> f) { p.rhs(t, y.data(), f.data()); }, 0.0,
        p.start, rtol, std::vector<double>(2, smallest_scale * rtol));
    solver.stop_at(p.end);
    auto outcome = solver.advance();
    while (outcome == OdeSolver::Outcome::stepped)
        outcome = solver.advance();
    if (outcome != OdeSolver::Outcome::reached_stop) return {NAN, NAN};
    return {solver.state()[0], solver.state()[1]};
}

State by_gsl(const Problem& p, double rtol) {
    gsl_odeiv2_system system{[](double t, const double* y, double* f, void* problem) -> int {
                                 static_cast<const Problem*>(problem)->rhs(t, y, f);
                                 return GSL_SUCCESS;
                             },
                             nullptr, 2, const_cast<Problem*>(&p)};
    const std::unique_ptr<gsl_odeiv2_driver, decltype(&gsl_odeiv2_driver_free)> driver(
        gsl_odeiv2_driver_alloc_y_new(&system, gsl_odeiv2_step_rkf45, 1e-3, smallest_scale * rtol, rtol),
        &gsl_odeiv2_driver_free);
    State y = p.start;
    double t = 0.0;
    return gsl_odeiv2_driver_apply(driver.get(), &t, p.end, y.data()) == GSL_SUCCESS ? y : State{NAN, NAN};
}

State by_odeint(const Problem& p, double rtol) {
    namespace odeint = boost::numeric::odeint;
    State y = p.start;
    odeint::integrate_adaptive(
        odeint::make_controlled<odeint::runge_kutta_dopri5<State>>(smallest_scale * rtol, rtol),
        [&](const State& x, State& f, double t) { p.rhs(t, x.data(), f.data()); }, y, 0.0, p.end, 1e-3);
    return y;
}

/// Altitude and speed by the pair of order 5, far below the tolerances compared.
const State& truth_of(const Problem& p) {
    static std::vector<State> truth(problems().size(), State{NAN, NAN});
    State& found = truth[static_cast<std::size_t>(&p - problems().data())];
    if (std::isnan(found[0])) found = by_sundials(p, *find_ode_method("dormand-prince"), 1e-13);
    return found;
}

template <class Solve>
void measure(benchmark::State& bench, const Problem& p, Solve&& solve) {
    State y{};
    for (auto _ : bench) {
        p.calls = 0;
        y = solve();
        benchmark::DoNotOptimize(y);
    }
    const auto calls = static_cast<double>(p.calls);
    const State& truth = truth_of(p);
    if (std::isnan(y[0])) return bench.SkipWithError("the solver gave up");
    bench.counters["calls"] = calls;
    bench.counters["error"] = std::max(std::abs(y[0] - truth[0]) / std::abs(p.start[0] - truth[0]),
                                       std::abs(y[1] - truth[1]) / std::abs(truth[1]));
}

template <class Solve>
void add(const Problem& p, std::string_view solver, Solve solve) {
    for (const int digits : {4, 6, 8, 10}) {
        const double rtol = std::pow(10.0, -digits);
        benchmark::RegisterBenchmark(
            fmt::format("method/{}/{}/{}", p.name, solver, digits).c_str(),
            [&p, solve, rtol](benchmark::State& bench) { measure(bench, p, [&] { return solve(p, rtol); }); })
            ->Unit(benchmark::kMicrosecond);
    }
}

}  // namespace

void register_methods() {
    for (const Problem& p : problems()) {
        for (const OdeMethod& method : ode_methods())
            add(p, method.name,
                [&method](const Problem& q, double rtol) { return by_sundials(q, method, rtol); });
        add(p, "GSL rkf45", by_gsl);
        add(p, "odeint dopri5", by_odeint);
    }
}

}  // namespace twinchute::bench
