#include "lib/solve/sundials.hpp"

#include <arkode/arkode_arkstep.h>
#include <arkode/arkode_erkstep.h>
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <functional>
#include <limits>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "lib/math/root.hpp"
#include "lib/solve/dense_output.hpp"

namespace twinchute {
/// SUNDIALS offers the same calls three times: for explicit and for implicit Runge-Kutta methods, and for
/// multistep ones, which have no fixed steps (null here).
struct SundialsCalls {
    decltype(&ERKStepFree) free;
    decltype(&ERKStepSetErrHandlerFn) set_error_handler;
    decltype(&ERKStepSetUserData) set_user_data;
    decltype(&ERKStepSVtolerances) set_tolerances;
    decltype(&ERKStepSetMaxNumSteps) set_most_steps;
    decltype(&ERKStepReset) reset;
    decltype(&ERKStepSetInitStep) set_first_step;
    decltype(&ERKStepSetStopTime) set_stop_time;
    decltype(&ERKStepSetFixedStep) set_fixed_step;
    decltype(&ERKStepSetMaxStep) set_longest_step;
    decltype(&ERKStepEvolve) evolve;
    decltype(&ERKStepGetLastStep) last_step;
    decltype(&ERKStepGetCurrentTime) current_time;
    decltype(&ERKStepGetDky) interpolate;
    decltype(&ERKStepGetNumSteps) steps;
};

namespace {

#define TWINCHUTE_ARKODE_CALLS(step)                                                                    \
    {                                                                                                   \
        step##Free, step##SetErrHandlerFn, step##SetUserData, step##SVtolerances, step##SetMaxNumSteps, \
            step##Reset, step##SetInitStep, step##SetStopTime, step##SetFixedStep, step##SetMaxStep,    \
            step##Evolve, step##GetLastStep, step##GetCurrentTime, step##GetDky, step##GetNumSteps      \
    }
constexpr SundialsCalls explicit_calls = TWINCHUTE_ARKODE_CALLS(ERKStep);
constexpr SundialsCalls implicit_calls = TWINCHUTE_ARKODE_CALLS(ARKStep);
#undef TWINCHUTE_ARKODE_CALLS
constexpr SundialsCalls multistep_calls = {
    CVodeFree,   CVodeSetErrHandlerFn, CVodeSetUserData,    CVodeSVtolerances, CVodeSetMaxNumSteps,
    CVodeReInit, CVodeSetInitStep,     CVodeSetStopTime,    nullptr,           CVodeSetMaxStep,
    CVode,       CVodeGetLastStep,     CVodeGetCurrentTime, CVodeGetDky,       CVodeGetNumSteps};
static_assert(ARK_ONE_STEP == CV_ONE_STEP && ARK_TSTOP_RETURN == CV_TSTOP_RETURN);

struct MethodRow {
    OdeMethod method;
    int number;  ///< of ARKODE's table, or of CVODE's family
};

constexpr std::array<MethodRow, 9> method_rows{{
    {{"heun-euler", 2, false, false, "ARKODE HEUN_EULER_2_1_2"}, ARKODE_HEUN_EULER_2_1_2},
    {{"bogacki-shampine", 3, false, false, "ARKODE BOGACKI_SHAMPINE_4_2_3"}, ARKODE_BOGACKI_SHAMPINE_4_2_3},
    {{"zonneveld", 4, false, false, "ARKODE ZONNEVELD_5_3_4"}, ARKODE_ZONNEVELD_5_3_4},
    {{"dormand-prince", 5, false, false, "ARKODE DORMAND_PRINCE_7_4_5"}, ARKODE_DORMAND_PRINCE_7_4_5},
    {{"adams", 12, false, true, "CVODE CV_ADAMS"}, CV_ADAMS},
    {{"kvaerno-3", 3, true, false, "ARKODE KVAERNO_4_2_3"}, ARKODE_KVAERNO_4_2_3},
    {{"kvaerno-4", 4, true, false, "ARKODE KVAERNO_5_3_4"}, ARKODE_KVAERNO_5_3_4},
    {{"kvaerno-5", 5, true, false, "ARKODE KVAERNO_7_4_5"}, ARKODE_KVAERNO_7_4_5},
    {{"bdf", 5, true, true, "CVODE CV_BDF"}, CV_BDF},
}};

constexpr auto methods = [] {
    std::array<OdeMethod, method_rows.size()> list{};
    std::ranges::transform(method_rows, list.begin(), &MethodRow::method);
    return list;
}();
constexpr auto explicit_count =
    static_cast<std::size_t>(std::ranges::count(methods, false, &OdeMethod::implicit));
static_assert(std::ranges::is_partitioned(methods, std::logical_not<>{}, &OdeMethod::implicit));

// Newton's method in these small systems: accuracy is worth more than saving evaluations.
/// Share of the error tolerance that it may leave in a stage; ARKODE's own 0.1 shows in the result. Its
/// Jacobian is that of the step at hand: one kept from before a restart made it stop too early, by far.
constexpr double newton_share = 1e-3;
constexpr int max_newton_iterations = 10;
/// Times that a step is cut before it counts as failed: where a stiff transient sets in it has to become
/// shorter by more than ARKODE's seven cuts.
constexpr int max_step_cuts = 30;
/// A start at a singular point takes some steps before they move the time.
constexpr int max_lost_steps = 100;

/// z = sum c_k x_k; z may be one of them. Debian's makes a pass over memory for each k: of a few numbers that
/// is a fifth of a run. The same order of summation, the same bits.
int combine(int count, realtype* c, N_Vector* x, N_Vector z) {
    constexpr int most = 16;
    if (count < 1 || count > most) return N_VLinearCombination_Serial(count, c, x, z);
    const double* parts[most];
    for (int k = 0; k < count; ++k)
        parts[k] = NV_DATA_S(x[k]);
    double* const result = NV_DATA_S(z);
    for (sunindextype i = 0; i < NV_LENGTH_S(z); ++i) {
        double sum = c[0] * parts[0][i];
        for (int k = 1; k < count; ++k)
            sum += c[k] * parts[k][i];
        result[i] = sum;
    }
    return 0;
}

std::span<double> values(N_Vector v) {
    return {N_VGetArrayPointer(v), static_cast<std::size_t>(N_VGetLength(v))};
}

}  // namespace

std::span<const OdeMethod> ode_methods() {
    return methods;
}
std::span<const OdeMethod> explicit_methods() {
    return ode_methods().first(explicit_count);
}
std::span<const OdeMethod> implicit_methods() {
    return ode_methods().subspan(explicit_count);
}

const OdeMethod* find_ode_method(std::string_view name) {
    const auto row = std::ranges::find(methods, name, &OdeMethod::name);
    return row == methods.end() ? nullptr : &*row;
}

struct OdeSolver::Impl {
    SUNContext context = nullptr;
    N_Vector y = nullptr, atol = nullptr, scratch = nullptr;
    SUNMatrix matrix = nullptr;
    SUNLinearSolver linear_solver = nullptr;
    SUNNonlinearSolver iteration = nullptr;
    bool implicit = false, multistep = false;
    SundialsCalls calls = explicit_calls;
    void* memory = nullptr;
    Rhs rhs;
    int order = 1;  // of the step's start
    int space = 0;  // see dense_output.hpp
    double rtol = 0.0;
    std::int64_t own_calls = 0;  // of the right-hand side, beside SUNDIALS'
    double t = 0.0, previous = 0.0;

    // The last step: dense output takes the rates at its ends, which are evaluated when first asked for.
    std::vector<double> begin_state, begin_rate, end_rate;
    bool has_begin_rate = false, has_end_rate = false;

    Roots roots;
    std::vector<double> start_values, end_values, root_values, root_state;
    int found = -1;        // the function that ended the last step
    bool is_back = false;  // SUNDIALS stands at the end of a step, the caller at a root inside it
    bool has_fixed_step = false;
    int lost_steps = 0;  // one after another
    bool is_new = true;  // no step since the beginning or the last restart
    double stop = std::numeric_limits<double>::infinity();
    Statistics before;  // restarts of multistep methods, which begin to count anew
    double dt_min = std::numeric_limits<double>::infinity(), dt_max = 0.0;
    std::string message;
    std::exception_ptr thrown;  // by the right-hand side: must not cross SUNDIALS' C frames

    ~Impl() {
        if (memory) calls.free(&memory);
        if (iteration) SUNNonlinSolFree(iteration);
        if (linear_solver) SUNLinSolFree(linear_solver);
        if (matrix) SUNMatDestroy(matrix);
        for (N_Vector v : {y, atol, scratch})
            if (v) N_VDestroy(v);
        if (context) SUNContext_Free(&context);
    }

    /// Every return code goes through here.
    void require(int code, const char* call) {
        if (code < 0) throw std::invalid_argument(fmt::format("{} returned {} ({})", call, code, message));
    }

    void create(const MethodRow& row, double t0) {
        implicit = row.method.implicit;
        order = row.method.multistep ? 1 : row.method.order;
        multistep = row.method.multistep;
        calls = multistep ? multistep_calls : implicit ? implicit_calls : explicit_calls;
        memory = multistep  ? CVodeCreate(row.number, context)
                 : implicit ? ARKStepCreate(nullptr, &Impl::call_rhs, t0, y, context)
                            : ERKStepCreate(&Impl::call_rhs, t0, y, context);
        if (!memory) throw std::invalid_argument("SUNDIALS refused the problem");
        if (multistep) require(CVodeInit(memory, &Impl::call_rhs, t0, y), "CVodeInit");
    }

    /// The table of the method, and what its stages or steps are solved by.
    void choose(const MethodRow& row, sunindextype size) {
        if (implicit) {
            matrix = SUNDenseMatrix(size, size, context);
            linear_solver = matrix ? SUNLinSol_Dense(y, matrix, context) : nullptr;
            if (!linear_solver) throw std::invalid_argument("SUNLinSol_Dense refused the problem");
        }
        multistep ? choose_family() : choose_table(row.number);
    }

    void choose_family() {
        require(CVodeSetMaxErrTestFails(memory, max_step_cuts), "SetMaxErrTestFails");
        if (implicit) return require(CVodeSetLinearSolver(memory, linear_solver, matrix), "SetLinearSolver");
        iteration = SUNNonlinSol_FixedPoint(y, 0, context);
        if (!iteration) throw std::invalid_argument("SUNNonlinSol_FixedPoint refused the problem");
        require(CVodeSetNonlinearSolver(memory, iteration), "SetNonlinearSolver");
    }

    void choose_table(int number) {
        if (!implicit) {
            const auto table = static_cast<ARKODE_ERKTableID>(number);
            // By default a step that could grow by less than half stays as it is: a tenth more steps.
            require(ERKStepSetFixedStepBounds(memory, 1.0, 1.0), "SetFixedStepBounds");
            require(ERKStepSetMaxErrTestFails(memory, max_step_cuts), "SetMaxErrTestFails");
            return require(ERKStepSetTableNum(memory, table), "SetTableNum");
        }
        const auto table = static_cast<ARKODE_DIRKTableID>(number);
        require(ARKStepSetTableNum(memory, table, ARKODE_ERK_NONE), "SetTableNum");
        require(ARKStepSetLinearSolver(memory, linear_solver, matrix), "SetLinearSolver");
        require(ARKStepSetNonlinConvCoef(memory, newton_share), "SetNonlinConvCoef");
        require(ARKStepSetMaxErrTestFails(memory, max_step_cuts), "SetMaxErrTestFails");
        require(ARKStepSetLSetupFrequency(memory, 1), "SetLSetupFrequency");
        require(ARKStepSetJacEvalFrequency(memory, 1), "SetJacEvalFrequency");
        require(ARKStepSetMaxNonlinIters(memory, max_newton_iterations), "SetMaxNonlinIters");
    }

    std::int64_t rhs_calls() {
        long by_stages = 0, by_explicit_part = 0, by_jacobian = 0;
        if (multistep) {
            require(CVodeGetNumRhsEvals(memory, &by_stages), "GetNumRhsEvals");
            if (implicit) require(CVodeGetNumLinRhsEvals(memory, &by_jacobian), "GetNumLinRhsEvals");
        } else if (implicit) {
            require(ARKStepGetNumRhsEvals(memory, &by_explicit_part, &by_stages), "GetNumRhsEvals");
            require(ARKStepGetNumLinRhsEvals(memory, &by_jacobian), "GetNumLinRhsEvals");
        } else {
            require(ERKStepGetNumRhsEvals(memory, &by_stages), "GetNumRhsEvals");
        }
        return by_stages + by_jacobian;
    }

    /// Attempts that were not accepted.
    std::int64_t rejected(long steps) {
        long attempts = 0, by_error = 0, by_iteration = 0;
        if (multistep) {
            require(CVodeGetNumErrTestFails(memory, &by_error), "GetNumErrTestFails");
            require(CVodeGetNumNonlinSolvConvFails(memory, &by_iteration), "GetNumNonlinSolvConvFails");
            return by_error + by_iteration;
        }
        const auto get = implicit ? ARKStepGetNumStepAttempts : ERKStepGetNumStepAttempts;
        require(get(memory, &attempts), "GetNumStepAttempts");
        return attempts - steps;
    }

    template <class Call>
    int guarded(Call&& call) {
        try {
            call();
            return 0;
        } catch (...) {
            thrown = std::current_exception();
            return -1;
        }
    }

    static int call_rhs(double t, N_Vector y, N_Vector dydt, void* user) {
        auto& self = *static_cast<Impl*>(user);
        return self.guarded([&] { self.rhs(t, values(y), values(dydt)); });
    }

    void evaluate(double time, std::span<const double> state, std::vector<double>& rate) {
        rate.resize(state.size());
        rhs(time, state, rate);
        ++own_calls;
    }

    /// The state at a time of the last step.
    void look(double time, std::span<double> state) {
        if (multistep) return look_back(time, state);
        if (!has_begin_rate) evaluate(previous, begin_state, begin_rate);
        if (!has_end_rate) evaluate(t, values(y), end_rate);
        has_begin_rate = has_end_rate = true;
        interpolate_step({previous, t, begin_state, begin_rate, values(y), end_rate}, space, time, state);
    }

    /// In what a multistep method remembers.
    void look_back(double time, std::span<double> state) {
        // SUNDIALS refuses times outside its last internal step, and the ends of tiny steps miss it by
        // round-off.
        double length = 0.0, now = 0.0;
        require(calls.last_step(memory, &length), "GetLastStep");
        require(calls.current_time(memory, &now), "GetCurrentTime");
        require(calls.interpolate(memory, std::clamp(time, now - length, now), 0, scratch), "GetDky");
        std::ranges::copy(values(scratch), state.begin());
    }

    /// Looks for the first sign change of a watched function in the last step and goes back to it.
    bool find_root() {
        if (start_values.empty()) return false;
        roots(t, values(y), end_values);
        double first = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < end_values.size(); ++i) {
            const double sign = start_values[i], after = end_values[i];
            if (sign == 0.0 || sign * after > 0.0 || std::isnan(after)) continue;
            const double time = after == 0.0 ? t : crossing(i, sign);
            if (time < first) first = time, found = static_cast<int>(i);
        }
        std::swap(start_values, end_values);  // one that began at zero has the sign of the first step
        if (!(first <= t)) return false;
        go_back(first);
        return true;
    }

    /// The first time, to round-off, at which a function that was `sign` has the other sign, or is zero.
    double crossing(std::size_t i, double sign) {
        // Has the rates evaluated outside of the search, whose C frames nothing may cross.
        look(t, root_state);
        const auto value = [&](double time) {
            const int failed = guarded([&] {
                look(time, root_state);
                roots(time, root_state, root_values);
            });
            return failed ? std::numeric_limits<double>::quiet_NaN() : root_values[i];
        };
        constexpr double closeness = 4.0 * std::numeric_limits<double>::epsilon();
        const double root = root_between(value, previous, t, closeness);
        if (thrown) std::rethrow_exception(std::exchange(thrown, nullptr));
        if (std::isnan(root)) return t;
        double time = root;
        for (double beyond = closeness * std::abs(t); time < t && value(time) * sign > 0.0; beyond *= 2.0)
            time = std::min(root + beyond, t);
        return time;
    }

    void go_back(double time) {
        if (!(time < t)) return;
        look(time, root_state);
        std::ranges::copy(root_state, values(y).begin());
        t = time;
        has_end_rate = false;
        is_back = true;
    }

    /// Before the first step after a restart.
    void begin() {
        is_new = false;
        if (!start_values.empty()) roots(t, values(y), start_values);
        // Multistep methods begin with order one, as SUNDIALS' own first step does.
        if (!has_fixed_step)
            require(calls.set_first_step(memory, multistep ? 0.0 : first_step()), "SetInitStep");
    }

    void begin_step() {
        previous = t;
        begin_state.assign(values(y).begin(), values(y).end());
        begin_rate.swap(end_rate);
        has_begin_rate = std::exchange(has_end_rate, false);
    }

    /// A first step [s] after which the method's error is about a hundredth of its tolerance, from the first
    /// two derivatives (Hairer, Norsett, Wanner, Solving ODEs I, II.4). SUNDIALS' own is right for the
    /// tolerance of an order-one method: it takes five steps to grow out of it.
    double first_step() {
        const std::span<const double> state = values(y);
        evaluate(t, state, end_rate);
        has_end_rate = true;
        const auto norm = [&](std::span<const double> v) {
            double largest = 0.0;
            for (std::size_t i = 0; i < v.size(); ++i)
                largest = std::max(largest, std::abs(v[i]) / (rtol * std::abs(state[i]) + values(atol)[i]));
            return largest;
        };
        const double size = norm(state), rate = norm(end_rate);
        if (!(size > 0.0) || !(rate > 0.0)) return 0.0;
        const double trial = std::min(0.01 * size / rate, stop - t);
        std::vector<double> moved(state.begin(), state.end()), bend;
        for (std::size_t i = 0; i < moved.size(); ++i)
            moved[i] += trial * end_rate[i];
        evaluate(t + trial, moved, bend);
        for (std::size_t i = 0; i < bend.size(); ++i)
            bend[i] = (bend[i] - end_rate[i]) / trial;
        const double steepest = std::max(rate, norm(bend));
        return std::min(100.0 * trial, std::pow(0.01 / steepest, 1.0 / (order + 1.0)));
    }

    static void keep_message(int, const char*, const char* function, char* text, void* user) {
        static_cast<Impl*>(user)->message = fmt::format("{}: {}", function, text);
    }
};

OdeSolver::OdeSolver(const OdeMethod& method, Rhs rhs, double t0, std::span<const double> y0, double rtol,
                     std::span<const double> atol, int space)
    : impl_(std::make_unique<Impl>()) {
    Impl& s = *impl_;
    s.rhs = std::move(rhs);
    s.t = s.previous = t0;
    s.rtol = rtol;
    s.space = space;
    s.root_state.resize(y0.size());
    s.require(SUNContext_Create(nullptr, &s.context), "SUNContext_Create");
    const auto size = static_cast<sunindextype>(y0.size());
    s.y = N_VNew_Serial(size, s.context);
    s.atol = N_VNew_Serial(size, s.context);
    s.scratch = N_VNew_Serial(size, s.context);
    // Both must be set before SUNDIALS clones its work vectors. Fused operations save 15 % of a call.
    s.require(N_VEnableFusedOps_Serial(s.y, SUNTRUE), "N_VEnableFusedOps");
    s.y->ops->nvlinearcombination = combine;
    std::ranges::copy(y0, values(s.y).begin());
    std::ranges::copy(atol, values(s.atol).begin());

    const auto row =
        std::ranges::find(method_rows, method.name, [](const MethodRow& r) { return r.method.name; });
    if (row == method_rows.end())
        throw std::invalid_argument(fmt::format("unknown method '{}'", method.name));
    s.create(*row, t0);
    s.require(s.calls.set_error_handler(s.memory, &Impl::keep_message, &s), "SetErrHandlerFn");
    s.require(s.calls.set_user_data(s.memory, &s), "SetUserData");
    s.require(s.calls.set_tolerances(s.memory, rtol, s.atol), "SVtolerances");
    s.choose(*row, size);
    s.require(s.calls.set_most_steps(s.memory, 1'000'000), "SetMaxNumSteps");
}

OdeSolver::~OdeSolver() = default;

void OdeSolver::restart(double t, std::span<const double> y) {
    Impl& s = *impl_;
    if (s.multistep) {
        s.before = statistics();
        s.own_calls = 0;
    }
    std::ranges::copy(y, values(s.y).begin());
    s.t = s.previous = t;
    s.is_back = s.has_end_rate = false;
    s.is_new = true;
    s.require(s.calls.reset(s.memory, t, s.y), "Reset");
}

void OdeSolver::stop_at(double t) {
    impl_->stop = t;
    impl_->require(impl_->calls.set_stop_time(impl_->memory, t), "SetStopTime");
}

void OdeSolver::fix_step(double dt) {
    if (!impl_->calls.set_fixed_step) throw std::invalid_argument("multistep methods have no fixed steps");
    impl_->has_fixed_step = dt != 0.0;
    impl_->require(impl_->calls.set_fixed_step(impl_->memory, dt), "SetFixedStep");
}

void OdeSolver::limit_step(double dt) {
    impl_->require(impl_->calls.set_longest_step(impl_->memory, dt), "SetMaxStep");
}

void OdeSolver::watch(int count, Roots roots) {
    Impl& s = *impl_;
    s.roots = std::move(roots);
    for (std::vector<double>* list : {&s.start_values, &s.end_values, &s.root_values})
        list->resize(static_cast<std::size_t>(count));
    if (count > 0) s.roots(s.t, values(s.y), s.start_values);
}

OdeSolver::Outcome OdeSolver::advance(double longest) {
    Impl& s = *impl_;
    if (s.is_back) {
        restart(s.t, std::vector<double>(state().begin(), state().end()));
        if (std::isfinite(s.stop)) stop_at(s.stop);  // forgotten by CVODE
    }
    if (s.is_new) s.begin();
    s.begin_step();
    // A limit that SUNDIALS has one for acts on the step after the next: the length of this one is known.
    const double left = s.stop - s.t;
    const bool is_limited = longest < left;
    const double limit = s.t + std::min(longest, 0.5 * left);  // and leaves no sliver of a step
    if (is_limited) s.require(s.calls.set_stop_time(s.memory, limit), "SetStopTime");
    double reached = s.t;
    // In one-step mode the time asked for only tells the direction.
    const int code = s.calls.evolve(s.memory, s.t + 1.0, s.y, &reached, ARK_ONE_STEP);
    if (s.thrown) std::rethrow_exception(std::exchange(s.thrown, nullptr));
    if (code < 0) {
        s.message = fmt::format("{} returned {} at t = {:.6g} s ({})", s.multistep ? "CVODE" : "ARKODE", code,
                                reached, s.message);
        return Outcome::failed;
    }
    // At the end of a solution SUNDIALS goes on with steps that are lost in the rounding of the time.
    s.lost_steps = reached > s.t ? 0 : s.lost_steps + 1;
    if (s.lost_steps > max_lost_steps) {
        s.message = fmt::format("steps became shorter than round-off at t = {:.6g} s", s.t);
        return Outcome::failed;
    }
    s.t = reached;
    if (is_limited) s.require(s.calls.set_stop_time(s.memory, s.stop), "SetStopTime");
    const bool found = s.find_root();
    s.dt_min = std::min(s.dt_min, s.t - s.previous);
    s.dt_max = std::max(s.dt_max, s.t - s.previous);
    if (found) return Outcome::found_root;
    return code == ARK_TSTOP_RETURN && !is_limited ? Outcome::reached_stop : Outcome::stepped;
}

double OdeSolver::time() const {
    return impl_->t;
}
double OdeSolver::previous_time() const {
    return impl_->previous;
}
std::span<const double> OdeSolver::state() const {
    return values(impl_->y);
}

void OdeSolver::interpolate(double t, std::span<double> y) const {
    impl_->look(t, y);
}

int OdeSolver::root() const {
    return impl_->found;
}

const std::string& OdeSolver::failure() const {
    return impl_->message;
}

OdeSolver::Statistics OdeSolver::statistics() const {
    Impl& s = *impl_;
    long steps = 0;
    s.require(s.calls.steps(s.memory, &steps), "GetNumSteps");
    const std::int64_t all_steps = s.before.steps + steps;
    return {all_steps, s.before.rhs_calls + s.rhs_calls() + s.own_calls,
            s.before.rejected + s.rejected(steps), all_steps > 0 ? s.dt_min : 0.0, s.dt_max};
}

}  // namespace twinchute
