// How much the answers of the reduced-order model hang on each input: elasticities, per cent per per cent.
#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "lib/scene/scene.hpp"

namespace twinchute::rom {

/// d ln y/d ln x [-] at the scene, and how far it can be relied on.
struct Elasticity {
    double value = 0.0;
    /// [-] difference between the central quotients at two steps; much of it where a stage or a maximum comes
    /// or goes nearby, so that there is no derivative.
    double doubt = 0.0;
};

/// Sensitivities to one input, for each of Sensitivity::metrics; absent where it moves the input out of its
/// range, or the run with it has no such metric.
struct InputSensitivity {
    std::string key;
    double value = 0.0;  ///< [unit]
    std::string unit;
    std::vector<std::optional<Elasticity>> of;
    /// The largest of them, by size: rows are sorted by it.
    double largest() const;
};

struct Sensitivity {
    std::vector<std::string> metrics;  ///< keys, in the record's order
    std::vector<double> values;        ///< of the scene itself
    std::vector<InputSensitivity> inputs;
};

/// Reads the scene with more overrides, each key=value.
using SceneWith = std::function<Scene(const std::vector<std::string>& more)>;

/// Sensitivities to every number of the scene that is not zero and not a count, by central differences of
/// whole runs at a tight tolerance, 0.1 and 0.2 % to either side, extrapolated: stage times depend on most
/// inputs, so that the right-hand side alone has not got the derivative. Throws SceneError where the scene
/// itself cannot be read. A stop request ends it with what there is.
Sensitivity sensitivity_of(const SceneWith& scene_with, std::stop_token stop);

}  // namespace twinchute::rom
