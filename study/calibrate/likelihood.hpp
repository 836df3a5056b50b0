// How likely values of the inputs make what was measured: runs of the model, through the instruments, against
// the readings and what is known of their noise.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "study/calibrate/least_squares.hpp"
#include "study/calibrate/prediction.hpp"
#include "study/varied_scene.hpp"

namespace twinchute::study {

/// Noise of a history: its size, and the time over which it forgets itself.
struct Noise {
    double sigma = 0.0;   ///< [SI]
    double memory = 0.0;  ///< [s] correlation exp(-dt/memory); 0: white
    bool given = false;   ///< sigma stands in the test
};

/// A value that is fitted, and what it acts on.
struct Unknown {
    enum class Kind {
        key,    ///< of the scene, the same in all tests
        clock,  ///< [s] on the clock of a test at release
        scale   ///< [-] reading over true value of a history
    };
    Kind kind = Kind::key;
    std::string name;  ///< key, or "clock_offset"
    std::string unit;
    std::size_t test = 0, history = 0;
    FitVariable variable = {};
    std::optional<Prior> prior = {};
};

/// One test as the fit sees it.
struct FittedTest {
    FittedTest(const DropTest& measured, const Fidelity& fidelity, VariedScene varied);

    const DropTest& test;
    Prediction prediction;
    VariedScene scene;
    std::vector<Noise> noise;             ///< of each history
    std::vector<std::vector<bool>> used;  ///< readings of each history
};

class Likelihood {
public:
    /// The tests outlive it. Residuals are those of the tests from first to last.
    Likelihood(std::vector<FittedTest>& tests, std::vector<Unknown> unknowns);
    /// Takes one test alone.
    Likelihood(std::vector<FittedTest>& tests, std::vector<Unknown> unknowns, std::size_t only);

    const std::vector<Unknown>& unknowns() const { return unknowns_; }
    const std::vector<FittedTest>& tests() const { return tests_; }
    std::size_t readings() const;  ///< that are used: histories and scalars
    std::size_t data() const { return readings() + priors(); }
    /// Number of residuals, at least that of the unknowns: those beyond the data are zero.
    std::size_t residuals() const { return std::max(data(), unknowns_.size()); }
    bool all_sigma_given() const;

    /// The least-squares problem; this outlives it.
    FitProblem problem() const;
    /// Prediction for a test at these values; nothing where the model fails.
    std::optional<Predicted> predicted(std::size_t test, std::span<const double> values) const;
    /// Scene of a test at these values. Throws SceneError.
    Scene scene_of(std::size_t test, std::span<const double> values) const {
        return tests_[test].scene.at(keys_of(values));
    }
    /// [s] of a test's clock at release.
    double offset_of(std::size_t test, std::span<const double> values) const;

    /// The best clock offset of each test among many, and their sum of squares, by one run a test. Those that
    /// are not free are taken as they are. Nothing where a run fails.
    std::optional<double> look_for_clocks(std::vector<double>& values) const;
    /// Leaves out readings from before the release. False where nothing is left of a history.
    bool leave_out_before_release(std::span<const double> values);
    /// Size and memory of noise from what is left over. `parameters`: that were fitted.
    void learn_noise(std::span<const double> values, std::size_t parameters);

    int runs() const;

private:
    bool evaluate(std::span<const double> values, std::span<double> residuals) const;
    std::vector<double> keys_of(std::span<const double> values) const;
    std::size_t priors() const;
    double scale_of(std::size_t test, std::size_t history, std::span<const double> values) const;

    std::vector<FittedTest>& tests_;
    std::vector<Unknown> unknowns_;
    std::size_t first_ = 0, last_ = 0;  // of the tests
};

}  // namespace twinchute::study
