// Stiff and extreme cases, one verdict each. A run may be right, be refused or stop with a true cause; an
// answer that is wrong and looks right is the only thing that must not happen.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "lib/record/run_record.hpp"
#include "lib/scene/scene.hpp"
#include "lib/solve/fidelity.hpp"

namespace twinchute::compare {

/// A run that has to be judged. The scene is that of the run, its method chosen.
struct Trial {
    const Scene& scene;
    const RunRecord& record;
    const Fidelity& fidelity;         ///< for runs that it is compared with
    std::stop_token stop = {};        ///< of those
    bool force_unstructured = false;  ///< those, like this run, are laid out as Run says

    /// Such a run.
    RunRecord run(const Scene& other) const {
        Run control;
        control.stop = stop;
        control.force_unstructured = force_unstructured;
        return fidelity.run(other, control);
    }
};

/// One look at an answer: how far it is from what it should be, and how far it may be.
struct Finding {
    std::string what;    ///< e.g. "peak force, closed form"
    double error = 0.0;  ///< in the unit of the limit, never negative
    double limit = 0.0;

    /// Written so that a NaN does not hold.
    bool holds() const { return error <= limit; }
    double margin() const { return limit / error; }
};

using Check = std::function<std::vector<Finding>(const Trial&)>;

/// A way to compute a scene: settings of one fidelity, and of its memory what no scene asks for.
struct StabilityMethod {
    std::string name;
    std::function<void(Scene&)> choose;
    bool force_unstructured = false;  ///< as Run::force_unstructured
    Check check = {};                 ///< beside that of the case
};

struct StabilityCase {
    std::string name;
    std::string why;            ///< what is hard about it
    std::string_view fidelity;  ///< "rom" or "full"
    Scene (*base)() = nullptr;
    std::function<void(Scene&)> change;
    std::span<const StabilityMethod> methods;
    /// An answer without a check is taken for wrong: such a row is for scenes that have to be refused.
    Check check = {};
    /// Endings without an answer that are true of this scene. None: it has to be answered.
    std::vector<StatusCode> causes = {};
    /// "key=value" that the reader of scenes refuses before there is a Scene; empty: `change` says all.
    std::string asked = {};
    /// Steps from the first sign of what is wrong to a stop; empty: not measured.
    std::function<std::optional<std::int64_t>(const Trial&)> latency = {};
    bool quick = true;  ///< a cell takes less than about 0.2 s
};

enum class CellVerdict {
    stable,          ///< answered, and every check holds
    refused,         ///< before it ran, or before it could go wrong, with a reason
    stopped,         ///< by a guard, with a status that is true of the scene
    silently_wrong,  ///< answered, and a check fails
    misnamed         ///< refused or stopped for a cause that is not true of the scene
};

/// "stable", "refused", "stopped", "silently wrong", "misnamed".
std::string_view cell_verdict_name(CellVerdict verdict);
bool is_failure(CellVerdict verdict);

struct StabilityCell {
    const StabilityCase* row = nullptr;
    std::string method;
    CellVerdict verdict = CellVerdict::stable;
    std::string status;                  ///< of the run, e.g. "completed"; "refused" where it did not run
    std::string reason;                  ///< of a refusal or a stop; else the check with the least margin
    std::vector<Finding> findings;       ///< of an answer
    std::optional<double> margin;        ///< limit over error of the worst finding
    std::optional<double> error, limit;  ///< of that
    std::int64_t steps = 0;
    std::optional<std::int64_t> latency;  ///< of a stop: steps since the first sign, at most
    double seconds = 0.0;                 ///< [s] wall time of the run alone
    double end = 0.0;                     ///< [s] simulated time that its record reaches
};

struct StabilityMatrix {
    std::vector<StabilityCell> cells;
    bool interrupted = false;  ///< the rest was not run
};

/// Why a scene is refused before it runs, in the words of the reader or of the fidelity.
std::optional<std::string> refusal(const StabilityCase& row, const Scene& scene, const Fidelity& fidelity);

/// Runs one cell and judges it. Nothing when `stop` asked for an end.
std::optional<StabilityCell> judge(const StabilityCase& row, const StabilityMethod& method,
                                   const Fidelity& fidelity, std::stop_token stop = {});

/// Cases of both fidelities, reduced-order model first.
const std::vector<StabilityCase>& stability_cases();

}  // namespace twinchute::compare
