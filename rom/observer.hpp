// Observer of a reduced-order run: history, largest forces, impulse, largest deceleration.
// Everything is taken from the integrator's dense output, so that no step size shows in it; the apogee is a
// row.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "lib/math/maximum.hpp"
#include "lib/solve/sundials.hpp"

namespace twinchute::rom {

struct HistoryRow {
    double time, altitude, vertical_speed, speed;  // of the payload
    double east, north;                            // [m] from the release; downrange in a plane
    double force, drag_area, dynamic_pressure, added_mass, acceleration;
    double specific_force;  // [m/s^2] acceleration less gravity: what an accelerometer on the payload reads
    double separation;      // [m] of payload and parachute, packed starts only
    double canopy_force;    // [N] of the canopy that pulls most; several canopies only
    std::size_t canopy;     // which it is, of OpeningSequence::all()
    int canopies;           // that pull; several canopies only
    // Air in the first canopy whose filling is predicted: [m^3] in it, [m^2] of its mouth, speed of the air
    // that enters over that of the mouth [-].
    double volume, mouth_area, inflow;
};

class Observer {
public:
    /// The row of a state; it may change from stage to stage.
    using RowOf = std::function<HistoryRow(double t, std::span<const double> y)>;

    void watch(RowOf row_of) { row_of_ = std::move(row_of); }
    /// Follows the largest force of a single canopy, too.
    void watch_canopies() { watched_ = peaks_.size(); }

    /// Takes rows at these times [s], too, which rise, as far as the run comes; none before it begins.
    void sample(std::span<const double> times) { sample_times_ = times; }
    const std::vector<HistoryRow>& samples() const { return samples_; }

    /// A point where a stage begins or ends; the force may jump there.
    void mark(double t, std::span<const double> y);
    /// The step that a solver has just taken.
    void step(const OdeSolver& solver);
    /// Whether the last step gave numbers; if not, its rows from the first bad one on are dropped.
    bool is_finite();

    const std::vector<HistoryRow>& rows() const { return rows_; }
    double largest_deceleration() const { return peaks_[of_acceleration].best.value; }

    /// The largest force since the run began, or since take_peak().
    const Maximum& peak() const { return peaks_[of_force].best; }
    Maximum take_peak();
    /// The largest force of a single canopy since the run began, or since it was last taken, and whose it is;
    /// below zero where there was none.
    std::pair<Maximum, std::size_t> take_canopy_peak();

    /// [N s] of the opening force between two times, by Simpson's rule on the equal pieces of each step.
    double impulse_between(double begin, double end) const;
    /// Altitude [m] at a time inside the run: cubic Hermite in the rows around it.
    double altitude_at(double t) const;
    double speed_at(double t) const;  ///< [m/s] likewise, by a straight line

private:
    /// The rows between which a time inside the run lies.
    std::array<const HistoryRow*, 2> around(double t) const;

    static constexpr int pieces = 4;  // even, for Simpson's rule

    /// The largest value of a quantity so far, and the row that is nearest to it.
    struct Peak {
        double HistoryRow::*quantity;
        Maximum best;
        std::size_t row = 0;
    };

    /// Rows of the step's part from a to b [s]; `end`: that of b.
    template <class RowAt>
    void add_rows(double a, double b, const HistoryRow& end, const RowAt& at);
    void consider(const HistoryRow& row);
    /// Its true place in the step from a to b [s], which found it at `before`.
    template <class RowAt>
    void refine(Peak& peak, double before, double a, double b, const RowAt& at);

    RowOf row_of_;
    std::vector<HistoryRow> rows_;
    std::span<const double> sample_times_;  // those that are still to come
    std::vector<HistoryRow> samples_;
    std::vector<double> buffer_;
    enum Followed { of_force, of_acceleration, of_canopy_force };
    std::array<Peak, 3> peaks_{{{&HistoryRow::force, {0.0, -1.0}},
                                {&HistoryRow::acceleration, {0.0, 0.0}},
                                {&HistoryRow::canopy_force, {0.0, -1.0}}}};
    std::size_t watched_ = of_canopy_force;  // that many of the first of them
};

}  // namespace twinchute::rom
