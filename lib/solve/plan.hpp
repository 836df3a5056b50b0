// Plan of a run, made before it: parts that are needed or left out and why, memory, steps, time.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "lib/record/run_record.hpp"

namespace twinchute {

/// A piece of a model that a scene may need.
struct PlanPart {
    enum class Kind { dimension, physics, block, event, output };
    Kind kind;
    std::string name;
    std::string what;  ///< what it is; of a force block: when it acts
    bool needed = false;
    std::string why;  ///< what in the scene makes it so
};

std::string_view kind_name(PlanPart::Kind kind);

/// Parts that a record lists as left out: physics, dimensions and blocks. Parts left out for
/// one reason are one row.
std::vector<LeftOut> left_out_of(const std::vector<PlanPart>& parts);

struct PlanArray {
    std::string name;  ///< of the force block it belongs to, or of what it holds
    std::size_t bytes = 0;
};

template <class T>
std::size_t bytes_of(const std::vector<T>& array) {
    return array.capacity() * sizeof(T);
}

/// Adds bytes to the array of that name, if there are any.
void add_bytes(std::vector<PlanArray>& arrays, std::string_view name, std::size_t bytes);

/// A part of the flight with steps of its own.
struct PlanStage {
    std::string name;
    double begin = 0.0, end = 0.0;  ///< [s] since release
    double steps = 0.0;
    double seconds = 0.0;  ///< [s] of wall time

    double step() const { return steps > 0.0 ? (end - begin) / steps : 0.0; }        ///< [s] mean
    double seconds_per_step() const { return steps > 0.0 ? seconds / steps : 0.0; }  ///< [s] mean
};

struct Plan {
    std::vector<PlanPart> parts;
    std::vector<PlanArray> arrays;
    std::vector<PlanStage> stages;
    bool whole = true;  ///< the stages are all of the run; otherwise their ends are not known
    std::string how;    ///< the prediction was made

    double steps() const;
    double seconds() const;  ///< [s] of wall time, as Cost::wall_s
    std::size_t bytes() const;
};

/// Known data that a plan may start from.
struct PlanBasis {
    /// A run of the same scene by a cheaper fidelity, for the times of its events; null where there is none.
    const RunRecord* expected = nullptr;
    int threads = 1;
    double probe = 0.1;  ///< [s] of wall time that steps may be tried for
};

}  // namespace twinchute
