// What a reduced-order run writes down: history, peak force, impulse, largest deceleration.
// Everything is taken from the integrator's dense output, so that no step size shows in it.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "lib/math/maximum.hpp"
#include "lib/record/run_record.hpp"
#include "lib/solve/sundials.hpp"
#include "rom/rigid_composite.hpp"

namespace twinchute::rom {

/// The state vector as a Motion.
template <int dimensions>
Motion<dimensions> motion_of(std::span<const double> y) {
    return {Vec<dimensions>(y.data()), Vec<dimensions>(y.data() + dimensions)};
}

struct HistoryRow {
    double time, altitude, vertical_speed, speed;  // of the payload
    double east, north;                            // [m] from the release; downrange in a plane
    double force, drag_area, dynamic_pressure, added_mass, acceleration;
};

template <class Model, int dimensions>
class Observer {
public:
    Observer(const Model& model, const ErkSolver& solver) : model_(model), solver_(solver) {}

    /// A point where a stage begins or ends; the force may jump there.
    void mark(double t) {
        rows_.push_back(row(t, motion_of<dimensions>(solver_.state())));
        consider(rows_.back());
    }

    /// The step that the solver has just taken.
    void step() {
        const double a = solver_.previous_time(), b = solver_.time();
        if (!(b > a)) return;
        const auto at = [&](double t) {
            solver_.interpolate(t, buffer_);
            return row(t, motion_of<dimensions>(buffer_));
        };
        const double before = peak_.value;
        for (int i = 1; i < pieces; ++i)
            rows_.push_back(at(a + (b - a) * i / pieces));
        rows_.push_back(row(b, motion_of<dimensions>(solver_.state())));
        for (std::size_t i = rows_.size() - pieces; i < rows_.size(); ++i)
            consider(rows_[i]);
        // Only a step that raised the maximum, or its neighbour, can hold the true one.
        if (peak_.value > before || rows_.size() - peak_row_ <= 2 * pieces)
            refine(a, b, [&](double t) { return at(t).force; });
    }

    /// Whether the last step gave numbers; if not, its rows from the first bad one on are dropped.
    bool is_finite() {
        const std::size_t first = rows_.size() > pieces ? rows_.size() - pieces : 0;
        for (std::size_t i = first; i < rows_.size(); ++i) {
            const HistoryRow& r = rows_[i];
            if (std::isfinite(r.force + r.acceleration + r.speed + r.altitude + r.dynamic_pressure)) continue;
            rows_.resize(std::max<std::size_t>(i, 1));
            return false;
        }
        return true;
    }

    const std::vector<HistoryRow>& rows() const { return rows_; }
    const Maximum& peak() const { return peak_; }
    double largest_deceleration() const { return deceleration_; }

    /// The row at or after a time inside the run.
    const HistoryRow& row_near(double t) const {
        const auto row = std::ranges::lower_bound(rows_, t, {}, &HistoryRow::time);
        return row == rows_.end() ? rows_.back() : *row;
    }

    /// [N s] of the opening force from the first row to time `end`, by Simpson's rule on the
    /// equal pieces of each step.
    double impulse_until(double end) const {
        double sum = 0.0;
        std::size_t i = 0;
        while (i + 2 < rows_.size() && rows_[i + 2].time <= end * (1.0 + 1e-12)) {
            const double h = rows_[i + 1].time - rows_[i].time;
            if (!(h > 0.0)) {  // two rows at one time: a stage boundary
                ++i;
                continue;
            }
            sum += h / 3.0 * (rows_[i].force + 4.0 * rows_[i + 1].force + rows_[i + 2].force);
            i += 2;
        }
        return sum;
    }

    /// Altitude [m] at a time inside the run: cubic Hermite in the rows around it.
    double altitude_at(double t) const {
        std::size_t right = 1;
        while (right + 1 < rows_.size() && rows_[right].time < t)
            ++right;
        const HistoryRow &a = rows_[right - 1], &b = rows_[right];
        const double h = b.time - a.time;
        if (!(h > 0.0)) return b.altitude;
        const double x = (t - a.time) / h, y = 1.0 - x;
        return y * y * (1.0 + 2.0 * x) * a.altitude + x * x * (1.0 + 2.0 * y) * b.altitude +
               h * x * y * (y * a.vertical_speed - x * b.vertical_speed);
    }

private:
    static constexpr int pieces = 4;  // even, for Simpson's rule

    HistoryRow row(double t, const Motion<dimensions>& m) const {
        const double rho = model_.atmosphere.at(m.altitude()).density;
        HistoryRow r{};
        r.time = t;
        r.altitude = m.altitude();
        r.vertical_speed = m.velocity[dimensions - 1];
        r.speed = m.velocity.norm();
        if constexpr (dimensions >= 2) r.east = m.position[0];
        if constexpr (dimensions == 3) r.north = m.position[1];
        r.force = model_.opening_force(t, m);
        r.drag_area = model_.drag_area(t);
        r.dynamic_pressure = 0.5 * rho * model_.airspeed(m).squaredNorm();
        r.acceleration = model_.acceleration(t, m).norm();
        if (model_.added_mass)
            r.added_mass =
                model_.inflation.added_mass(*model_.added_mass, model_.phase, t, rho, model_.steady_radius)
                    .value;
        return r;
    }

    void consider(const HistoryRow& r) {
        deceleration_ = std::max(deceleration_, r.acceleration);
        if (r.force > peak_.value) {
            peak_ = {r.time, r.force};
            peak_row_ = static_cast<std::size_t>(&r - rows_.data());
        }
    }

    template <class Force>
    void refine(double a, double b, Force&& force) {
        const Maximum best = maximum_on(force, a, b, pieces);
        if (best.value > peak_.value) peak_ = best;
    }

    const Model& model_;
    const ErkSolver& solver_;
    std::vector<HistoryRow> rows_;
    std::vector<double> buffer_ = std::vector<double>(2 * dimensions);
    Maximum peak_{0.0, -1.0};
    std::size_t peak_row_ = 0;
    double deceleration_ = 0.0;
};

}  // namespace twinchute::rom
