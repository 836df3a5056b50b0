// Inputs that prescribe an opening and results that it is judged by, for every fidelity.
#pragma once

#include <cmath>
#include <functional>
#include <optional>
#include <string_view>

#include "lib/math/vec.hpp"
#include "lib/models/inflation.hpp"
#include "lib/record/run_record.hpp"
#include "lib/scene/scene.hpp"
#include "lib/solve/steady_descent.hpp"

namespace twinchute {

/// Horizontal unit vector of the release; x east, y north, z up.
Vec3 heading_direction(const Release& release);

/// t_i/t_f that tests show at most (paper, 3.2.2).
inline constexpr double longest_initial_share = 0.15;

/// The prescribed opening of a canopy that snatches at `snatch` [s] with airspeed `speed` [m/s]
/// in air of `density` [kg/m^3]; of a reefed one its first stage, with `stage` one whose lines before have
/// been cut before it began to fill. Drag area: of one canopy, in its cluster.
Inflation make_inflation(const Scene& scene, const Parachute& chute, double snatch, double speed,
                         double density, std::size_t stage = 0);

/// The stage of a reefed opening that begins where the one before has come to when its line is cut at `time`
/// [s], at airspeed `speed` [m/s] in air of `density` [kg/m^3]. Stages: those of Parachute::reefing, then the
/// open canopy.
///
/// Filling times: a correlation gives that of the whole opening. A stage takes its part sqrt(g_end - g_start)
/// with g = ((C_D S) - (C_D S)_i)/((C_D S)_0 - (C_D S)_i), the share of the filling that is done: for a first
/// stage sqrt((C_D S)_r/(C_D S)_0), so that a reefed canopy fills over as many of its own diameters as an
/// open one over its; nothing for a stage that adds nothing, all of it for one that begins at (C_D S)_i. The
/// initial phase is part of a correlation's time, and only the first stage has one: the others take their
/// part of the rest. A definition of this toolkit; a fill_time of the stage is taken in the same way, a given
/// time as it stands.
Inflation next_stage(const Scene& scene, const Parachute& chute, std::size_t stage, const Inflation& before,
                     Phase phase, double time, double speed, double density);
/// Why an opening whose filling time is told cannot take place, if so: its initial phase is not shorter than
/// its filling, or at `speed` [m/s] through the air, near rest, it would fill for longer than any flight.
std::optional<RunStatus> refused_opening(const Inflation& inflation, double speed);

/// The canopy of a parachute whose filling is predicted, as the balance of its air needs it.
FillingCanopy filling_canopy(const Parachute& chute);

/// The opening of a canopy that starts inflated: over at time 0.
Inflation inflated(const Parachute& chute);

/// R_0 [m], radius of the steady canopy for the added mass.
inline double steady_radius(const Parachute& chute) {
    return 0.5 * chute.projected_diameter_ratio * chute.nominal_diameter;
}

/// [s] of simulated time after which a run that has not met its stop condition ends.
inline constexpr double longest_flight = 36000.0;

/// [s] of simulated time after which a parachute that has not come to snatch never will.
inline constexpr double longest_deployment = 60.0;

/// The opening of one parachute, or of one cluster. Times in [s] since release.
struct ParachuteResult {
    /// From its beginning to that of the next one, or to the snatch of another parachute.
    struct Stage {
        double begin = 0.0;
        std::optional<double> full = {};        ///< when its drag area was full
        std::optional<double> peak_force = {};  ///< [N]; none of a stage without length, or that still fills
        double peak_time = 0.0;
    };
    std::size_t index = 0;  ///< in the scene
    double snatch_time = 0.0;
    double snatch_speed = 0.0;           ///< [m/s] airspeed
    std::optional<double> snatch_force;  ///< [N] of one that was packed
    std::vector<Stage> stages;           ///< several of a reefed one
};

/// The largest force of a single canopy.
struct CanopyPeak {
    double force = 0.0;  ///< [N] at the confluence
    std::string note;    ///< whose it is, and when
};

/// Results of a run between release and its end. Times in [s] since release.
///
/// With a deployment the snatch force is the largest force until t_s + t_i, the peak force that from then
/// on: the two overlap. Without one the peak counts from t_s.
struct OpeningResult {
    /// False when a packed parachute never came to it, and for one that starts inflated: no metrics of
    /// snatch then.
    bool snatched = true;
    std::optional<double> line_stretch_time;  ///< packed starts
    double snatch_time = 0.0;
    double snatch_speed = 0.0;           ///< [m/s] airspeed of the system's centre of mass
    double snatch_path_angle = 0.0;      ///< [rad] of that airspeed below the horizon
    double payload_snatch_speed = 0.0;   ///< [m/s] airspeed
    double snatch_density = 0.0;         ///< [kg/m^3]
    std::optional<double> snatch_force;  ///< [N] packed starts
    std::optional<double> filling_time;  ///< [s] from snatch
    std::optional<double> peak_force;    ///< [N] none while a canopy still fills: it may be yet to come
    double peak_time = 0.0;
    double max_force = 0.0;                                         ///< [N]
    std::optional<CanopyPeak> peak_canopy_force, max_canopy_force;  ///< where several pulled at once
    std::optional<double> impulse;             ///< [N s] of the opening force, snatch to full open
    double max_deceleration = 0.0;             ///< [m/s^2] largest |dv/dt| of the payload
    std::optional<DescentWindow> descent;      ///< at the end of the run, or where last found steady
    std::optional<DescentWindow> last_window;  ///< that was judged
    std::optional<double> descent_altitude;    ///< [m] where the descent became steady
    std::optional<double> landing_time;
    double end_speed = 0.0, end_climb = 0.0;  ///< [m/s] of the payload over ground at the end, upward
    Vec3 end_position = Vec3::Zero();         ///< [m] of the payload at the end of the run
    std::vector<ParachuteResult> parachutes;  ///< in the order of their snatches
};

/// Angle [rad] of a velocity below the horizon; 0 of none.
inline double angle_below_horizon(const Vec3& velocity) {
    return std::atan2(-velocity.z(), std::hypot(velocity.x(), velocity.y()));
}

/// Takes the largest peak of all stages for that of the result. A parachute that grows (by its index in the
/// scene) has none in its last stage, and then there is none of the result. Returns whether all are known.
bool note_largest_peak(OpeningResult& result, const std::function<bool(std::size_t)>& is_growing);

/// Warns where the peak force comes as filling begins: of the drag area that the scene says it begins with.
void warn_of_first_force(RunRecord& record, const Scene& scene, const OpeningResult& r);

/// Takes a metric, see RunRecord::add_metric.
using MetricSink =
    std::function<void(std::string_view key, double value, MetricKind kind, std::string_view note)>;
/// Adds the metrics that every fidelity reports, derived ratios included. `filling` and
/// `descent` say how much of those two is input.
void add_opening_metrics(const MetricSink& sink, const Scene& scene, const OpeningResult& result,
                         const Metric& filling, const Metric& descent);
void add_opening_metrics(RunRecord& record, const Scene& scene, const OpeningResult& result,
                         const Metric& filling, const Metric& descent);
/// Adds the times from snatch at which the drag area of the only parachute first is 15, 70 and 98 % of the
/// steady one: a slow stage and a burst are two numbers. From the record's own history, between two of its
/// rows by a straight line. `kind`: that of the filling time.
void add_drag_area_times(RunRecord& record, const Scene& scene, const OpeningResult& result, MetricKind kind);
/// Adds the descent rate of each stage that another one follows: of reefed stages, and of parachutes before
/// the last. It is the mean vertical speed of the payload over ground in the last v/g of the stage, v being
/// the vertical speed at its end, and no earlier than its drag area is full; two relaxation times of a fall
/// near its steady speed without added mass. A stage ends with the first event of opening after it is full,
/// of any parachute. What gives no such rate is among the missing. The last stage's is descent_rate_m_s.
void add_stage_descent_rates(RunRecord& record, const Scene& scene, const OpeningResult& result);
/// Adds the drag area that the only parachute, whose filling is predicted, has behind each reefing line.
void add_reefed_drag_areas(RunRecord& record, const Scene& scene, const OpeningResult& result);
/// No parachute is left.
bool all_are_cut(const RunRecord& record, const Scene& scene);

/// Warns of a run that ended before its descent was steady, unless its stop condition is one of the opening.
/// `last`: the last window that was judged, if any.
void warn_of_unsteady_descent(RunRecord& record, const Scene& scene,
                              const std::optional<DescentWindow>& last);

/// Warnings about an opening that hold for every fidelity (M_r > 1, ...). altitude, speed, density: at snatch
/// [m], [m/s], [kg/m^3].
void add_opening_warnings(RunRecord& record, const Scene& scene, const Parachute& chute,
                          const Inflation& inflation, double altitude, double speed, double density);
/// Warnings about the scene alone.
void add_scene_warnings(RunRecord& record, const Scene& scene);

/// The drag area is full from t_s + t_f on; a stop at the peak ends a run once the force has fallen to this
/// share of its maximum after that, or the descent is steady.
inline constexpr double past_peak = 0.95;

}  // namespace twinchute
