#include "rom/batch.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "lib/math/chebyshev.hpp"
#include "lib/math/maximum.hpp"
#include "lib/models/inflation.hpp"
#include "lib/scene/calibration.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/solve/opening.hpp"
#include "lib/solve/sundials_lanes.hpp"
#include "rom/batch_lanes.hpp"
#include "rom/rom_record.hpp"
#include "rom/run_context.hpp"
#include "rom/run_rom.hpp"

namespace twinchute::rom {
namespace {

constexpr auto lanes = static_cast<int>(batch_lanes);

double length_of(double x, double z) {
    return std::sqrt(x * x + z * z);
}

/// Stages of a lane: initial phase, filling, and a while with the full drag area.
constexpr std::array stages{Phase::initial, Phase::filling, Phase::open};

/// Density of the air over all altitudes of a batch: the standard one takes a power at each.
class Densities {
public:
    /// From `low` to `high` [m]; where the air is not that smooth, it is asked itself.
    Densities(const Atmosphere& air, double low, double high) : air_(air), low_(low), high_(high) {
        using Series = Chebyshev<11>;
        std::array<double, 11> values{};
        for (std::size_t k = 0; k < values.size(); ++k)
            values[k] = air.at(Series::node(k, low, high)).density;
        series_ = {values, low, high};
        constexpr double good = 1e-10;
        for (const double share : {0.0, 0.03, 0.21, 0.47, 0.74, 0.93, 1.0}) {
            const double z = low + share * (high - low), exact = air.at(z).density;
            smooth_ = smooth_ && std::abs(series_.at(z).value - exact) < good * exact;
        }
    }
    double at(double z) const {
        return smooth_ && z >= low_ && z <= high_ ? series_.at(z).value : air_.at(z).density;
    }

private:
    const Atmosphere& air_;
    double low_, high_;
    Chebyshev<11> series_;
    bool smooth_ = true;
};

class Batch {
public:
    Batch(std::span<const Scene> scenes, std::span<const char> takes)
        : scenes_(scenes), alive_(takes.begin(), takes.end()) {
        const auto good = std::ranges::find(alive_, char{1});
        spare_ = static_cast<std::size_t>(good - alive_.begin());
        for (std::size_t l = 0; l < batch_lanes; ++l)
            prepare(l);
        // A lane that never fills is no number to the others' step.
        const auto filling = std::ranges::find(alive_, char{1});
        if (filling == alive_.end()) return;
        spare_ = static_cast<std::size_t>(filling - alive_.begin());
        for (std::size_t l = 0; l < batch_lanes; ++l)
            if (takes[l] && !alive_[l]) prepare(l);
        const Inflation& first = inflation_[0];
        one_growth_ = std::ranges::all_of(
            inflation_, [&](const Inflation& in) { return in.eta == first.eta && in.law == first.law; });
    }

    /// False of lanes that are not settled.
    const std::vector<char>& fly() {
        if (!alive_[spare_]) return alive_;
        LaneSolver& solver = shared_solver(scenes_[spare_].rom.rtol);
        begin();
        for (const Phase phase : stages) {
            phase_ = phase;
            if (!begin_stage()) break;
            if (!fly_stage(solver)) {
                std::ranges::fill(alive_, char{0});
                return alive_;
            }
        }
        for (std::size_t l = 0; l < batch_lanes; ++l) {
            const bool to_peak = scenes_[l].stop.kind == Trigger::Kind::peak_force;
            const bool high = node_->altitude[l] > scenes_[l].environment.ground + 1.0;
            alive_[l] = alive_[l] && high && std::isfinite(node_->force[l]) && (!to_peak || past_[l]);
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
        r.peak_force = force_.value[l];
        r.peak_time = force_.at[l];
        r.max_force = force_.value[l];
        r.max_deceleration = deceleration_.value[l];
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
        const bool as_before = l > 0 && altitude == scene_of(l - 1).release.altitude && has_same_air(l);
        snatch_density_[l] =
            as_before ? snatch_density_[l - 1] : scene.environment.atmosphere.at(altitude).density;
        inflation_[l] = make_inflation(scene, chute, 0.0, speed_[l], snatch_density_[l]);
        const Inflation& in = inflation_[l];
        if (refused_opening(in, 0.0)) alive_[l] = 0;
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
            data_.ramping[l] = air(1.0) - data_.still[l];
        }
    }

    bool has_same_air(std::size_t l) const {
        return scene_of(l).environment.atmosphere == scene_of(0).environment.atmosphere;
    }

    void begin() {
        double low = infinity, high = -infinity;
        for (std::size_t l = 0; l < batch_lanes; ++l) {
            const Release& release = scene_of(l).release;
            node_->time[l] = 0.0;
            node_->altitude[l] = release.altitude;
            node_->ahead[l] = release.speed * std::cos(release.path_angle);
            node_->climb[l] = -release.speed * std::sin(release.path_angle);
            constexpr double and_more = 1.5;  // than the filling: the force has to fall
            const double way = and_more * reach(release.speed, inflation_[l].filling_time);
            low = std::min(low, release.altitude - way);
            high = std::max(high, release.altitude + way);
            watched_[l] = alive_[l] != 0 ? 1 : 0;
            past_[l] = 0;
            one_air_ = one_air_ && has_same_air(l);
        }
        densities_.emplace(scene_of(0).environment.atmosphere, low, high);
    }

    /// [m] that a lane may move in so many seconds.
    static double reach(double speed, double seconds) { return std::max(1.0, 1.2 * (speed + 5.0) * seconds); }

    /// [s] of the stage that begins: of the last one a while in which the force falls well below its peak.
    double duration_of(std::size_t l) const {
        const Inflation& in = inflation_[l];
        if (phase_ == Phase::initial) return in.initial_time;
        if (phase_ == Phase::filling) return in.filling_time - in.initial_time;
        const Trigger& stop = scene_of(l).stop;
        if (stop.kind == Trigger::Kind::full_open) return stop.delay;
        const double speed = length_of(node_->ahead[l], node_->climb[l]);
        const double slowing =
            -(node_->ahead[l] * node_->ahead_rate[l] + node_->climb[l] * node_->climb_rate[l]) / speed;
        constexpr double share = 0.06;  // of the speed to lose: twice as much of the force
        const double longest = speed / data_.gravity[l];
        return slowing > 0.0 ? std::min(share * speed / slowing, longest) : longest;
    }

    /// The air as a parabola over the altitudes that the stage may pass; a lane where that is not good enough
    /// is given up.
    void fit_air(std::size_t l) {
        const double speed = length_of(node_->ahead[l], node_->climb[l]);
        const double far = reach(speed, data_.duration[l]);
        const double z = node_->altitude[l], direction = node_->climb[l] > 0.0 ? 1.0 : -1.0;
        const auto at = [&](double share) {
            const double place = z + direction * share * far;
            return one_air_ ? densities_->at(place) : scene_of(l).environment.atmosphere.at(place).density;
        };
        const double a = at(0.0), b = at(0.5), c = at(1.0), step = 0.5 * far * direction;
        data_.level[l] = z;
        data_.density[l] = a;
        data_.bend[l] = (c - 2.0 * b + a) / (2.0 * step * step);
        data_.slope[l] = (b - a) / step - data_.bend[l] * step;
        const double h = 1.5 * step;
        const double guess = a + h * (data_.slope[l] + h * data_.bend[l]);
        constexpr double good = 1e-7;
        if (!(std::abs(guess - at(0.75)) < good * a)) give_up(l);
    }

    void give_up(std::size_t l) { alive_[l] = 0, watched_[l] = 0; }

    /// False where no lane has anything left to come.
    bool begin_stage() {
        if (phase_ == Phase::open) {
            grow(1.0, Phase::filling, growth_);
            look(data_, 1.0, growth_, *node_);  // still of the filling: its rates say how long it takes
            pass_peaks(*node_);
            if (std::ranges::none_of(watched_, [](std::int64_t is) { return is != 0; })) return false;
        }
        for (std::size_t l = 0; l < batch_lanes; ++l) {
            const Inflation& in = inflation_[l];
            data_.duration[l] = duration_of(l);
            const double first = phase_ == Phase::initial ? 0.0 : in.initial_time / in.filling_time;
            data_.ramp_begin[l] = phase_ == Phase::open ? 1.0 : first;
            data_.ramp_rise[l] = phase_ == Phase::open ? 0.0 : data_.duration[l] / in.filling_time;
            fit_air(l);
            if (!(data_.duration[l] > 0.0)) watched_[l] = 0;
            if (phase_ == Phase::filling) watched_[l] = alive_[l] != 0 ? 1 : 0;
        }
        return true;
    }

    /// A run to its peak ends once the canopy is full and the force well below it.
    void pass_peaks(const Node& node) {
        for (std::size_t l = 0; l < batch_lanes; ++l) {
            if (!watched_[l] || scenes_[l].stop.kind != Trigger::Kind::peak_force) continue;
            past_[l] = node.force[l] < past_peak * force_.value[l];
            if (past_[l]) watched_[l] = 0;
        }
    }

    /// Drag areas over the steady ones at s, and their powers of 1.5. A law is asked once where it is the
    /// same for all.
    void grow(double s, Phase phase, Growth& growth) const {
        for (std::size_t l = 0; l < batch_lanes; ++l) {
            if (l > 0 && one_growth_) {
                growth.ratio[l] = growth.ratio[0], growth.power[l] = growth.power[0];
                continue;
            }
            const Inflation& in = inflation_[l];
            const double ratio = phase == Phase::open      ? 1.0
                                 : phase == Phase::initial ? in.eta * in.eta
                                                           : in.growth().at(s, 0).value;
            growth.ratio[l] = ratio, growth.power[l] = ratio * std::sqrt(ratio);
        }
    }

    void rhs(double s, const double* y, double* dyds) {
        grow(s, phase_, growth_);
        stage_rates(data_, s, growth_, y, dyds);
    }

    bool fly_stage(LaneSolver& solver) {
        const Row began = node_->time;
        std::array<double, 3 * batch_lanes> y;
        std::ranges::copy(node_->altitude, y.begin());
        std::ranges::copy(node_->ahead, y.begin() + lanes);
        std::ranges::copy(node_->climb, y.begin() + 2 * lanes);
        solver.start(y);
        grow(0.0, phase_, growth_);
        look(data_, 0.0, growth_, *node_);
        if (phase_ == Phase::initial) {
            force_ = {{}, node_->force};
            deceleration_ = {{}, node_->acceleration};
        }
        before_is_seen_ = step_is_seen_ = false;
        s_ = 0.0;
        while (!solver.at_end()) {
            if (!solver.step()) return false;
            const std::span<const double> state = solver.state();
            for (std::size_t l = 0; l < batch_lanes; ++l) {
                next_->time[l] = began[l] + solver.s() * data_.duration[l];
                next_->altitude[l] = state[l];
                next_->ahead[l] = state[batch_lanes + l];
                next_->climb[l] = state[2 * batch_lanes + l];
            }
            grow(solver.s(), phase_, growth_);
            look(data_, solver.s(), growth_, *next_);
            follow(solver.s());
        }
        return true;
    }

    /// The step from node_ to next_, which then are before_ and node_.
    void follow(double s) {
        const bool first = s_ == 0.0, last = s >= 1.0;
        const Node &from = *node_, &to = *next_;
        const bool forces = find_turns(watched_, first ? nullptr : &before_->force, from.force, to.force,
                                       to.time, last, force_, force_turns_);
        const bool slowings =
            find_turns(watched_, first ? nullptr : &before_->acceleration, from.acceleration, to.acceleration,
                       to.time, last, deceleration_, slowing_turns_);
        if (forces || slowings) {
            if (!first && !before_is_seen_) see(*before_, from, s_before_, s_, before_inside_);
            see(from, to, s_, s, inside_);
            step_is_seen_ = true;
            for (std::size_t l = 0; l < batch_lanes; ++l) {
                if (force_turns_[l]) refine(l, first, &Node::force, &Inside::force, force_);
                if (slowing_turns_[l])
                    refine(l, first, &Node::acceleration, &Inside::acceleration, deceleration_);
            }
        }
        if (phase_ == Phase::open) pass_peaks(to);
        s_before_ = s_, s_ = s;
        before_is_seen_ = std::exchange(step_is_seen_, false);
        std::swap(before_inside_, inside_);
        std::swap(before_, node_);
        std::swap(node_, next_);
    }

    /// Followed quantities at the three inner ones of five equidistant places of a step.
    struct Inside {
        std::array<Row, 3> force, acceleration;
    };

    void see(const Node& from, const Node& to, double s_from, double s_to, Inside& inside) {
        static const std::array places{inner_place(0.25), inner_place(0.5), inner_place(0.75)};
        for (std::size_t i = 0; i < places.size(); ++i) {
            const double s = s_from + 0.25 * static_cast<double>(i + 1) * (s_to - s_from);
            grow(s, phase_, growth_);
            look_inside(data_, s, growth_, from, to, places[i], inside.force[i], inside.acceleration[i]);
        }
    }

    /// A maximum about the beginning of the step from node_ to next_, or inside it where it still rises.
    void refine(std::size_t l, bool first, Row Node::*quantity, std::array<Row, 3> Inside::*inner,
                Maxima& maxima) {
        const auto keep = [&](const Node& from, const Node& to, const Inside& inside) {
            const std::array<Row, 3>& between = inside.*inner;
            const std::array values{(from.*quantity)[l], between[0][l], between[1][l], between[2][l],
                                    (to.*quantity)[l]};
            const Maximum found = maximum_of_quartic(values, from.time[l], to.time[l]);
            if (found.value > maxima.value[l]) maxima.value[l] = found.value, maxima.at[l] = found.at;
        };
        keep(*node_, *next_, inside_);
        const bool falls = (next_->*quantity)[l] <= (node_->*quantity)[l];
        if (falls && !first) keep(*before_, *node_, before_inside_);
    }

    std::span<const Scene> scenes_;
    std::vector<char> alive_;
    std::size_t spare_ = 0;
    std::array<Inflation, batch_lanes> inflation_;
    bool one_growth_ = true, one_air_ = true;
    std::optional<Densities> densities_;
    Row speed_, snatch_density_;
    LaneData data_;
    Growth growth_;
    std::array<Node, 3> nodes_;
    Node *before_ = &nodes_[0], *node_ = &nodes_[1], *next_ = &nodes_[2];  // ends of the last two steps
    double s_before_ = 0.0, s_ = 0.0;
    Phase phase_ = Phase::initial;
    Flags watched_, past_;  // lanes that may still have a peak; those that had it
    Flags force_turns_, slowing_turns_;
    Maxima force_, deceleration_;
    Inside before_inside_, inside_;
    bool before_is_seen_ = false, step_is_seen_ = false;
};

/// Metrics by the keys that are asked for. Those of runs alike come in one order: where each goes is looked
/// up once.
class MetricColumns {
public:
    explicit MetricColumns(std::span<const std::string> keys) : keys_(keys) {}

    void fill(std::span<double> row, const Scene& scene, const OpeningResult& result) {
        std::ranges::fill(row, std::numeric_limits<double>::quiet_NaN());
        std::size_t next = 0;
        add_opening_metrics(
            [&](std::string_view key, double value, MetricKind, std::string_view) {
                if (next == order_.size() || order_[next].first != key) order_.resize(next);
                if (next == order_.size()) order_.emplace_back(key, column_of(key));
                if (const std::size_t column = order_[next++].second; column < row.size())
                    row[column] = value;
            },
            scene, result, {}, {});
    }

private:
    std::size_t column_of(std::string_view key) const {
        return static_cast<std::size_t>(std::ranges::find(keys_, key) - keys_.begin());
    }

    std::span<const std::string> keys_;
    std::vector<std::pair<std::string, std::size_t>> order_;
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
    return takes(scene) && std::ranges::none_of(keys, [](const std::string& key) {
               return key == "impulse_N_s" || needs_channels(key);
           });
}

void batch_metrics(std::span<const Scene> scenes, Run& run, std::span<const std::string> keys,
                   std::span<double> values, std::span<StatusCode> statuses) {
    std::vector<char> settled;
    for (const Scene& scene : scenes)
        settled.push_back(takes(scene) ? 1 : 0);
    std::optional<Batch> batch;
    if (std::ranges::count(settled, char{1}) > 0) settled = batch.emplace(scenes, settled).fly();
    MetricColumns columns(keys);
    for (std::size_t l = 0; l < scenes.size(); ++l) {
        const std::span<double> row = values.subspan(l * keys.size(), keys.size());
        if (!settled[l]) {
            statuses[l] = rom_metrics(scenes[l], run, keys, row).code;
            continue;
        }
        statuses[l] = StatusCode::completed;
        columns.fill(row, scenes[l], batch->result(l));
    }
}

}  // namespace twinchute::rom
