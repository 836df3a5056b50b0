// Readings that a model predicts for a test: its channels on the clock of the test, through the
// instrument.
#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "lib/solve/fidelity.hpp"
#include "study/calibrate/drop_test.hpp"

namespace twinchute::study {

/// Prediction of one run for a test: values of its histories at their times, then its scalars.
struct Predicted {
    std::vector<std::vector<double>> histories;
    std::vector<double> scalars;
};

/// A test, and the moments at which a model has to be asked for it.
class Prediction {
public:
    /// `fidelity`: gives samples. It and the test outlive this.
    Prediction(const DropTest& test, const Fidelity& fidelity);

    /// Nothing where the run failed, or has not got a scalar. `offset` [s]: time of the test at which the
    /// model releases. Before its beginning and after its end a run stands still.
    std::optional<Predicted> at(const Scene& scene, double offset) const;
    /// Histories for several offsets, of one run without instrument: to look for the right one.
    std::optional<std::vector<Predicted>> scan(const Scene& scene, std::span<const double> offsets) const;

    /// [s] since release from snatch to full open; both 0 where the run does not tell.
    std::pair<double, double> filling(const Scene& scene) const;

    const DropTest& test() const { return test_; }
    int runs() const { return runs_; }  ///< so far

private:
    struct Sampled {
        std::vector<double> time;
        std::vector<std::vector<double>> channels;  ///< one a history, or empty where the run has none
    };
    std::optional<Sampled> sampled(const Scene& scene, const std::vector<double>& times) const;

    const DropTest& test_;
    const Fidelity& fidelity_;
    std::vector<double> grid_;                      ///< [s] on the clock of the test
    std::vector<std::vector<std::size_t>> places_;  ///< of each history's times in it
    double scan_rate_ = 1.0;                        ///< [1/s] of scan()'s run
    mutable int runs_ = 0;
};

/// [-] Relative tolerance of runs that are compared with each other: quotients of small differences.
inline constexpr double tight_tolerance = 1e-8;

}  // namespace twinchute::study
