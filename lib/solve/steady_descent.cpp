#include "lib/solve/steady_descent.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace twinchute {
namespace {

constexpr double rows_per_window = 256.0;
constexpr std::size_t fewest_rows = 12;      // in a window
constexpr double min_swing = 0.0025;         // s^2/(8 w^2) from which on a window holds two periods
constexpr double growth_of_breathing = 3.0;  // of r, that is still to come
constexpr double periods = 2.0;
constexpr double slowest_decay = 0.98;      // of a trend, from one part of the window to the next
constexpr double windows_of_a_swing = 3.0;  // that does not decay, see SteadyDescent::judge
constexpr double windows_kept = 4.0;
constexpr double growth_of_swing = 3.0;  // from half a window to the next, that is still to come
constexpr double max_layers = 400.0;     // of wind that are looked at

/// Remainder of a trend after the last of three means, beside a reference.
double left_of_trend(double a, double b, double c) {
    const double first = b - a, second = c - b;
    if (!(first * second > 0.0)) return std::max(std::abs(first), std::abs(second));
    const double decay = std::min(second / first, slowest_decay);
    return std::abs(c - 1.0 + second * decay / (1.0 - decay));
}

double density_at(const Environment& environment, double altitude) {
    return environment.atmosphere.at(altitude).density;
}

/// [m/s] across, over the way in which a fall with `sink` follows the wind.
double change_of_wind(const Wind& wind, double altitude, double way) {
    const Vec3 change = wind.at(altitude) - wind.at(altitude - way);
    return std::hypot(change.x(), change.y());
}

}  // namespace

double density_lag(const Environment& environment, double altitude, double sink, double added_mass_ratio) {
    constexpr double step = 10.0;  // [m]
    const double above = density_at(environment, altitude + step),
                 below = density_at(environment, altitude - step);
    const double slope = (below - above) / (step * (below + above));  // 1/H
    return (1.0 + added_mass_ratio) * sink * sink * slope / (4.0 * environment.gravity);
}

double change_below(const Environment& environment, double altitude, double sink, double added_mass_ratio) {
    const double depth =
        std::min(altitude - environment.ground, steady_descent_foresight * std::max(0.0, sink));
    if (!(depth > 0.0)) return 0.0;
    const double here = density_at(environment, altitude);
    const double lag = density_lag(environment, altitude, sink, added_mass_ratio);
    constexpr int layers = 4;
    double by_air = 0.0;
    for (int k = 1; k <= layers; ++k) {
        const double z = altitude - depth * k / layers, ratio = density_at(environment, z) / here;
        by_air = std::max(
            by_air,
            std::abs(density_lag(environment, z, sink / std::sqrt(ratio), added_mass_ratio * ratio) - lag));
    }
    if (!environment.wind || environment.wind->levels.size() < 2) return by_air;
    const Wind& wind = *environment.wind;
    const double way = sink * sink / environment.gravity, updraft = wind.at(altitude).z();
    double across = 0.0, upward = 0.0;
    for (double down = 0.0; down < depth; down += std::max(0.5 * way, depth / max_layers)) {
        across = std::max(across, change_of_wind(wind, altitude - down, std::min(way, depth - down)) / sink);
        upward = std::max(upward, std::abs(wind.at(altitude - down).z() - updraft) / sink);
    }
    return by_air + 0.5 * across * across + upward;
}

void SteadyDescent::add(const FallSample& now) {
    const double root = std::sqrt(now.density);
    const double spacing = descent_window(now.sink, 0.0, environment_->gravity) / rows_per_window;
    if (rows_.empty()) {
        now_ = {now.time, now.sink * root, 0.0, 0.0, 0.0, 0.0, 0.0, now.air_sink, 0.0, 0.0, 0.0, {}, 0.0,
                0.0};
        rows_.push_back(now_);
    } else {
        const FallSample& before = last_;
        const double half = 0.5 * (now.time - before.time);
        now_.time = now.time;
        now_.u = now.sink * root;
        now_.descent += half * (before.sink - before.updraft + now.sink - now.updraft);
        now_.path += half * (before.sink * std::sqrt(before.density) + now_.u);
        now_.balance +=
            half * (before.density * before.airspeed * before.sink + now.density * now.airspeed * now.sink);
        const double of_air =
            0.5 * (before.added_mass_ratio + now.added_mass_ratio) * (now.air_sink - before.air_sink);
        now_.gained += now.system_sink - before.system_sink + of_air +
                       half * (before.accretion * before.sink + now.accretion * now.sink);
        now_.air_sink = now.air_sink;
        now_.added += half * (before.added_mass_ratio + now.added_mass_ratio);
        now_.air_gained += of_air;
        now_.grown += half * (before.growth * before.sink + now.growth * now.sink) -
                      0.5 * (before.added_mass_ratio + now.added_mass_ratio) * now.sink *
                          std::log(now.density / before.density);
        now_.swing += half * (before.swing + now.swing);
        for (std::size_t i = 0; i < now.across.size(); ++i)
            now_.across[i] += half * (before.across[i] + now.across[i]);
        now_.area += half * (before.area + now.area);
        now_.area_squared += half * (before.area * before.area + now.area * now.area);
        // The last row moves along until the next one is due.
        if (rows_.size() > 1 && now.time - rows_[rows_.size() - 2].time < spacing)
            rows_.back() = now_;
        else
            rows_.push_back(now_);
    }
    last_ = now;
}

std::size_t SteadyDescent::row_at(double time) const {
    const auto row = std::ranges::lower_bound(rows_, time, {}, &Row::time);
    return static_cast<std::size_t>(row - rows_.begin());
}

double SteadyDescent::mean(double Row::*integral, std::size_t from, std::size_t to) const {
    return (rows_[to].*integral - rows_[from].*integral) / (rows_[to].time - rows_[from].time);
}

/// u_b; not a number where the fall is no fall.
double SteadyDescent::balanced(std::size_t from, std::size_t to) const {
    return std::sqrt(mean(&Row::balance, from, to) /
                     (1.0 - mean(&Row::gained, from, to) / environment_->gravity));
}

double SteadyDescent::trend_of_balance(std::size_t from, std::size_t to) const {
    const double begin = rows_[from].time, third = (rows_[to].time - begin) / 3.0;
    const std::size_t a = row_at(begin + third), b = row_at(begin + 2.0 * third);
    const double all = balanced(from, to);
    return left_of_trend(balanced(from, a) / all, balanced(a, b) / all, balanced(b, to) / all);
}

double SteadyDescent::trend_of_mean(std::size_t from, std::size_t to) const {
    const double begin = rows_[from].time, third = (rows_[to].time - begin) / 3.0;
    const std::size_t a = row_at(begin + third), b = row_at(begin + 2.0 * third);
    const double all = mean(&Row::path, from, to);
    return left_of_trend(mean(&Row::path, from, a) / all, mean(&Row::path, a, b) / all,
                         mean(&Row::path, b, to) / all);
}

double SteadyDescent::amplitude(std::size_t from) const {
    const auto [low, high] = std::ranges::minmax(std::span(rows_).subspan(from), {}, &Row::u);
    return 0.5 * (high.u - low.u) / mean(&Row::path, from, rows_.size() - 1);
}

/// [-] What a glide takes of the rate beyond what the balance holds.
double SteadyDescent::glide(std::size_t from, std::size_t to, double sink) const {
    const auto& a = rows_[from].across;
    const auto& b = rows_[to].across;
    const double speed = std::hypot(b[0] - a[0], b[1] - a[1]) / (rows_[to].time - rows_[from].time);
    return 0.5 * speed * speed / (sink * sink);
}

/// [-] Root mean square of the projected area about its mean, over that mean; 0 without an area.
double SteadyDescent::breath(std::size_t from, std::size_t to) const {
    const double area = mean(&Row::area, from, to);
    return area > 0.0 ? std::sqrt(std::max(0.0, mean(&Row::area_squared, from, to) / (area * area) - 1.0))
                      : 0.0;
}

/// Share r [-] of breathing, and of growth where air accretes.
double SteadyDescent::breathing(std::size_t from, std::size_t to) const {
    const Row &a = rows_[from], &b = rows_[to];
    const double lasting =
        b.air_gained - a.air_gained - mean(&Row::added, from, to) * (b.air_sink - a.air_sink);
    return 0.5 * (std::abs(lasting) + std::max(0.0, b.grown - a.grown)) /
           (environment_->gravity * (b.time - a.time));
}

std::optional<DescentWindow> SteadyDescent::judge(double altitude) {
    if (rows_.size() < fewest_rows || !(last_.sink > 0.0) || !(environment_->gravity > 0.0)) return {};
    const std::size_t end = rows_.size() - 1;
    const double now = rows_[end].time, begin = rows_.front().time, mu = last_.added_mass_ratio;
    double length = descent_window(last_.sink, mu, environment_->gravity);
    if (now - begin < length) return {};
    std::size_t from = row_at(now - length);
    if (end - from < fewest_rows) return {};
    const double sink = mean(&Row::path, from, end) / std::sqrt(last_.density);
    const bool swings = mean(&Row::swing, from, end) > 8.0 * min_swing * sink * sink;
    if (swings) {
        length = std::max(length, periods * last_.period);
        if (now - begin < length) return {};
        from = row_at(now - length);
    }
    if (const std::size_t stale = row_at(now - windows_kept * length); stale > rows_.size() / 2) {
        rows_.erase(rows_.begin(), rows_.begin() + static_cast<std::ptrdiff_t>(stale));
        return judge(altitude);
    }
    const double lag = density_lag(*environment_, altitude, sink, mu);
    DescentWindow window;
    // Everything but what the mean over the window is off.
    const auto look = [&](std::size_t first) {
        const double middle = 0.5 * (rows_[first].time + now);
        const std::size_t half = row_at(middle);
        window.from = rows_[first].time;
        window.to = now;
        window.rate = mean(&Row::descent, first, end);
        window.drift = mean(&Row::path, half, end) / mean(&Row::path, first, half) - 1.0;
        window.amplitude = amplitude(first);
        const double area = mean(&Row::area, first, half);
        window.filling = area > 0.0 ? mean(&Row::area, half, end) / area - 1.0 : 0.0;
        window.breath = {breath(first, half), breath(half, end)};
        const double gained = mean(&Row::swing, half, end) - mean(&Row::swing, first, half);
        window.breathing = growth_of_breathing * breathing(first, end);
        window.remaining = growth_of_swing * std::max(0.0, gained) / (8.0 * sink * sink) + window.breathing;
        // Mean of the lag: that of the middle.
        const double above = altitude + rows_[end].descent - rows_[half].descent;
        const double ratio = density_at(*environment_, above) / last_.density;
        return density_lag(*environment_, above, sink / std::sqrt(ratio), mu * ratio);
    };
    const double mean_lag = look(from);
    window.remaining += std::abs(std::log(mean(&Row::path, from, end) / balanced(from, end)) - mean_lag) +
                        std::abs(mean_lag - lag) + trend_of_balance(from, end) + glide(from, end, sink);
    // Or what swings goes on to: a limit cycle, a glide. Its mean has to stay over three such windows.
    const double all = windows_of_a_swing * std::max(length, periods * last_.period);
    if (swings && !(window.remaining < steady_descent_remaining) && now - begin >= all) {
        const std::size_t first = row_at(now - all);
        const DescentWindow short_one = window;
        const double lag_of_all = look(first);
        window.remaining += std::abs(lag_of_all - lag) + trend_of_mean(first, end);
        if (!window.is_steady()) window = short_one;
    }
    if (!std::isfinite(window.remaining)) window.remaining = std::numeric_limits<double>::infinity();
    if (window.is_steady()) window.remaining += change_below(*environment_, altitude, sink, mu);
    return window;
}

void SteadyDescent::serialize(Archive& archive) {
    archive.row("fall", last_, [](FallSample& s, auto&& each) {
        auto& [time, density, sink, airspeed, updraft, system_sink, air_sink, added_mass_ratio, accretion,
               growth, swing, period, across, area] = s;
        for (double* x :
             {&time, &density, &sink, &airspeed, &updraft, &system_sink, &air_sink, &added_mass_ratio,
              &accretion, &growth, &swing, &period, &across[0], &across[1], &area})
            each(*x);
    });
    const auto members = [](Row& row, auto&& each) {
        auto& [time, u, descent, path, balance, gained, swing, air_sink, added, air_gained, grown, across,
               area, area_squared] = row;
        for (double* x : {&time, &u, &descent, &path, &balance, &gained, &swing, &air_sink, &added,
                          &air_gained, &grown, &across[0], &across[1], &area, &area_squared})
            each(*x);
    };
    archive.row("fall so far", now_, members);
    archive.rows("falls", rows_, members);
}

std::string unsteadiness_text(const std::optional<DescentWindow>& last) {
    if (!last) return "it ended before the open canopy had fallen for one window, at least 4 v/g";
    const std::string over =
        fmt::format("over its last {:.3g} s, to {:.4g} s,", last->to - last->from, last->to);
    if (last->turns != 1.0)
        return fmt::format(
            "the skirt of its canopy turns {:g} times on its way around: fabric has passed through fabric",
            last->turns);
    if (last->is_steady())
        return "the fall was steady, but a parachute was not open, not full, or still to be cut";
    if (std::abs(last->drift) >= steady_descent_change)
        return fmt::format("{} the mean of v sqrt(rho) drifts by {:.2g} % from one half to the other", over,
                           100.0 * last->drift);
    if (std::abs(last->filling) >= steady_descent_filling)
        return fmt::format(
            "{} the projected area of the canopy changes by {:.2g} % from one half to the other", over,
            100.0 * last->filling);
    if (last->breathes_more())
        return fmt::format(
            "{} its canopy breathes more and more, by {:.2g} % of its projected area (rms) in the first half "
            "and {:.2g} % in the second (aerodynamics.breathing_damping damps it)",
            over, 100.0 * last->breath[0], 100.0 * last->breath[1]);
    const std::string breathes =
        last->breathing > 0.5 * last->remaining
            ? ": the canopy still breathes or grows (aerodynamics.breathing_damping damps the former)"
            : "";
    return fmt::format("{} the rate of descent is estimated to be still off by {:.2g} %{}", over,
                       100.0 * last->remaining, breathes);
}

}  // namespace twinchute
