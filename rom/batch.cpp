#include "rom/batch.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "lib/math/lanes.hpp"
#include "lib/math/maximum.hpp"
#include "lib/models/inflation.hpp"
#include "lib/scene/calibration.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/solve/dense_output.hpp"
#include "lib/solve/opening.hpp"
#include "lib/solve/sundials_lanes.hpp"
#include "rom/run_context.hpp"
#include "rom/run_rom.hpp"

namespace twinchute::rom {
namespace {

constexpr auto lanes = static_cast<int>(batch_lanes);
using Row = std::array<double, batch_lanes>;

double length_of(double x, double z) {
    return std::sqrt(x * x + z * z);
}

/// Stages of a lane: initial phase, filling, and a while with the full drag area.
constexpr std::array stages{Phase::initial, Phase::filling, Phase::open};

/// What the right-hand side needs of each lane.
struct LaneData {
    Row weighed, hung;              ///< [kg] material of all, and of the payload
    Row gravity;                    ///< [m/s^2]
    Row steady_area, payload_area;  ///< [m^2]
    /// [m^3] Air mass over density is (still + ramping phi') r^1.5, r the drag area over the steady one.
    Row still, ramping;
    Row duration;               ///< [s] of the stage
    Row ramp_begin, ramp_rise;  ///< [-] phi' over the stage
    Row density, slope, bend;   ///< [kg/m^3, /m, /m^2] of the air about `level` [m], a parabola
    Row level;
};

/// State and rates of all lanes at one moment, and what is followed of it.
struct Node {
    Row time, altitude, ahead, climb;  ///< [s], [m], [m/s] horizontal and upward
    Row ahead_rate, climb_rate;        ///< [m/s^2]
    Row force, acceleration;           ///< [N], [m/s^2]
};

/// Rates of one lane, and what its risers pull.
struct LaneLoads {
    double ahead_rate, climb_rate;  ///< [m/s^2]
    double force;                   ///< [N]
};

/// The equation of motion of RigidComposite at s in a stage, of canopies that batches take; `ratio` of the
/// drag area to the steady one, `power` its power of 1.5. Typed again for this layout, and held to it by
/// tests.
inline LaneLoads loads_of(const LaneData& d, std::size_t l, double s, double ratio, double power, double z,
                          double vx, double vz) {
    const double h = z - d.level[l];
    const double rho = d.density[l] + h * (d.slope[l] + h * d.bend[l]);
    const double half = 0.5 * rho * std::sqrt(vx * vx + vz * vz);
    const double drag = half * (d.steady_area[l] * ratio + d.payload_area[l]);
    const double ramp = d.ramp_begin[l] + s * d.ramp_rise[l];
    const double mass = d.weighed[l] + rho * power * (d.still[l] + ramp * d.ramping[l]);
    const double ax = -drag * vx / mass, az = (-drag * vz - d.weighed[l] * d.gravity[l]) / mass;
    const double own = half * d.payload_area[l];
    const double fx = d.hung[l] * ax + own * vx, fz = d.hung[l] * (az + d.gravity[l]) + own * vz;
    return {ax, az, std::sqrt(fx * fx + fz * fz)};
}

/// Loads of all lanes; null: not wanted.
TWINCHUTE_FOR_EACH_CPU
void accelerate(const LaneData& d, double s, const double* ratio, const double* power, const double* z,
                const double* vx, const double* vz, double* ax, double* az, double* force) {
    if (force) {
        for (std::size_t l = 0; l < batch_lanes; ++l) {
            const LaneLoads now = loads_of(d, l, s, ratio[l], power[l], z[l], vx[l], vz[l]);
            ax[l] = now.ahead_rate, az[l] = now.climb_rate, force[l] = now.force;
        }
        return;
    }
    for (std::size_t l = 0; l < batch_lanes; ++l) {
        const LaneLoads now = loads_of(d, l, s, ratio[l], power[l], z[l], vx[l], vz[l]);
        ax[l] = now.ahead_rate, az[l] = now.climb_rate;
    }
}

/// The largest value of a quantity of one lane.
struct Largest {
    Maximum best{0.0, -1.0};
    bool past = false;  ///< it has fallen well below

    void keep(const Maximum& found) {
        if (found.value > best.value) best = found;
    }
};

class Batch {
public:
    Batch(std::span<const Scene> scenes, std::span<const char> takes)
        : scenes_(scenes), alive_(takes.begin(), takes.end()) {
        const auto good = std::ranges::find(alive_, char{1});
        spare_ = static_cast<std::size_t>(good - alive_.begin());
        for (std::size_t l = 0; l < batch_lanes; ++l)
            prepare(l);
    }

    /// False of lanes that are not settled.
    const std::vector<char>& fly() {
        LaneSolver& solver = shared_solver(scenes_[spare_].rom.rtol);
        begin();
        for (const Phase phase : stages) {
            phase_ = phase;
            if (!fly_stage(solver)) {
                std::ranges::fill(alive_, char{0});
                return alive_;
            }
        }
        for (std::size_t l = 0; l < batch_lanes; ++l) {
            const bool to_peak = scenes_[l].stop.kind == Trigger::Kind::peak_force;
            const bool high = node_.altitude[l] > scenes_[l].environment.ground + 1.0;
            alive_[l] = alive_[l] && high && std::isfinite(node_.force[l]) && (!to_peak || force_[l].past);
        }
        return alive_;
    }

    OpeningResult result(std::size_t l) const {
        const Scene& scene = scenes_[l];
        OpeningResult r;
        r.snatch_speed = r.payload_snatch_speed = speed_[l];
        r.snatch_path_angle = scene.release.path_angle;
        r.snatch_density = snatch_density_[l];
        r.filling_time = inflation_[l].filling_time;
        r.peak_force = force_[l].best.value;
        r.peak_time = force_[l].best.at;
        r.max_force = force_[l].best.value;
        r.max_deceleration = deceleration_[l].best.value;
        return r;
    }

private:
    /// One for each thread: making one costs as much as a trajectory.
    LaneSolver& shared_solver(double rtol) {
        thread_local Batch* flying = nullptr;
        thread_local double its_rtol = 0.0;
        thread_local std::optional<LaneSolver> solver;
        flying = this;
        if (!solver || its_rtol != rtol) {
            solver.emplace(
                lanes, 3, [](double s, const double* y, double* dyds) { flying->rhs(s, y, dyds); }, rtol,
                smallest_scale);
            its_rtol = rtol;
        }
        return *solver;
    }

    const Scene& scene_of(std::size_t l) const { return scenes_[alive_[l] ? l : spare_]; }

    void prepare(std::size_t l) {
        const Scene& scene = scene_of(l);
        const Parachute& chute = scene.parachutes.front();
        const double altitude = scene.release.altitude;
        speed_[l] = scene.release.speed;
        snatch_density_[l] = scene.environment.atmosphere.at(altitude).density;
        inflation_[l] = make_inflation(scene, chute, 0.0, speed_[l], snatch_density_[l]);
        const Inflation& in = inflation_[l];
        if (!(std::isfinite(in.filling_time) && in.initial_time < in.filling_time)) alive_[l] = 0;
        data_.weighed[l] = scene.payload.mass + chute.mass;
        data_.hung[l] = scene.payload.mass;
        data_.gravity[l] = scene.environment.gravity;
        data_.steady_area[l] = in.steady_drag_area;
        data_.payload_area[l] = scene.payload.drag_area.value_or(0.0);
        data_.still[l] = data_.ramping[l] = 0.0;
        if (const auto& spec = scene.aerodynamics.added_mass) {
            // All models are proportional to density and cube of the radius, and linear in the ramp.
            const auto air = [&](double ramp) {
                return spec->mass(1.0, {steady_radius(chute), 0.0}, {ramp, 0.0}, chute.geometric_porosity)
                    .value;
            };
            data_.still[l] = air(0.0);
            data_.ramping[l] = air(1.0) - air(0.0);
        }
    }

    void begin() {
        for (std::size_t l = 0; l < batch_lanes; ++l) {
            const Release& release = scene_of(l).release;
            node_.time[l] = 0.0;
            node_.altitude[l] = release.altitude;
            node_.ahead[l] = release.speed * std::cos(release.path_angle);
            node_.climb[l] = -release.speed * std::sin(release.path_angle);
        }
    }

    /// [s] of the stage that begins: of the last one a while in which the force falls well below its peak.
    double duration_of(std::size_t l) const {
        const Inflation& in = inflation_[l];
        if (phase_ == Phase::initial) return in.initial_time;
        if (phase_ == Phase::filling) return in.filling_time - in.initial_time;
        const Trigger& stop = scene_of(l).stop;
        if (stop.kind == Trigger::Kind::full_open) return stop.delay;
        const double speed = length_of(node_.ahead[l], node_.climb[l]);
        const double slowing =
            -(node_.ahead[l] * node_.ahead_rate[l] + node_.climb[l] * node_.climb_rate[l]) / speed;
        constexpr double share = 0.06;  // of the speed to lose: twice as much of the force
        const double longest = speed / data_.gravity[l];
        return slowing > 0.0 ? std::min(share * speed / slowing, longest) : longest;
    }

    /// The air as a parabola over the altitudes that the stage may pass; a lane where that is not good enough
    /// is given up.
    void fit_air(std::size_t l) {
        const Atmosphere& air = scene_of(l).environment.atmosphere;
        const double speed = length_of(node_.ahead[l], node_.climb[l]);
        const double reach = std::max(1.0, 1.2 * (speed + 5.0) * data_.duration[l]);
        const double z = node_.altitude[l], direction = node_.climb[l] > 0.0 ? 1.0 : -1.0;
        const auto at = [&](double share) { return air.at(z + direction * share * reach).density; };
        const double a = at(0.0), b = at(0.5), c = at(1.0), step = 0.5 * reach * direction;
        data_.level[l] = z;
        data_.density[l] = a;
        data_.bend[l] = (c - 2.0 * b + a) / (2.0 * step * step);
        data_.slope[l] = (b - a) / step - data_.bend[l] * step;
        const double h = 1.5 * step;
        const double guess = a + h * (data_.slope[l] + h * data_.bend[l]);
        constexpr double good = 1e-7;
        if (!(std::abs(guess - at(0.75)) < good * a)) alive_[l] = 0;
    }

    void begin_stage() {
        for (std::size_t l = 0; l < batch_lanes; ++l) {
            const Inflation& in = inflation_[l];
            data_.duration[l] = duration_of(l);
            const double first = phase_ == Phase::initial ? 0.0 : in.initial_time / in.filling_time;
            data_.ramp_begin[l] = phase_ == Phase::open ? 1.0 : first;
            data_.ramp_rise[l] = phase_ == Phase::open ? 0.0 : data_.duration[l] / in.filling_time;
            fit_air(l);
        }
    }

    /// Drag areas over the steady ones at s, and their powers of 1.5. A law is asked once where its start is
    /// the same for all.
    void grow(double s) {
        for (std::size_t l = 0; l < batch_lanes; ++l) {
            const Inflation& in = inflation_[l];
            if (l > 0 && in.eta == inflation_[0].eta && in.law == inflation_[0].law) {
                ratio_[l] = ratio_[0], power_[l] = power_[0];
                continue;
            }
            ratio_[l] = ratio_at(l, s);
            power_[l] = ratio_[l] * std::sqrt(ratio_[l]);
        }
    }

    void rhs(double s, const double* y, double* dyds) {
        grow(s);
        const double *z = y, *vx = y + lanes, *vz = y + 2 * lanes;
        double *dz = dyds, *ax = dyds + lanes, *az = dyds + 2 * lanes;
        accelerate(data_, s, ratio_.data(), power_.data(), z, vx, vz, ax, az, nullptr);
        for (int l = 0; l < lanes; ++l) {
            dz[l] = data_.duration[l] * vz[l];
            ax[l] *= data_.duration[l];
            az[l] *= data_.duration[l];
        }
    }

    /// Rates and followed quantities of a node at s.
    void look(double s, Node& node) {
        grow(s);
        accelerate(data_, s, ratio_.data(), power_.data(), node.altitude.data(), node.ahead.data(),
                   node.climb.data(), node.ahead_rate.data(), node.climb_rate.data(), node.force.data());
        for (std::size_t l = 0; l < batch_lanes; ++l)
            node.acceleration[l] = length_of(node.ahead_rate[l], node.climb_rate[l]);
    }

    bool fly_stage(LaneSolver& solver) {
        if (phase_ == Phase::open) look(1.0, node_);  // still of the filling: its rates say how long it takes
        begin_stage();
        const Row began = node_.time;
        std::vector<double> y(3 * batch_lanes);
        std::ranges::copy(node_.altitude, y.begin());
        std::ranges::copy(node_.ahead, y.begin() + lanes);
        std::ranges::copy(node_.climb, y.begin() + 2 * lanes);
        solver.start(y);
        look(0.0, node_);
        if (phase_ == Phase::initial) start_peaks();
        s_ = 0.0;
        while (!solver.at_end()) {
            if (!solver.step()) return false;
            const std::span<const double> state = solver.state();
            Node next;
            for (std::size_t l = 0; l < batch_lanes; ++l) {
                next.time[l] = began[l] + solver.s() * data_.duration[l];
                next.altitude[l] = state[l];
                next.ahead[l] = state[batch_lanes + l];
                next.climb[l] = state[2 * batch_lanes + l];
            }
            look(solver.s(), next);
            follow(solver.s(), next);
            node_ = next;
            s_ = solver.s();
        }
        return true;
    }

    void start_peaks() {
        for (std::size_t l = 0; l < batch_lanes; ++l) {
            force_[l].best = {0.0, node_.force[l]};
            deceleration_[l].best = {0.0, node_.acceleration[l]};
        }
    }

    /// A step of the stage.
    struct Step {
        const Node &from, &to;
        double s_from, s_to;
    };

    /// The step from node_ to `next`.
    void follow(double s, const Node& next) {
        const bool first = s_ == 0.0, last = s >= 1.0;
        const Step step{node_, next, s_, s}, before{before_, node_, s_before_, s_};
        for (std::size_t l = 0; l < batch_lanes; ++l) {
            if (!alive_[l] || force_[l].past || !(data_.duration[l] > 0.0)) continue;
            follow_one(l, step, first ? nullptr : &before, last, &Node::force, force_[l]);
            follow_one(l, step, first ? nullptr : &before, last, &Node::acceleration, deceleration_[l]);
            // The run ends once the canopy is full and the force well below its peak.
            if (phase_ == Phase::open) force_[l].past = next.force[l] < past_peak * force_[l].best.value;
        }
        before_ = node_, s_before_ = s_;
    }

    /// A maximum inside a step: where a quantity that rose falls, in this step or in the one before; at the
    /// end of a stage, whose next step is another's, where it falls already.
    void follow_one(std::size_t l, const Step& step, const Step* before, bool last, Row Node::*quantity,
                    Largest& largest) {
        const double begin = (node_.*quantity)[l], end = (step.to.*quantity)[l];
        largest.keep({step.to.time[l], end});
        constexpr double near = 0.9, little = 1e-3;
        if (std::max(begin, end) < near * largest.best.value) return;
        const double length = step.to.time[l] - step.from.time[l];
        if (end > begin) {
            if (last && between(l, step, step.to.time[l] - little * length, quantity) > end)
                refine(l, step, quantity, largest);
        } else if (!before || (before->from.*quantity)[l] < begin) {
            if (between(l, step, step.from.time[l] + little * length, quantity) > begin)
                refine(l, step, quantity, largest);
            else if (before)
                refine(l, *before, quantity, largest);
        }
    }

    void refine(std::size_t l, const Step& step, Row Node::*quantity, Largest& largest) {
        const double from = step.from.time[l], length = step.to.time[l] - from;
        const auto at = [&](double time) { return between(l, step, time, quantity); };
        const std::array values{(step.from.*quantity)[l], at(from + 0.25 * length), at(from + 0.5 * length),
                                at(from + 0.75 * length), (step.to.*quantity)[l]};
        constexpr double closeness = 1e-3;  // of the place: the value is as good as its square
        largest.keep(maximum_on(at, from, step.to.time[l], values, closeness * length));
    }

    /// A quantity inside the step of one lane, by dense output.
    double between(std::size_t l, const Step& step, double time, Row Node::*quantity) const {
        const Node &from = step.from, &to = step.to;
        const double length = to.time[l] - from.time[l], share = (time - from.time[l]) / length;
        // Positions, then velocities; the way ahead counts from the beginning of the step.
        const double way = 0.5 * length * (from.ahead[l] + to.ahead[l]) +
                           length * length / 12.0 * (from.ahead_rate[l] - to.ahead_rate[l]);
        const std::array begin{0.0, from.altitude[l], from.ahead[l], from.climb[l]},
            end{way, to.altitude[l], to.ahead[l], to.climb[l]},
            begin_rate{from.ahead[l], from.climb[l], from.ahead_rate[l], from.climb_rate[l]},
            end_rate{to.ahead[l], to.climb[l], to.ahead_rate[l], to.climb_rate[l]};
        std::array<double, 4> y{};
        interpolate_step({from.time[l], to.time[l], begin, begin_rate, end, end_rate}, 2, time, y);
        const double s = step.s_from + share * (step.s_to - step.s_from);
        return quantity_at(l, s, y[1], y[2], y[3], quantity == &Node::force);
    }

    /// Drag area over the steady one, of one lane.
    double ratio_at(std::size_t l, double s) const {
        const Inflation& in = inflation_[l];
        return phase_ == Phase::open      ? 1.0
               : phase_ == Phase::initial ? in.eta * in.eta
                                          : in.growth().at(s, 0).value;
    }

    double quantity_at(std::size_t l, double s, double z, double vx, double vz, bool force) const {
        const double ratio = ratio_at(l, s);
        const LaneLoads now = loads_of(data_, l, s, ratio, ratio * std::sqrt(ratio), z, vx, vz);
        return force ? now.force : length_of(now.ahead_rate, now.climb_rate);
    }

    std::span<const Scene> scenes_;
    std::vector<char> alive_;
    std::size_t spare_ = 0;
    std::array<Inflation, batch_lanes> inflation_;
    Row speed_, snatch_density_, ratio_, power_;
    LaneData data_;
    Node before_, node_;  // that the last two steps of the stage ended at
    double s_before_ = 0.0, s_ = 0.0;
    Phase phase_ = Phase::initial;
    std::array<Largest, batch_lanes> force_, deceleration_;
};

/// A scene whose own numbers let it go in a batch.
bool takes(const Scene& scene) {
    if (scene.parachutes.size() != 1 || scene.environment.wind || has_calibration(scene)) return false;
    const Parachute& p = scene.parachutes.front();
    const bool at_once =
        p.deploy.by == DeployBy::line_stretch && !p.deploy_when && !p.cut && p.reefing.empty();
    const bool prescribed = !p.filling.is_predicted() && !p.drag_area_table && !p.drag_area_mach_table &&
                            !p.drag_area_exponent && !p.calibration && p.drag_area_law;
    const auto& air = scene.aerodynamics.added_mass;
    const bool still = !air || air->momentum == AddedMassMomentum::inertia_only;
    const Trigger& stop = scene.stop;
    const bool ends = stop.kind == Trigger::Kind::peak_force || stop.kind == Trigger::Kind::full_open;
    return p.count == 1 && p.lag.empty() && at_once && prescribed && still && ends &&
           scene.release.speed > 0.0 && scene.rom.method == "auto";
}

}  // namespace

bool batches(const Scene& scene, std::span<const std::string> keys) {
    const auto needs_history = [](const std::string& key) {
        return key == "impulse_N_s" || key.ends_with("_percent_drag_area_s");
    };
    return takes(scene) && std::ranges::none_of(keys, needs_history);
}

void batch_metrics(std::span<const Scene> scenes, Run& run, std::span<const std::string> keys,
                   std::span<double> values, std::span<StatusCode> statuses) {
    std::vector<char> settled;
    for (const Scene& scene : scenes)
        settled.push_back(takes(scene) ? 1 : 0);
    std::optional<Batch> batch;
    if (std::ranges::count(settled, char{1}) > 0) settled = batch.emplace(scenes, settled).fly();
    RunRecord record;
    for (std::size_t l = 0; l < scenes.size(); ++l) {
        const std::span<double> row = values.subspan(l * keys.size(), keys.size());
        if (!settled[l]) {
            statuses[l] = rom_metrics(scenes[l], run, keys, row).code;
            continue;
        }
        statuses[l] = StatusCode::completed;
        record.metrics.clear();
        add_opening_metrics(record, scenes[l], batch->result(l), {}, {});
        for (std::size_t i = 0; i < keys.size(); ++i)
            row[i] = record.metric(keys[i]).value_or(std::numeric_limits<double>::quiet_NaN());
    }
}

}  // namespace twinchute::rom
