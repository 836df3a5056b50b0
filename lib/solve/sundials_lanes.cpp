#include "lib/solve/sundials_lanes.hpp"

#include <arkode/arkode_erkstep.h>
#include <fmt/format.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <stdexcept>
#include <utility>

#include "lib/math/wide_loops.hpp"

namespace twinchute {
namespace {

// Debian's serial vectors are compiled without vector instructions: more than half of a step's time. Work
// vectors take these operations over from the first one when SUNDIALS clones it.

TWINCHUTE_WIDE_LOOPS
void sum_of(double a, const double* x, double b, const double* y, double* z, sunindextype n) {
    for (sunindextype i = 0; i < n; ++i)
        z[i] = a * x[i] + b * y[i];
}

void linear_sum(realtype a, N_Vector x, realtype b, N_Vector y, N_Vector z) {
    sum_of(a, NV_DATA_S(x), b, NV_DATA_S(y), NV_DATA_S(z), NV_LENGTH_S(x));
}

TWINCHUTE_WIDE_LOOPS
void scaled(double c, const double* x, double* z, sunindextype n) {
    for (sunindextype i = 0; i < n; ++i)
        z[i] = c * x[i];
}

void scale(realtype c, N_Vector x, N_Vector z) {
    scaled(c, NV_DATA_S(x), NV_DATA_S(z), NV_LENGTH_S(x));
}

/// z = sum c_k x_k of a known number of vectors, which a compiler keeps in registers.
template <int count>
[[gnu::always_inline]] inline void combine_some(const double* c, const double* const* x, double* z,
                                                sunindextype n) {
    double factors[count];
    const double* parts[count];
    for (int k = 0; k < count; ++k)
        factors[k] = c[k], parts[k] = x[k];
        // z may be one of them: each number is read before it is written.
#ifndef __clang__
#pragma GCC ivdep
#endif
    for (sunindextype i = 0; i < n; ++i) {
        double sum = factors[0] * parts[0][i];
        for (int k = 1; k < count; ++k)
            sum += factors[k] * parts[k][i];
        z[i] = sum;
    }
}

/// z = sum c_k x_k, of eight at most; z may be one of them.
TWINCHUTE_WIDE_LOOPS
void combine(int count, const double* c, const double* const* x, double* z, sunindextype n) {
    switch (count) {
        case 1:
            return combine_some<1>(c, x, z, n);
        case 2:
            return combine_some<2>(c, x, z, n);
        case 3:
            return combine_some<3>(c, x, z, n);
        case 4:
            return combine_some<4>(c, x, z, n);
        case 5:
            return combine_some<5>(c, x, z, n);
        case 6:
            return combine_some<6>(c, x, z, n);
        case 7:
            return combine_some<7>(c, x, z, n);
        default:
            return combine_some<8>(c, x, z, n);
    }
}

int linear_combination(int count, realtype* c, N_Vector* x, N_Vector z) {
    constexpr int most = 8;  // seven stages and a state
    if (count < 1 || count > most) return -1;
    const double* parts[most];
    for (int k = 0; k < count; ++k)
        parts[k] = NV_DATA_S(x[k]);
    combine(count, c, parts, NV_DATA_S(z), NV_LENGTH_S(z));
    return 0;
}

/// The largest weighted root mean square over the components of one lane. `lanes`: of the vector.
TWINCHUTE_WIDE_LOOPS
double worst_lane(const double* x, const double* w, sunindextype lanes, sunindextype n) {
    double worst = 0.0;
    constexpr sunindextype block = 16;
    for (sunindextype from = 0; from < lanes; from += block) {
        double sum[block] = {};
        for (sunindextype at = from; at < n; at += lanes)
            for (sunindextype j = 0; j < block; ++j) {
                const double error = x[at + j] * w[at + j];
                sum[j] += error * error;
            }
        for (const double s : sum)
            worst = s > worst || std::isnan(s) ? s : worst;
    }
    return std::sqrt(worst * static_cast<double>(lanes) / static_cast<double>(n));
}

/// A vector with its number of lanes: SUNDIALS gives a norm nothing but the vectors.
thread_local sunindextype lanes_now = 1;

realtype worst_norm(N_Vector x, N_Vector w) {
    return worst_lane(NV_DATA_S(x), NV_DATA_S(w), lanes_now, NV_LENGTH_S(x));
}

}  // namespace

struct LaneSolver::Impl {
    SUNContext context = nullptr;
    N_Vector y = nullptr;
    void* memory = nullptr;
    Rhs rhs;
    int lanes = 0;
    double rtol = 0.0, scale = 1.0;
    std::exception_ptr thrown;

    ~Impl() {
        if (memory) ERKStepFree(&memory);
        if (y) N_VDestroy(y);
        if (context) SUNContext_Free(&context);
    }

    static void require(int code, const char* call) {
        if (code < 0) throw std::invalid_argument(fmt::format("{} returned {}", call, code));
    }

    static int call_rhs(double s, N_Vector y, N_Vector dyds, void* user) {
        auto& self = *static_cast<Impl*>(user);
        try {
            self.rhs(s, NV_DATA_S(y), NV_DATA_S(dyds));
            return 0;
        } catch (...) {
            self.thrown = std::current_exception();
            return -1;
        }
    }

    static int call_weights(N_Vector y, N_Vector weights, void* user) {
        const auto& self = *static_cast<Impl*>(user);
        const double *from = NV_DATA_S(y), rtol = self.rtol, scale = self.scale;
        double* to = NV_DATA_S(weights);
        for (sunindextype i = 0; i < NV_LENGTH_S(y); ++i)
            to[i] = 1.0 / (rtol * (std::abs(from[i]) + scale));
        return 0;
    }

    static void say_nothing(int, const char*, const char*, char*, void*) {}
};

LaneSolver::LaneSolver(int lanes, int components, Rhs rhs, double rtol, double scale_of)
    : impl_(std::make_unique<Impl>()) {
    Impl& s = *impl_;
    s.rhs = std::move(rhs);
    s.lanes = lanes;
    s.rtol = rtol;
    s.scale = scale_of;
    constexpr int block = 16;
    if (lanes % block != 0) throw std::invalid_argument("lanes come in sixteens");
    Impl::require(SUNContext_Create(nullptr, &s.context), "SUNContext_Create");
    s.y = N_VNew_Serial(static_cast<sunindextype>(lanes) * components, s.context);
    N_VConst(0.0, s.y);
    s.y->ops->nvlinearsum = linear_sum;
    s.y->ops->nvscale = scale;
    s.y->ops->nvlinearcombination = linear_combination;
    s.y->ops->nvwrmsnorm = worst_norm;
    s.memory = ERKStepCreate(&Impl::call_rhs, 0.0, s.y, s.context);
    if (!s.memory) throw std::invalid_argument("SUNDIALS refused the problem");
    Impl::require(ERKStepSetErrHandlerFn(s.memory, &Impl::say_nothing, nullptr), "SetErrHandlerFn");
    Impl::require(ERKStepSetUserData(s.memory, &s), "SetUserData");
    Impl::require(ERKStepWFtolerances(s.memory, &Impl::call_weights), "WFtolerances");
    Impl::require(ERKStepSetTableNum(s.memory, ARKODE_DORMAND_PRINCE_7_4_5), "SetTableNum");
    Impl::require(ERKStepSetFixedStepBounds(s.memory, 1.0, 1.0), "SetFixedStepBounds");
    Impl::require(ERKStepSetMaxNumSteps(s.memory, 100'000), "SetMaxNumSteps");
}

LaneSolver::~LaneSolver() = default;

void LaneSolver::start(std::span<const double> state) {
    Impl& s = *impl_;
    std::ranges::copy(state, NV_DATA_S(s.y));
    lanes_now = s.lanes;
    // Anew, not a reset: step and error history of the batch before would show in this one.
    Impl::require(ERKStepReInit(s.memory, &Impl::call_rhs, 0.0, s.y), "ReInit");
    Impl::require(ERKStepSetStopTime(s.memory, 1.0), "SetStopTime");
    constexpr double first_step = 0.05, first_growth = 5.0;
    Impl::require(ERKStepSetInitStep(s.memory, first_step), "SetInitStep");
    Impl::require(ERKStepSetMaxFirstGrowth(s.memory, first_growth), "SetMaxFirstGrowth");
    s_ = 0.0;
}

bool LaneSolver::step() {
    Impl& s = *impl_;
    lanes_now = s.lanes;
    const int code = ERKStepEvolve(s.memory, 2.0, s.y, &s_, ARK_ONE_STEP);
    if (s.thrown) std::rethrow_exception(std::exchange(s.thrown, nullptr));
    return code >= 0;
}

std::span<const double> LaneSolver::state() const {
    return {NV_DATA_S(impl_->y), static_cast<std::size_t>(NV_LENGTH_S(impl_->y))};
}

}  // namespace twinchute
