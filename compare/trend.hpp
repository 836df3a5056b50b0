// How far a comparison has moved from an earlier one of the same scene: metric by metric for each fidelity.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "compare/gap.hpp"

namespace twinchute::compare {

/// One metric of one fidelity, then and now.
struct MetricChange {
    std::string fidelity, key;                ///< of a record, with unit
    std::optional<double> before, now;        ///< absent where that record lacks it
    std::optional<double> difference;         ///< now - before
    std::optional<double> relative;           ///< over |before|; absent when that is zero
    std::optional<Tolerance> tolerance = {};  ///< where it is judged
    /// missing: it was there, or somebody asks for it, and is judged. not_reached: it was there, nobody asks
    /// for it by name, and the scene's own stop comes before it now.
    Verdict verdict = Verdict::not_judged;
    std::string note = {};  ///< why it is not there now, where the record says so
};

/// Something else that the two runs differ in: a key of the scene, the program, the machine.
struct OtherChange {
    std::string what, before, now;  ///< empty: not there
};

struct Trend {
    std::vector<MetricChange> changes;  ///< those that moved, most first
    std::size_t compared = 0;           ///< metrics of both fidelities that either record has
    std::size_t judged = 0;             ///< of these, those with a tolerance
    std::vector<OtherChange> inputs;    ///< by key
    std::vector<OtherChange> model;     ///< version, commit, compiler, flags
    std::vector<OtherChange> machine;   ///< processor, instruction set, threads
    std::string note;                   ///< why nothing is judged, or not all; empty otherwise
    bool no_baseline = false;           ///< nothing to hold against: a run of it broke off, or no judged
                                        ///< metric is in both
};

/// Two that a record does not know (not a number) are the same.
bool same_value(const Input& one, const Input& other);

/// Inputs that differ, those of `now` first and in its order. A tolerance that is asked for is none.
std::vector<OtherChange> input_changes(std::vector<Input> before, const std::vector<Input>& now);

/// [-] A relative change up to this is none: the last digits that a rearranged sum may move.
inline constexpr double trend_threshold = 1e-6;

/// Change that a judged metric may make where nobody says otherwise. The same program gives the same bits on
/// the same kind of machine, so that this is room for changes that leave the physics alone: another order of
/// sums, another compiler.
inline constexpr Tolerance trend_tolerance{1e-3, true};

/// `before` and `now` are of the same two fidelities. Judged: metrics that have a tolerance by default or in
/// either, and those of `asked`, by name. Relative tolerances are shares of the earlier value. What is zero
/// but for rounding then and now has not moved (round_off_of()).
Trend measure_trend(const Comparison& before, const Comparison& now,
                    const std::map<std::string, Tolerance>& asked);

/// Exceeded if a judged metric is exceeded or missing, or there is nothing to hold it against; not judged if
/// the new run broke off before any was.
Verdict overall_verdict(const Trend& trend);

/// "no judged metric moved by more than its tolerance (6 judged, 3 of 52 moved at all)", or which did.
std::string verdict_line(const Trend& trend);

}  // namespace twinchute::compare
