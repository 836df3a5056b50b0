// Integration of many small problems of one kind by SUNDIALS at once: in steps that they share, a lane each.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>

namespace twinchute {

/// Problems whose events coincide, each in its own normalised time: Dormand and Prince's pair (ARKODE), with
/// vector operations that compilers vectorise, and the error of the worst lane as that of the step. Steps
/// depend on all lanes: the same lanes give the same bits, others others within the tolerance.
///
/// A state is laid out by component: all lanes of the first, then all lanes of the second, ...
class LaneSolver {
public:
    /// dy/ds = f(s, y), of all lanes.
    using Rhs = std::function<void(double s, const double* y, double* dyds)>;

    /// `rtol` relative tolerance, `scale` of a component below which it is absolute. Throws
    /// std::invalid_argument where SUNDIALS refuses its arguments.
    LaneSolver(int lanes, int components, Rhs rhs, double rtol, double scale);
    ~LaneSolver();
    LaneSolver(const LaneSolver&) = delete;
    LaneSolver& operator=(const LaneSolver&) = delete;

    /// Begins anew at s = 0 and stops at s = 1; nothing is left of what was before.
    void start(std::span<const double> state);
    /// One step; false where it failed.
    bool step();
    bool at_end() const { return s_ >= 1.0; }
    double s() const { return s_; }
    std::span<const double> state() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
    double s_ = 0.0;
};

}  // namespace twinchute
