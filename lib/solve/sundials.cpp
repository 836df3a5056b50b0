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
#include <exception>
#include <functional>
#include <limits>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace twinchute {
namespace {

/// SUNDIALS offers the same calls three times: for explicit and for implicit Runge-Kutta methods, and for
/// multistep ones, which have neither a choice of interpolants nor fixed steps (null here).
struct Calls {
    decltype(&ERKStepFree) free;
    decltype(&ERKStepSetErrHandlerFn) set_error_handler;
    decltype(&ERKStepSetUserData) set_user_data;
    decltype(&ERKStepSVtolerances) set_tolerances;
    decltype(&ERKStepSetInterpolantType) set_interpolant;
    decltype(&ERKStepSetMaxNumSteps) set_most_steps;
    decltype(&ERKStepReset) reset;
    decltype(&ERKStepSetInitStep) set_first_step;
    decltype(&ERKStepSetStopTime) set_stop_time;
    decltype(&ERKStepSetFixedStep) set_fixed_step;
    decltype(&ERKStepSetMaxStep) set_longest_step;
    decltype(&ERKStepRootInit) watch_roots;
    decltype(&ERKStepSetNoInactiveRootWarn) silence_inactive_roots;
    decltype(&ERKStepEvolve) evolve;
    decltype(&ERKStepGetLastStep) last_step;
    decltype(&ERKStepGetCurrentTime) current_time;
    decltype(&ERKStepGetDky) interpolate;
    decltype(&ERKStepGetRootInfo) found_roots;
    decltype(&ERKStepGetNumSteps) steps;
};

#define TWINCHUTE_ARKODE_CALLS(step)                                                                        \
    {                                                                                                       \
        step##Free, step##SetErrHandlerFn, step##SetUserData, step##SVtolerances, step##SetInterpolantType, \
            step##SetMaxNumSteps, step##Reset, step##SetInitStep, step##SetStopTime, step##SetFixedStep,    \
            step##SetMaxStep, step##RootInit, step##SetNoInactiveRootWarn, step##Evolve, step##GetLastStep, \
            step##GetCurrentTime, step##GetDky, step##GetRootInfo, step##GetNumSteps                        \
    }
constexpr Calls explicit_calls = TWINCHUTE_ARKODE_CALLS(ERKStep);
constexpr Calls implicit_calls = TWINCHUTE_ARKODE_CALLS(ARKStep);
#undef TWINCHUTE_ARKODE_CALLS
constexpr Calls multistep_calls = {CVodeFree,
                                   CVodeSetErrHandlerFn,
                                   CVodeSetUserData,
                                   CVodeSVtolerances,
                                   nullptr,
                                   CVodeSetMaxNumSteps,
                                   CVodeReInit,
                                   CVodeSetInitStep,
                                   CVodeSetStopTime,
                                   nullptr,
                                   CVodeSetMaxStep,
                                   CVodeRootInit,
                                   CVodeSetNoInactiveRootWarn,
                                   CVode,
                                   CVodeGetLastStep,
                                   CVodeGetCurrentTime,
                                   CVodeGetDky,
                                   CVodeGetRootInfo,
                                   CVodeGetNumSteps};
static_assert(ARK_ONE_STEP == CV_ONE_STEP && ARK_ROOT_RETURN == CV_ROOT_RETURN &&
              ARK_TSTOP_RETURN == CV_TSTOP_RETURN);

struct MethodRow {
    OdeMethod method;
    int number;  ///< of ARKODE's table, or of CVODE's family
};

constexpr std::array<MethodRow, 9> rows{{
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
    std::array<OdeMethod, rows.size()> list{};
    std::ranges::transform(rows, list.begin(), &MethodRow::method);
    return list;
}();
constexpr auto explicit_count =
    static_cast<std::size_t>(std::ranges::count(methods, false, &OdeMethod::implicit));
static_assert(std::ranges::is_partitioned(methods, std::logical_not<>{}, &OdeMethod::implicit));

// Newton's method in these small systems: accuracy is worth more than saving evaluations.
/// Share of the error tolerance that it may leave in a stage; ARKODE's own 0.1 shows in the result. Its
/// Jacobian is that of the step at hand: one kept from before a restart made it stop too early, by far.
constexpr double newton_share = 1e-3;
constexpr int most_newton_iterations = 10;
/// Times that a step is cut before it counts as failed: where a stiff transient sets in it has to become
/// shorter by more than ARKODE's seven cuts.
constexpr int most_step_cuts = 30;

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
    Calls calls = explicit_calls;
    void* memory = nullptr;
    Rhs rhs;
    Roots roots;
    int root_count = 0;
    double t = 0.0, previous = 0.0;
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
        require(CVodeSetMaxErrTestFails(memory, most_step_cuts), "SetMaxErrTestFails");
        if (implicit) return require(CVodeSetLinearSolver(memory, linear_solver, matrix), "SetLinearSolver");
        iteration = SUNNonlinSol_FixedPoint(y, 0, context);
        if (!iteration) throw std::invalid_argument("SUNNonlinSol_FixedPoint refused the problem");
        require(CVodeSetNonlinearSolver(memory, iteration), "SetNonlinearSolver");
    }

    void choose_table(int number) {
        if (!implicit) {
            const auto table = static_cast<ARKODE_ERKTableID>(number);
            return require(ERKStepSetTableNum(memory, table), "SetTableNum");
        }
        const auto table = static_cast<ARKODE_DIRKTableID>(number);
        require(ARKStepSetTableNum(memory, table, ARKODE_ERK_NONE), "SetTableNum");
        require(ARKStepSetLinearSolver(memory, linear_solver, matrix), "SetLinearSolver");
        require(ARKStepSetNonlinConvCoef(memory, newton_share), "SetNonlinConvCoef");
        require(ARKStepSetMaxErrTestFails(memory, most_step_cuts), "SetMaxErrTestFails");
        require(ARKStepSetLSetupFrequency(memory, 1), "SetLSetupFrequency");
        require(ARKStepSetJacEvalFrequency(memory, 1), "SetJacEvalFrequency");
        require(ARKStepSetMaxNonlinIters(memory, most_newton_iterations), "SetMaxNonlinIters");
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

    static int call_roots(double t, N_Vector y, double* g, void* user) {
        auto& self = *static_cast<Impl*>(user);
        return self.guarded(
            [&] { self.roots(t, values(y), std::span(g, static_cast<std::size_t>(self.root_count))); });
    }

    static void keep_message(int, const char*, const char* function, char* text, void* user) {
        static_cast<Impl*>(user)->message = fmt::format("{}: {}", function, text);
    }
};

OdeSolver::OdeSolver(const OdeMethod& method, Rhs rhs, double t0, std::span<const double> y0, double rtol,
                     std::span<const double> atol)
    : impl_(std::make_unique<Impl>()) {
    Impl& s = *impl_;
    s.rhs = std::move(rhs);
    s.t = s.previous = t0;
    s.require(SUNContext_Create(nullptr, &s.context), "SUNContext_Create");
    const auto size = static_cast<sunindextype>(y0.size());
    s.y = N_VNew_Serial(size, s.context);
    s.atol = N_VNew_Serial(size, s.context);
    s.scratch = N_VNew_Serial(size, s.context);
    // Fused vector operations must be on before ARKODE clones its work vectors: 15 % of a call.
    s.require(N_VEnableFusedOps_Serial(s.y, SUNTRUE), "N_VEnableFusedOps");
    std::ranges::copy(y0, values(s.y).begin());
    std::ranges::copy(atol, values(s.atol).begin());

    const auto row = std::ranges::find(rows, method.name, [](const MethodRow& r) { return r.method.name; });
    if (row == rows.end()) throw std::invalid_argument(fmt::format("unknown method '{}'", method.name));
    s.create(*row, t0);
    s.require(s.calls.set_error_handler(s.memory, &Impl::keep_message, &s), "SetErrHandlerFn");
    s.require(s.calls.set_user_data(s.memory, &s), "SetUserData");
    s.require(s.calls.set_tolerances(s.memory, rtol, s.atol), "SVtolerances");
    s.choose(*row, size);
    if (s.calls.set_interpolant)
        s.require(s.calls.set_interpolant(s.memory, ARK_INTERP_HERMITE), "SetInterpolantType");
    s.require(s.calls.set_most_steps(s.memory, 1'000'000), "SetMaxNumSteps");
}

OdeSolver::~OdeSolver() = default;

void OdeSolver::restart(double t, std::span<const double> y) {
    Impl& s = *impl_;
    if (s.multistep) s.before = statistics();
    std::ranges::copy(y, values(s.y).begin());
    s.t = s.previous = t;
    s.require(s.calls.reset(s.memory, t, s.y), "Reset");
    s.require(s.calls.set_first_step(s.memory, 0.0), "SetInitStep");
}

void OdeSolver::stop_at(double t) {
    impl_->require(impl_->calls.set_stop_time(impl_->memory, t), "SetStopTime");
}

void OdeSolver::fix_step(double dt) {
    if (!impl_->calls.set_fixed_step) throw std::invalid_argument("multistep methods have no fixed steps");
    impl_->require(impl_->calls.set_fixed_step(impl_->memory, dt), "SetFixedStep");
}

void OdeSolver::limit_step(double dt) {
    impl_->require(impl_->calls.set_longest_step(impl_->memory, dt), "SetMaxStep");
}

void OdeSolver::watch(int count, Roots roots) {
    Impl& s = *impl_;
    s.roots = std::move(roots);
    s.root_count = count;
    s.require(s.calls.watch_roots(s.memory, count, count > 0 ? &Impl::call_roots : nullptr), "RootInit");
    if (count > 0) s.require(s.calls.silence_inactive_roots(s.memory), "SetNoInactiveRootWarn");
}

OdeSolver::Outcome OdeSolver::advance() {
    Impl& s = *impl_;
    double reached = s.t;
    // In one-step mode the time asked for only tells the direction.
    const int code = s.calls.evolve(s.memory, s.t + 1.0, s.y, &reached, ARK_ONE_STEP);
    if (s.thrown) std::rethrow_exception(std::exchange(s.thrown, nullptr));
    if (code < 0) {
        s.message = fmt::format("{} returned {} at t = {:.6g} s ({})", s.multistep ? "CVODE" : "ARKODE", code,
                                reached, s.message);
        return Outcome::failed;
    }
    s.previous = s.t;
    s.t = reached;
    s.dt_min = std::min(s.dt_min, s.t - s.previous);
    s.dt_max = std::max(s.dt_max, s.t - s.previous);
    if (code == ARK_ROOT_RETURN) return Outcome::found_root;
    return code == ARK_TSTOP_RETURN ? Outcome::reached_stop : Outcome::stepped;
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
    Impl& s = *impl_;
    // SUNDIALS refuses times outside its last internal step, and the ends of tiny steps miss it by
    // round-off.
    double length = 0.0, now = 0.0;
    s.require(s.calls.last_step(s.memory, &length), "GetLastStep");
    s.require(s.calls.current_time(s.memory, &now), "GetCurrentTime");
    t = std::clamp(t, now - length, now);
    s.require(s.calls.interpolate(s.memory, t, 0, s.scratch), "GetDky");
    std::ranges::copy(values(s.scratch), y.begin());
}

int OdeSolver::root() const {
    std::vector<int> found(static_cast<std::size_t>(impl_->root_count));
    impl_->require(impl_->calls.found_roots(impl_->memory, found.data()), "GetRootInfo");
    const auto first = std::ranges::find_if(found, [](int sign) { return sign != 0; });
    return static_cast<int>(first - found.begin());
}

const std::string& OdeSolver::failure() const {
    return impl_->message;
}

OdeSolver::Statistics OdeSolver::statistics() const {
    Impl& s = *impl_;
    long steps = 0;
    s.require(s.calls.steps(s.memory, &steps), "GetNumSteps");
    const std::int64_t all_steps = s.before.steps + steps;
    return {all_steps, s.before.rhs_calls + s.rhs_calls(), s.before.rejected + s.rejected(steps),
            all_steps > 0 ? s.dt_min : 0.0, s.dt_max};
}

}  // namespace twinchute
