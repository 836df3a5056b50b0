#include "lib/solve/validity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lib/scene/needs.hpp"

namespace twinchute {
namespace {

bool always(const Scene&, const Parachute&) {
    return true;
}
bool opens(const Parachute& p) {
    return p.deploy.by != DeployBy::inflated;
}
bool fills_by_speed(const Scene&, const Parachute& p) {
    return opens(p) && !p.filling.is_predicted() &&
           (p.fill_time.model->dimensional || p.fill_time.model->by_diameters);
}

// clang-format off
constexpr std::array correlations{
    CorrelationRow{"one drag area at all speeds", RangedQuantity::mach_number, 0.0, 0.5,
                   "stagnation pressure (1 + M^2/4 + ...) q, 6 % above q at 0.5: derived here",
                   KeyUser::both, true, [](const Scene&, const Parachute& p) { return !p.drag_area_mach_table; }},
    CorrelationRow{"parachute.drag_area_mach_table", RangedQuantity::mach_number, 0.0, 0.0, "the scene's own table",
                   KeyUser::both, true, [](const Scene&, const Parachute& p) { return p.drag_area_mach_table.has_value(); },
                   [](const Scene&, const Parachute& p) {
                       return std::pair(p.drag_area_mach_table->mach().front(), p.drag_area_mach_table->mach().back());
                   }},
    CorrelationRow{"payload.drag_area", RangedQuantity::mach_number, 0.0, 0.5,
                   "stagnation pressure (1 + M^2/4 + ...) q, 6 % above q at 0.5: derived here",
                   KeyUser::both, false, [](const Scene& s, const Parachute&) { return s.payload.drag_area.value_or(0.0) > 0.0; }},
    CorrelationRow{"filling time by snatch speed", RangedQuantity::snatch_mach_number, 0.0, 0.45,
                   "tests up to 500 ft/s, Knacke NWC TP 6575, p. 5-43, at the sound of sea level",
                   KeyUser::both, true, fills_by_speed},
    CorrelationRow{"filling time by a balance of mass", RangedQuantity::snatch_mach_number, 0.0, 0.5,
                   "air of one density, 13 % denser where it is brought to rest at 0.5: derived here",
                   KeyUser::both, true, [](const Scene&, const Parachute& p) { return opens(p) && (p.fill_time.balance || p.filling.is_predicted()); }},
    CorrelationRow{"added mass", RangedQuantity::mach_number, 0.0, 0.5,
                   "air of one density, 13 % denser where it is brought to rest at 0.5: derived here",
                   KeyUser::both, true, [](const Scene& s, const Parachute&) { return s.aerodynamics.added_mass.has_value(); }},
    CorrelationRow{"cylinder drag of the lines", RangedQuantity::mach_number, 0.0, 0.4,
                   "critical Mach number of a circular cylinder, 0.398 (van Dyke, Guttmann, J. Fluid Mech. 129, 1983)",
                   KeyUser::full, true, [](const Scene& s, const Parachute&) { return s.aerodynamics.line_drag.has_value(); }},
    CorrelationRow{"cylinder drag of the lines", RangedQuantity::line_reynolds, 0.116, 8.1e5,
                   "Wieselsberger 1922, NACA TN 84",
                   KeyUser::full, true, [](const Scene& s, const Parachute&) { return s.aerodynamics.line_drag.has_value(); }},
    CorrelationRow{"atmosphere", RangedQuantity::altitude, 0.0, 0.0, "range of environment.atmosphere",
                   KeyUser::both, false, always,
                   [](const Scene& s, const Parachute&) {
                       return std::pair(s.environment.atmosphere.lowest(), s.environment.atmosphere.highest());
                   }},
};
// clang-format on

/// Words about a quantity for messages.
struct QuantityWords {
    const char *format, *suggestion;
};

QuantityWords words_of(RangedQuantity quantity) {
    switch (quantity) {
        case RangedQuantity::mach_number:
            return {"Mach {:.3g}", "give parachute.drag_area_mach_table for the canopy, or fly more slowly"};
        case RangedQuantity::snatch_mach_number:
            return {"Mach {:.3g} at snatch", "give fill_time.time from tests, or open more slowly"};
        case RangedQuantity::line_reynolds:
            return {"lines at a Reynolds number of {:.3g}", "trust the drag of lines less there"};
        case RangedQuantity::altitude:
            break;
    }
    return {"an altitude of {:.6g} m", "stay inside, or give environment.atmosphere.table"};
}

/// Speed, Mach number, altitude of the flight, row by row of its history.
class Flown {
public:
    Flown(const RunRecord& record, const Scene& scene)
        : air_(scene.environment.atmosphere), has_sound_(air_.model->has_temperature) {
        const Channel *time = record.find_channel("time"), *altitude = record.find_channel("altitude"),
                      *pressure = record.find_channel("dynamic_pressure");
        if (time == nullptr || altitude == nullptr || pressure == nullptr) return;
        for (std::size_t i = 0; i < time->values.size(); ++i) {
            const AirState air = air_.at(altitude->values[i]);
            Point p{time->values[i], altitude->values[i], 0.0, 0.0};
            const double speed = std::sqrt(2.0 * std::max(0.0, pressure->values[i]) / air.density);
            p.mach = speed / speed_of_sound(air.temperature);
            p.reynolds_per_length = air.density * speed / air.viscosity;
            if (std::isfinite(p.mach) && std::isfinite(p.reynolds_per_length)) points_.push_back(p);
        }
    }

    bool empty() const { return points_.empty(); }
    bool has_sound() const { return has_sound_; }

    /// Largest of the rows from `begin` to `end` [s]; 0 of none.
    double mach(double begin, double end) const { return largest(&Point::mach, begin, end); }
    /// [1/m] Reynolds number over length, likewise.
    double reynolds_per_length(double begin, double end) const {
        return largest(&Point::reynolds_per_length, begin, end);
    }
    double lowest() const { return std::ranges::min(points_, {}, &Point::altitude).altitude; }
    double highest() const { return std::ranges::max(points_, {}, &Point::altitude).altitude; }

    /// Mach number of a speed [m/s] at a time [s].
    double mach_of(double speed, double time) const {
        auto at = std::ranges::lower_bound(points_, time, {}, &Point::time);
        if (at == points_.end()) --at;
        return speed / speed_of_sound(air_.at(at->altitude).temperature);
    }

private:
    struct Point {
        double time, altitude, mach, reynolds_per_length;
    };
    double largest(double Point::*quantity, double begin, double end) const {
        double largest = 0.0;
        for (const Point& p : points_)
            if (p.time >= begin && p.time <= end) largest = std::max(largest, p.*quantity);
        return largest;
    }

    const Atmosphere& air_;
    bool has_sound_;
    std::vector<Point> points_;
};

/// A parachute while it is out.
struct Out {
    const Parachute* chute;
    std::string name;  ///< where there are several
    double begin = 0.0, end = infinity;
    std::optional<double> snatch_mach;
};

std::vector<Out> parachutes_out(const RunRecord& record, const Scene& scene, const OpeningResult& r,
                                const Flown& flown) {
    std::vector<Out> all;
    const bool several = scene.parachutes.size() > 1;
    const auto add = [&](const Parachute& chute, double begin, double speed) {
        Out out{&chute, several ? chute.name : "", begin, infinity, {}};
        if (opens(chute)) out.snatch_mach = flown.mach_of(speed, begin);
        if (const Event* cut = record.find_event(several ? chute.name + ".cut" : "cut")) out.end = cut->time;
        all.push_back(std::move(out));
    };
    for (const ParachuteResult& p : r.parachutes)
        add(scene.parachutes[p.index], p.snatch_time, p.snatch_speed);
    const Parachute& first = scene.parachutes.front();
    if (all.empty() && (r.snatched || first.deploy.by == DeployBy::inflated))
        add(first, r.snatched ? r.snatch_time : 0.0, r.snatch_speed);
    return all;
}

/// Warnings of one parachute, or of the flight: one for each quantity, whichever rows it has left.
class Judge {
public:
    Judge(RunRecord& record, const Scene& scene, const Parachute& chute, std::string whose, bool has_sound)
        : record_(record),
          scene_(scene),
          chute_(chute),
          whose_(std::move(whose)),
          note_(has_sound
                    ? ""
                    : "; the air has no temperature, the sound is that of 288.15 K: a limit, no metric") {}

    void judge(RangedQuantity quantity, double value, bool of_parachute) {
        std::string beyond;
        for (const CorrelationRow& row : correlations) {
            const bool asked = row.quantity == quantity && row.of_parachute == of_parachute &&
                               (row.user == KeyUser::both || user_name(row.user) == record_.fidelity);
            if (!asked || !row.used(scene_, chute_)) continue;
            const auto [low, high] = row.range ? row.range(scene_, chute_) : std::pair(row.low, row.high);
            if (value >= low && value <= high) continue;
            beyond += fmt::format("{}{} from {:g} to {:g} ({})", beyond.empty() ? "" : "; ", row.name, low,
                                  high, row.source);
        }
        if (beyond.empty()) return;
        const QuantityWords words = words_of(quantity);
        const bool mach =
            quantity == RangedQuantity::mach_number || quantity == RangedQuantity::snatch_mach_number;
        record_.warnings.push_back({whose_ + fmt::format(fmt::runtime(words.format), value),
                                    fmt::format("beyond where these hold: {}{}", beyond, mach ? note_ : ""),
                                    words.suggestion});
    }

private:
    RunRecord& record_;
    const Scene& scene_;
    const Parachute& chute_;
    std::string whose_;
    const char* note_;
};

}  // namespace

std::span<const CorrelationRow> correlation_rows() {
    return correlations;
}

void add_validity(RunRecord& record, const Scene& scene, const OpeningResult& result) {
    using enum RangedQuantity;
    const Flown flown(record, scene);
    if (flown.empty()) return;
    const bool has_lines = scene.aerodynamics.line_drag && record.fidelity == user_name(KeyUser::full);
    const double max_mach = flown.mach(-infinity, infinity);
    if (flown.has_sound()) record.add_metric("max_mach_number", max_mach);
    record.add_metric("max_altitude_m", flown.highest());
    const Environment& air = scene.environment;
    if (!wind_warning(air, air.ground, scene.release.altitude))  // the scene said so itself
        if (auto warning = wind_warning(air, std::max(flown.lowest(), air.ground), flown.highest()))
            record.warnings.push_back(std::move(*warning));
    Judge flight(record, scene, scene.parachutes.front(), "", flown.has_sound());
    flight.judge(mach_number, max_mach, false);
    flight.judge(altitude, flown.highest(), false);
    // A landing is found a little below the ground, where an atmosphere may end.
    flight.judge(altitude, std::max(flown.lowest(), scene.environment.ground), false);
    for (const Out& out : parachutes_out(record, scene, result, flown)) {
        Judge judge(record, scene, *out.chute, out.name.empty() ? "" : out.name + ": ", flown.has_sound());
        judge.judge(mach_number, flown.mach(out.begin, out.end), true);
        if (out.snatch_mach) {
            const bool in_flight = out.chute->deploy.starts_packed() || out.chute->deploy_when;
            if (flown.has_sound())
                record.add_metric(metric_head(out.name) + "snatch_mach_number", *out.snatch_mach,
                                  in_flight ? MetricKind::result : MetricKind::input);
            judge.judge(snatch_mach_number, *out.snatch_mach, true);
        }
        if (!has_lines) continue;
        const double reynolds = out.chute->line.diameter * flown.reynolds_per_length(out.begin, out.end);
        record.add_metric(metric_head(out.name) + "max_line_reynolds_number", reynolds, MetricKind::result,
                          "of a suspension line across the air");
        judge.judge(line_reynolds, reynolds, true);
    }
}

}  // namespace twinchute
