// Observations of a full run: history rows, filtered and raw force maxima, canopy shape.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "fullsim/forces/membrane.hpp"
#include "fullsim/run/moving_average.hpp"
#include "fullsim/state.hpp"
#include "lib/record/run_record.hpp"

namespace twinchute::fullsim {

/// Cords whose tension is a metric, suspension lines apart: tapes and bands, vent lines, the reefing line.
struct CordGroup {
    CableKind kind;
    bool reefs;
    const char* metric;
    const char* name;
};
inline constexpr std::array cord_groups{
    CordGroup{CableKind::radial, false, "max_radial_tape_tension_N", "radial tapes"},
    CordGroup{CableKind::skirt, false, "max_skirt_band_tension_N", "the skirt band"},
    CordGroup{CableKind::vent, false, "max_vent_band_tension_N", "the vent band"},
    CordGroup{CableKind::vent_line, false, "max_vent_line_tension_N", "vent lines"},
    CordGroup{CableKind::skirt, true, "max_reefing_line_tension_N", "the reefing line"}};
using CordTensions = std::array<double, cord_groups.size()>;  // [N] as cord_groups

struct HistoryRow {
    double time;
    Vec3 position, velocity;  // of the payload [m], [m/s]
    double force, force_raw;  // opening force [N]: 5 ms centred average, and as it is
    double acceleration;      // of the payload, filtered [m/s^2]
    double drag_area, dynamic_pressure, pressure, airspeed;
    double projected_area, signed_area, added_mass;
    double seam_diameter, depth;              // [m]
    double turns;                             // as CanopyShape
    double density;                           // [kg/m^3]
    double volume, mouth_area, inflow_ratio;  // as InflowState; zero where filling is prescribed
    double stress_p90;                        // [N/m] as stress_p90(), the largest of the rows so far
    double utilisation_p90;                   // [-] likewise, over the strength of each fabric
    CordTensions tension;                     // as cord_tensions(), the largest of the rows so far
    double tilt;                              // [rad] of a payload that turns, from the vertical
    double impulse;                           // [N s] of the force, step by step, so far
};

/// Leaves rows out of the channels of a history until there are `output_rate` [1/s] of them. The first and
/// the last stay.
void thin_out(std::vector<Channel>& channels, double output_rate);

/// The row of canopies on one payload at one time: forces and areas add up, speeds and pressures are means,
/// turns are those furthest from 1, the stress is the largest. force_raw: the sum of the sizes, of forces
/// that need not be parallel.
HistoryRow row_of_all(std::span<const HistoryRow> rows);

/// Shape of a canopy; one sector is measured where `sectors` are congruent (Layout::sectors).
struct CanopyShape {
    double seam_diameter;  ///< [m] mean of the widest seam ring
    double depth;  ///< [m] from vent to skirt along the canopy's axis; of one whose vent is held down, from
                   ///< its highest seams
    double turns;  ///< of the skirt on its way around that axis: 1 where it does not cross itself, but for
                   ///< loops that go back by less than 45 deg in all
};
CanopyShape canopy_shape(const State& state, const Mesh& mesh, int sectors = 1);

/// [N/m] 90th percentile of the first principal stress resultant (second Piola-Kirchhoff, elastic, with the
/// weight of the finite elements) by unstrained area, or `found` where it is no larger. Unlike the largest
/// stress, which belongs to one triangle at a seam, it settles as meshes get finer. One sector is looked at
/// as in canopy_shape. laws: of the sheets. strengths [N/m]: of the sheets, where the stress over its
/// fabric's strength [-] is wanted in place of the stress.
double stress_p90(const State& state, const Mesh& mesh, std::span<const MembraneLaw> laws, double found,
                  int sectors = 1, std::span<const double> strengths = {});

/// Tensions of one cord of each group, elastic, or those `found` before where they are larger.
CordTensions cord_tensions(const State& state, const Mesh& mesh, const CordTensions& found);

class Observer {
public:
    /// gravity [m/s^2]; output_rate: rows per second; sectors as canopy_shape; payload_parts: as many as the
    /// payload of the mesh is one of (cluster.hpp).
    Observer(const Mesh& mesh, double gravity, double output_rate, int sectors = 1, int payload_parts = 1);

    /// Largest forces from here on [s] are the opening's, those before the snatch's. At or after the time of
    /// the last observation; 0 at first. The projected area grows anew.
    void count_peak_from(double time) {
        extremes_.peak_from = time;
        growth_.clear();
    }
    /// Another stage of the opening begins at `time` [s], that of the last observation: peak() is then its
    /// own.
    void begin_stage(double time) {
        extremes_.earlier.push_back(opening_.end());
        extremes_.peak = {};
        count_peak_from(time);
    }

    /// A parachute leaves its pack at `time` [s], that of the last observation: forces from here on are those
    /// of its snatch, until count_peak_from says otherwise.
    void begin_deployment(double time) {
        begin_stage(time);
        extremes_.snatch_peak = {};
        extremes_.peak_from = std::numeric_limits<double>::infinity();
    }
    /// The payload weighs this [kg] from here on, with what its node carries of the risers.
    void weigh_payload(double mass) { payload_mass_ = mass; }

    /// Called once a step with the forces at state.time evaluated. payload_force: [N] all on its node.
    void observe(const SystemState& state, const Vec3& payload_force);
    /// Then, where a row is due: add_row with all nodes.
    bool row_is_due(double time) const { return time >= next_row_; }
    void add_row(const State& state);
    /// A row of now that others have made, its filtered columns open.
    void add_row(const HistoryRow& row);
    /// A check found everything sound so far.
    void accept() { accepted_ = {rows_.size(), unsettled_, extremes_, area_.time}; }
    /// A check found something wrong: drops what came after the last accept().
    void forget();
    /// A row of the end, whether or not one is due.
    void observe_end(const State& state) {
        if (state.time > rows_.back().time) add_row(state);
    }
    /// Settles rows that still wait for their filter; no more observations after this.
    void finish();

    using Peak = IntervalPeak::Peak;
    const std::vector<HistoryRow>& rows() const { return rows_; }
    /// Rows that the last accept() found sound and whose filter is through: nothing changes them any more.
    std::span<const HistoryRow> final_rows() const { return std::span(rows_).first(accepted_.unsettled); }
    /// Peak of the filtered force [N] in this stage, by windows that stay within it (IntervalPeak): never
    /// above the raw one. Windows that the end of the run cuts off count once it is finished. The history's
    /// column is filtered across all ends.
    const Peak& peak() const { return extremes_.peak; }
    const std::vector<Peak>& earlier_peaks() const { return extremes_.earlier; }  ///< of the stages before
    Peak largest_peak() const {                                                   ///< of all stages
        Peak largest = peak();
        for (const Peak& earlier : earlier_peaks())
            if (earlier.value > largest.value) largest = earlier;
        return largest;
    }
    /// Peak of the raw force [N]: that at the end of a step, or its mean over the subcycles of one, see
    /// MeanForce.
    const Peak& raw_peak() const { return extremes_.raw_peak; }
    const Peak& snatch_peak() const { return extremes_.snatch_peak; }  ///< raw, before the peak counts [N]
    double filtered_force() const { return force_.value(); }           ///< [N] half a window ago
    /// [N] of the whole run: the larger of the two peaks above; of a run that had neither the largest row.
    double largest_force() const;
    double largest_acceleration() const { return extremes_.acceleration; }  ///< [m/s^2] as largest_force

    /// CanopyShape::turns of the row from `time` on that is furthest from 1; 1 without a row.
    double turns_since(double time) const;
    /// It is not 1 in any row of the last `seconds`.
    bool crosses_itself(double seconds) const;
    /// Mean of a column over the last `seconds` of the rows, trapezoidal.
    double mean(double HistoryRow::*column, double seconds) const;
    /// [N s] of the force over [from, to].
    double impulse(double from, double to) const { return impulse_until(to) - impulse_until(from); }
    /// First time at which the projected area reaches `area` since the last stage began (a mouth that is held
    /// together does not keep all of the canopy from that) or the peak began to count: linear within a step.
    std::optional<double> first_time_of_area(double area) const;
    /// [m^2] the largest projected area of a step since then.
    double largest_area() const { return growth_.empty() ? 0.0 : growth_.back().now.value; }

    std::vector<Channel> channels() const;

    /// Between two observations.
    void serialize(Archive& archive);

private:
    void settle_rows();
    void note_growth(Peak area);
    double impulse_until(double time) const;

    const Mesh& mesh_;
    std::vector<MembraneLaw> laws_;
    std::vector<double> strengths_;  // [N/m] of the sheets; none where they are one, or one has none
    int sectors_;
    double gravity_, interval_, payload_mass_;
    double next_row_ = 0.0;
    std::vector<HistoryRow> rows_;
    std::size_t unsettled_ = 0;  // first row whose filtered columns are still open
    MovingAverage force_, acceleration_;
    Peak area_;  // projected, of the last step
    /// The projected area is larger than ever in this stage, after the step before.
    struct Growth {
        Peak before, now;
    };
    std::vector<Growth> growth_;  // by a thousandth each; the last one by less
    IntervalPeak opening_;        // of the force, since the peak counts
    bool sound_ = true;           // nothing has been dropped
    struct Extremes {
        Peak peak, raw_peak, snatch_peak;
        std::vector<Peak> earlier;
        double peak_from = 0.0;
        double acceleration = 0.0;
    };
    static void serialize_extremes(Archive& archive, Extremes& most);
    Extremes extremes_;
    struct Accepted {
        std::size_t rows = 0, unsettled = 0;
        Extremes extremes;
        double time = 0.0;
    };
    Accepted accepted_;
};

}  // namespace twinchute::fullsim
