// Problems of the reduced-order model, for integrators that know nothing of scenes: right-hand sides that are
// smooth within each stage.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace twinchute::bench {

/// First step of a stage, for libraries that ask for one.
inline constexpr double first_step = 1e-3;

struct Stage {
    double end = 0.0;  ///< [s] from the start of the problem
    std::function<void(double t, const double* y, double* dydt)> rhs;
    /// Changes the state at the stage's start; empty: it goes on.
    std::function<std::vector<double>(const std::vector<double>&)> enter = {};
};

struct Problem {
    std::string name, title, subtitle;
    std::string error;               ///< what its error is of
    std::vector<double> start = {};  ///< [m], [m/s]
    std::vector<double> scale = {};  ///< of each component at the end: error over this is relative
    std::vector<Stage> stages = {};
    mutable std::int64_t calls = 0;  ///< of all stages
};

/// Crane drop, 100 s of descent, an elastic snatch at the printed line modulus, an opening in two stages.
std::vector<std::unique_ptr<Problem>> work_problems();

}  // namespace twinchute::bench
