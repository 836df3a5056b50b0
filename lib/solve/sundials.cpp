#include "lib/solve/sundials.hpp"

#include <arkode/arkode_erkstep.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>

#include <algorithm>
#include <array>
#include <exception>
#include <limits>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace twinchute {
namespace {

struct MethodRow {
    ExplicitMethod method;
    ARKODE_ERKTableID table;
};

constexpr std::array<MethodRow, 4> rows{{
    {{"heun-euler", 2, "ARKODE HEUN_EULER_2_1_2"}, ARKODE_HEUN_EULER_2_1_2},
    {{"bogacki-shampine", 3, "ARKODE BOGACKI_SHAMPINE_4_2_3"}, ARKODE_BOGACKI_SHAMPINE_4_2_3},
    {{"zonneveld", 4, "ARKODE ZONNEVELD_5_3_4"}, ARKODE_ZONNEVELD_5_3_4},
    {{"dormand-prince", 5, "ARKODE DORMAND_PRINCE_7_4_5"}, ARKODE_DORMAND_PRINCE_7_4_5},
}};

std::span<double> values(N_Vector v) {
    return {N_VGetArrayPointer(v), static_cast<std::size_t>(N_VGetLength(v))};
}

}  // namespace

std::span<const ExplicitMethod> explicit_methods() {
    static const auto methods = [] {
        std::array<ExplicitMethod, rows.size()> list{};
        std::ranges::transform(rows, list.begin(), &MethodRow::method);
        return list;
    }();
    return methods;
}

const ExplicitMethod* find_explicit_method(std::string_view name) {
    const auto all = explicit_methods();
    const auto row = std::ranges::find(all, name, &ExplicitMethod::name);
    return row == all.end() ? nullptr : &*row;
}

struct ErkSolver::Impl {
    SUNContext context = nullptr;
    N_Vector y = nullptr, atol = nullptr, scratch = nullptr;
    void* memory = nullptr;
    Rhs rhs;
    Roots roots;
    int root_count = 0;
    double t = 0.0, previous = 0.0;
    double dt_min = std::numeric_limits<double>::infinity(), dt_max = 0.0;
    std::string message;
    std::exception_ptr thrown;  // by the right-hand side: must not cross SUNDIALS' C frames

    ~Impl() {
        if (memory) ERKStepFree(&memory);
        for (N_Vector v : {y, atol, scratch})
            if (v) N_VDestroy(v);
        if (context) SUNContext_Free(&context);
    }

    /// Every return code goes through here.
    void require(int code, const char* call) {
        if (code < 0) throw std::invalid_argument(fmt::format("{} returned {} ({})", call, code, message));
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

ErkSolver::ErkSolver(const ExplicitMethod& method, Rhs rhs, double t0, std::span<const double> y0,
                     double rtol, std::span<const double> atol)
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

    s.memory = ERKStepCreate(&Impl::call_rhs, t0, s.y, s.context);
    if (!s.memory) throw std::invalid_argument("ERKStepCreate refused the problem");
    s.require(ERKStepSetErrHandlerFn(s.memory, &Impl::keep_message, &s), "ERKStepSetErrHandlerFn");
    s.require(ERKStepSetUserData(s.memory, &s), "ERKStepSetUserData");
    s.require(ERKStepSVtolerances(s.memory, rtol, s.atol), "ERKStepSVtolerances");
    const auto row =
        std::ranges::find_if(rows, [&](const MethodRow& r) { return r.method.name == method.name; });
    if (row == rows.end()) throw std::invalid_argument(fmt::format("unknown method '{}'", method.name));
    s.require(ERKStepSetTableNum(s.memory, row->table), "ERKStepSetTableNum");
    s.require(ERKStepSetInterpolantType(s.memory, ARK_INTERP_HERMITE), "ERKStepSetInterpolantType");
    s.require(ERKStepSetMaxNumSteps(s.memory, 1'000'000), "ERKStepSetMaxNumSteps");
}

ErkSolver::~ErkSolver() = default;

void ErkSolver::restart(double t, std::span<const double> y) {
    Impl& s = *impl_;
    std::ranges::copy(y, values(s.y).begin());
    s.t = s.previous = t;
    s.require(ERKStepReset(s.memory, t, s.y), "ERKStepReset");
    s.require(ERKStepSetInitStep(s.memory, 0.0), "ERKStepSetInitStep");
}

void ErkSolver::stop_at(double t) {
    impl_->require(ERKStepSetStopTime(impl_->memory, t), "ERKStepSetStopTime");
}

void ErkSolver::fix_step(double dt) {
    impl_->require(ERKStepSetFixedStep(impl_->memory, dt), "ERKStepSetFixedStep");
}

void ErkSolver::watch(int count, Roots roots) {
    Impl& s = *impl_;
    s.roots = std::move(roots);
    s.root_count = count;
    s.require(ERKStepRootInit(s.memory, count, count > 0 ? &Impl::call_roots : nullptr), "ERKStepRootInit");
    if (count > 0) s.require(ERKStepSetNoInactiveRootWarn(s.memory), "ERKStepSetNoInactiveRootWarn");
}

ErkSolver::Outcome ErkSolver::advance() {
    Impl& s = *impl_;
    double reached = s.t;
    // In one-step mode the time asked for only tells the direction.
    const int code = ERKStepEvolve(s.memory, s.t + 1.0, s.y, &reached, ARK_ONE_STEP);
    if (s.thrown) std::rethrow_exception(std::exchange(s.thrown, nullptr));
    if (code < 0) {
        s.message = fmt::format("ERKStepEvolve returned {} at t = {:.6g} s ({})", code, reached, s.message);
        return Outcome::failed;
    }
    s.previous = s.t;
    s.t = reached;
    s.dt_min = std::min(s.dt_min, s.t - s.previous);
    s.dt_max = std::max(s.dt_max, s.t - s.previous);
    if (code == ARK_ROOT_RETURN) return Outcome::found_root;
    return code == ARK_TSTOP_RETURN ? Outcome::reached_stop : Outcome::stepped;
}

double ErkSolver::time() const {
    return impl_->t;
}
double ErkSolver::previous_time() const {
    return impl_->previous;
}
std::span<const double> ErkSolver::state() const {
    return values(impl_->y);
}

void ErkSolver::interpolate(double t, std::span<double> y) const {
    Impl& s = *impl_;
    // ARKODE refuses times outside its last internal step, and the ends of tiny steps miss it by
    // round-off.
    double length = 0.0, now = 0.0;
    s.require(ERKStepGetLastStep(s.memory, &length), "ERKStepGetLastStep");
    s.require(ERKStepGetCurrentTime(s.memory, &now), "ERKStepGetCurrentTime");
    t = std::clamp(t, now - length, now);
    s.require(ERKStepGetDky(s.memory, t, 0, s.scratch), "ERKStepGetDky");
    std::ranges::copy(values(s.scratch), y.begin());
}

int ErkSolver::root() const {
    std::vector<int> found(static_cast<std::size_t>(impl_->root_count));
    impl_->require(ERKStepGetRootInfo(impl_->memory, found.data()), "ERKStepGetRootInfo");
    const auto first = std::ranges::find_if(found, [](int sign) { return sign != 0; });
    return static_cast<int>(first - found.begin());
}

const std::string& ErkSolver::failure() const {
    return impl_->message;
}

ErkSolver::Statistics ErkSolver::statistics() const {
    Impl& s = *impl_;
    long steps = 0, attempts = 0, calls = 0;
    s.require(ERKStepGetNumSteps(s.memory, &steps), "ERKStepGetNumSteps");
    s.require(ERKStepGetNumStepAttempts(s.memory, &attempts), "ERKStepGetNumStepAttempts");
    s.require(ERKStepGetNumRhsEvals(s.memory, &calls), "ERKStepGetNumRhsEvals");
    return {steps, calls, attempts - steps, steps > 0 ? s.dt_min : 0.0, s.dt_max};
}

}  // namespace twinchute
