// Calibration: inputs of a scene from tests, how sure they are, and what that means for the next drop.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "study/calibrate/likelihood.hpp"

namespace twinchute::study {

/// An input to fit, as --vary says it.
struct Vary {
    std::string key;
    std::optional<double> low, high;  ///< [SI] absent: by default
};

/// Takes "KEY" and "KEY=LO..HI" apart, values as in a scene. Throws UsageError.
Vary read_vary(const std::string& text);

struct Parameter {
    Unknown unknown;
    double estimate = 0.0, start = 0.0;
    double sigma = 0.0;             ///< standard deviation, in the scale of the variable
    ProfileInterval interval;       ///< 95 %
    bool held = false;              ///< the tests do not see it: it is at its start
    bool identified = false;        ///< both ends of the interval lie inside the bounds
    std::string why;                ///< it is not; else empty
    std::optional<double> scatter;  ///< standard deviation from test to test, in the scale
    std::string label() const;  ///< its name, of a clock with the number of its test where there are several
    std::size_t tests = 1;
};

/// Two parameters that the tests tell apart badly.
struct Pairing {
    std::size_t one = 0, other = 0;  ///< of the parameters
    double correlation = 0.0;
};

/// A history as it was fitted.
struct HistoryFit {
    const DropTest* test = nullptr;
    MeasuredHistory measured;
    std::vector<double> model;  ///< at each reading, through the instrument
    std::vector<bool> used;
    Noise noise;
    double rms = 0.0;        ///< [SI] of what is left over
    double first_lag = 0.0;  ///< correlation of neighbours of what is left over
    double structure = 1.0;  ///< probability of such residuals of noise alone (Ljung and Box)
};

struct ScalarFit {
    const DropTest* test = nullptr;
    const MeasuredScalar* measured = nullptr;
    double model = 0.0;
};

/// Prediction of a metric for the next drop, the one that the scene describes.
struct Band {
    const MetricRow* row = nullptr;
    std::optional<double> before;              ///< of the scene as it was
    double best = 0.0, low = 0.0, high = 0.0;  ///< 95 %
    std::vector<double> draws;
};

/// Why the tests and the model do not go together.
struct Finding {
    std::string what, why, suggestion;
    std::vector<std::string> explains;  ///< what else was found, and follows from it
};

struct Calibration {
    std::vector<Parameter> parameters;
    Eigen::MatrixXd covariance;  ///< in the scales of the variables; zero of those held
    std::vector<Pairing> pairs;  ///< closely correlated
    /// Estimates from each test by itself, in the order of the tests, then of the parameters; nothing of a
    /// clock, of what is held, and where a test by itself does not see enough.
    std::vector<std::vector<std::optional<double>>> alone;
    std::vector<HistoryFit> histories;
    std::vector<ScalarFit> scalars;
    std::vector<Band> predictive;
    std::vector<Finding> findings;
    std::vector<std::string> notes;
    double sum = 0.0;          ///< of squared residuals over their variance
    std::size_t readings = 0;  ///< that were used
    std::size_t fitted = 0;    ///< parameters that are free
    int runs = 0;              ///< of the model
    double seconds = 0.0;      ///< [s]
    bool sigma_given = false;  ///< of every history
    bool interrupted = false;

    bool is_consistent() const { return findings.empty(); }
    double correlation(std::size_t i, std::size_t j) const;
    const Parameter* find(std::string_view name) const;
};

struct CalibrationSettings {
    std::vector<Vary> vary;  ///< empty: by default
    bool predict = true;     ///< bands of metrics
    std::stop_token stop = {};
};

/// `scene_with`: the scene that is calibrated; a fidelity that gives samples. The tests outlive the result.
/// Throws UsageError and SceneError for what cannot be fitted.
Calibration calibrate(const SceneWith& scene_with, const std::vector<DropTest>& tests,
                      const Fidelity& fidelity, const CalibrationSettings& settings);

/// Looks for what residuals say beside noise: a wrong scale, a wrong clock, another canopy.
void judge_consistency(Calibration& calibration, std::vector<FittedTest>& tests,
                       const std::vector<double>& values, const std::vector<bool>& free,
                       const Likelihood& likelihood);

/// Inputs that are keys, in the order of the parameters, and draws of them from what is known.
struct InputDraws {
    std::vector<std::string> keys;
    std::vector<double> best;
    std::vector<std::vector<double>> values;  ///< of each draw, in the order of the keys
};

/// Halton's sequence over the normal distribution of their covariance and their scatter from test to test,
/// within their bounds.
InputDraws draw_inputs(const Calibration& calibration, int draws);

/// Draws from the calibrated inputs, run through the scene: bands of peak force and descent rate.
void predict_next_drop(Calibration& calibration, const SceneWith& scene_with, const Fidelity& fidelity,
                       const std::stop_token& stop);

inline constexpr const char* clock_offset = "clock_offset";

}  // namespace twinchute::study
