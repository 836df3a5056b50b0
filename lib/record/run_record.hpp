// Record of a run: one type for every fidelity, so that whatever reads it
// (terminal, JSON, report, comparison) never asks which solver wrote it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace twinchute {

struct MetricRow;

/// How a run ended. Every ending has a name; there is no silent one.
enum class StatusCode {
    completed,         ///< the scene's stop condition was met
    stopped_by_event,  ///< a terminal event (the ground) came before the stop condition
    squids,            ///< a canopy whose filling is predicted takes in less than its fabric lets out
    not_opened,        ///< the payload is on the ground and a parachute that was to open never did
    interrupted,       ///< Ctrl-C or a stop request; what was computed is in the record
    refused,           ///< the fidelity lacks physics that the scene asks for
    solver_failed,     ///< the ODE integrator gave up; detail holds its message
    step_too_small,    ///< the critical time step fell below the smallest useful one
    not_finite,        ///< a NaN or infinity appeared; detail names node and time
    strain_limit,      ///< an element was strained beyond the scene's limit
    energy_grew,       ///< the energy ledger does not close: energy came from nowhere
    element_inverted,  ///< a solid element turned inside out
    step_limit,        ///< more steps than the limit
    time_limit,        ///< more simulated time than the limit, stop condition not met
};

/// The name under which a code is written to a record, e.g. "energy_grew".
std::string_view status_name(StatusCode code);

/// True where a parachute that was to open did not: squids or never opened.
constexpr bool failed_to_open(StatusCode code) {
    return code == StatusCode::squids || code == StatusCode::not_opened;
}

/// True for the endings that exit code 3 stands for.
bool is_numerical_failure(StatusCode code);

struct RunStatus {
    StatusCode code = StatusCode::completed;
    std::string detail;  ///< one sentence: what happened, where, when
};

/// Where an effective input value came from.
enum class InputOrigin {
    given,
    design,
    scaled,      ///< a design's value, scaled to a nominal diameter of the scene's own
    calibrated,  ///< another of these, times the factor of a calibration
    fallback     ///< "default"
};

/// "given", "design", "scaled", "calibrated" or "default".
std::string_view origin_name(InputOrigin origin);

/// One effective input of a run, in SI.
struct Input {
    std::string key;  ///< as in the scene, e.g. "payload.mass", "parachute.fill_time.n"
    std::variant<double, std::string> value;
    std::string unit;  ///< SI unit, empty for words and dimensionless numbers
    InputOrigin origin;
    std::string source;  ///< where the value is from, when its file says so
};

/// Whether a metric says something about the model or only repeats what it was told.
/// A comparison of two inputs is no comparison; the report prints this beside every number.
enum class MetricKind { input, result, mixed };

std::string_view metric_kind_name(MetricKind kind);

struct Metric {
    std::string key;  ///< name with unit suffix, e.g. "peak_force_N"
    double value = 0.0;
    MetricKind kind = MetricKind::result;
    std::string note;  ///< which part is input and which is result, for MetricKind::mixed and input
};

/// A metric that a run of its scene is judged by, or that a landing would give, and that it does not have.
struct MissingMetric {
    std::string metric;        ///< key of a record, e.g. "descent_rate_m_s"
    std::string why;           ///< e.g. "the run stopped before the descent was steady"
    bool not_reached = false;  ///< the scene's own stop came before it; otherwise it should be there
};

/// One column of the history; all channels of a record have the same length.
struct Channel {
    std::string name;  ///< e.g. "force"
    std::string unit;  ///< e.g. "N"
    std::vector<double> values;
};

struct Event {
    std::string name;       ///< e.g. "snatch", "full-open", "peak-force", "steady-descent", "ground"
    double time = 0.0;      ///< [s] since release
    double altitude = 0.0;  ///< [m] of the payload above sea level
    double speed = 0.0;     ///< [m/s] of the payload over ground
};

/// Where the energy went, from the start of the run. All [J] but the last.
struct EnergyLedger {
    double kinetic = 0.0;            ///< change of 1/2 (m + M_a) v^2
    double elastic = 0.0;            ///< change of the strain energy of all elements
    double gravity_work = 0.0;       ///< on material mass only
    double drag_work = 0.0;          ///< of the nodal aerodynamic forces, negative when they brake
    double damping = 0.0;            ///< dissipated by viscosity, Rayleigh and breathing damping, >= 0
    double added_mass = 0.0;         ///< + 1/2 integral of (dM_a/dt) v^2 for inertia-only added mass
    double residual_fraction = 0.0;  ///< [-] what does not add up, over |drag work|
    /// Energy that a change of structure brought in: stiffness that grows under strain, energy of elements
    /// that are dropped (negative). Runs that change their structure.
    double ramp = 0.0;
    /// Work of the extraction force and of the static line's anchor, less the energy that the static line
    /// carries off when it lets go. Runs that have either.
    double external_work = 0.0;
    /// No term of the balance, but what the air of a predicted filling says that its pressure took:
    /// dp [A_m w (1 - s) + leak] and the kinetic energy of the air around. In still air drag_work is less by
    /// it, but for the drag of lines and the vent's share of the mouth. Full model.
    double air_loss = 0.0;
};

struct BlockCost {
    std::string name;
    double seconds = 0.0;  ///< [s] wall time inside this force block
};

struct Cost {
    double wall_s = 0.0;
    double cpu_s = 0.0;
    std::int64_t steps = 0;
    std::int64_t rhs_calls = 0;
    std::int64_t rejected_steps = 0;
    double dt_min_s = 0.0;
    double dt_max_s = 0.0;
    std::int64_t element_steps = 0;  ///< element evaluations; 0 when the model has no elements
    double ns_per_element_step = 0.0;
    std::vector<BlockCost> blocks;
    std::vector<double> resumed_at;  ///< [s] since release: checkpoints that the run went on from
};

struct Warning {
    std::string what, why, suggestion;
};

struct LeftOut {
    std::string what, why;
};

/// A metric by formula, beside what the run computed.
struct Estimate {
    std::string name;     ///< e.g. "pflanz"
    std::string title;    ///< e.g. "Pflanz"
    std::string metric;   ///< key of the metric that it estimates, e.g. "peak_force_N"
    double value = 0.0;   ///< in the unit of that metric
    std::string source;   ///< where the formula is from
    std::string outside;  ///< why it does not hold here; empty where it does
};

struct Provenance {
    std::string version, commit, compiler, flags, instruction_set, host_cpu, date;
    int threads = 1;
};

/// The rest of a fall, flown by another fidelity than the one that the record is of.
struct HandOver {
    std::string to;     ///< the fidelity
    double time = 0.0;  ///< [s] since release; after it channels that it does not have are not numbers
    std::vector<std::string> metrics;  ///< keys of those that it has given or changed
};

/// A predicted filling, and how far it hangs on the one input that is calibrated.
struct PredictedFilling {
    /// Results of the drop from another initial mouth.
    struct At {
        double initial_mouth = 0.0;  ///< [-]
        std::string status;          ///< status_name()
        std::optional<double> filling_time, fill_constant,
            peak_force;  ///< [s], [-], [N]; absent: not reached
    };
    std::string model;                                ///< a row of the filling models
    double initial_mouth = 0.0, entrance_loss = 0.0;  ///< [-]
    /// [m/s] in the air of the snatch, above which the canopy squids; absent: at no speed below that of
    /// sound.
    std::optional<double> critical_speed = {};
    std::vector<At> bracket;  ///< lowest and highest mouth
};

/// An input that a calibration has changed.
struct CalibratedInput {
    std::string key;  ///< as in the scene
    double factor = 1.0;
};

/// A calibrated run as it would be without its calibration.
struct Uncalibrated {
    std::vector<CalibratedInput> inputs;
    std::vector<Metric> metrics;  ///< numbers of metric_rows() that it has
};

/// The version, commit, compiler and host of this process, and the time now (UTC, ISO 8601).
Provenance current_provenance();

struct SceneId {
    std::string name, file, sha256;
    std::string digest = {};  ///< of all that a run sees of it (scene_digest); empty: not known
};

struct RunRecord {
    static constexpr int schema = 1;

    SceneId scene;
    std::vector<Input> inputs;
    std::string fidelity;
    RunStatus status;
    std::vector<Metric> metrics;
    std::vector<MissingMetric> missing;  ///< not those whose physics the scene leaves out
    std::optional<EnergyLedger> energy;
    Cost cost;
    std::vector<Estimate> estimates;  ///< by formula; none where nothing opened
    std::vector<Warning> warnings;
    std::vector<LeftOut> left_out;
    Provenance provenance;
    std::vector<Channel> channels;
    std::vector<Event> events;
    std::optional<PredictedFilling> filling;   ///< absent: prescribed
    std::optional<HandOver> handed_over;       ///< absent: one fidelity flew all of it
    std::optional<Uncalibrated> uncalibrated;  ///< absent: nothing is calibrated

    /// The value of a metric, or nothing when its physics was left out.
    std::optional<double> metric(std::string_view key) const;
    const Metric* find_metric(std::string_view key) const;
    const Input* find_input(std::string_view key) const;
    const Channel* find_channel(std::string_view name) const;
    const Event* find_event(std::string_view name) const;
    /// Numbers that it may have: rows of the table, then those of each of several parachutes, by the names of
    /// events.
    std::vector<const MetricRow*> rows_of_metrics() const;

    /// Adds a metric, or replaces the one of that key.
    void add_metric(std::string key, double value, MetricKind kind = MetricKind::result,
                    std::string note = {});
};

}  // namespace twinchute
