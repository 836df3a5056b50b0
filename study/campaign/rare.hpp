// Probabilities too small to count, by subset simulation: Au and Beck, "Estimation of small failure
// probabilities in high dimensions by subset simulation", Probabilistic Engineering Mechanics 16 (2001).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "study/campaign/statistics.hpp"

namespace twinchute::study {

struct AnswerSpec;
struct Engine;

/// Smallest probability that is told: shares of a distribution, which end at 2^-53 below one, resolve no
/// less.
inline constexpr double least_probability = 1e-12;

/// One simulation: the probability that a function of independent standard normal variables passes a
/// threshold.
struct SubsetTask {
    std::size_t dimensions = 0;
    std::size_t block = 0;  ///< points that are asked for at once; a level has ten times as many
    std::uint64_t seed = 0;
    bool above = true;
    double threshold = 0.0;
    /// Function at some points, a row of `points` each. What it throws ends the simulation.
    std::function<void(std::span<const double> points, std::span<double> values)> at;
};

struct SubsetEstimate {
    double probability = 0.0;  ///< at most least_probability: the event is rarer than that
    int levels = 0;
    std::vector<double> points;  ///< of the last level that pass the threshold, a row each
    std::string gave_up;         ///< why there is no estimate; empty: there is one
};

/// Whether the library of the method, OpenTURNS, was there when the program was built.
bool has_subset_simulation();

/// Runs one simulation. Throws std::runtime_error where the part of the program that holds the library cannot
/// be loaded.
SubsetEstimate simulate_subsets(const SubsetTask& task);

/// A probability from some simulations with seeds of their own.
struct RareEvent {
    Interval value = {};              ///< mean of the simulations, Student's t
    Interval direct = {};             ///< by the runs of the campaign alone
    std::uint64_t runs = 0;           ///< of all simulations
    std::uint64_t failed = 0;         ///< of them, that lack the metric; taken for no hit
    int levels = 0;                   ///< of the simulation that took most
    std::vector<double> inputs = {};  ///< [SI] mean of each input where the event happens; empty: nowhere
    std::string gave_up = {};         ///< why there is no estimate
};

/// Probability of an answer, the `number`th of its campaign, by simulations that have as many runs a level as
/// the campaign has in all; nothing where it was interrupted. Throws as simulate_subsets().
std::optional<RareEvent> estimate_rare(const Engine& engine, const AnswerSpec& answer, std::size_t number);

inline constexpr std::uint64_t simulations = 20;
/// Runs of a campaign that leave each simulation three thousand a level. Its seeds of a level are correlated,
/// so its mean is off: 4 % at a thousand runs a level, 1.3 % at three thousand, 1 % at ten thousand.
inline constexpr std::uint64_t least_runs_of_rare = 3000 * simulations;

}  // namespace twinchute::study
