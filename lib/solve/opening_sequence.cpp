#include "lib/solve/opening_sequence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "lib/scene/trigger.hpp"
#include "lib/solve/opening.hpp"

namespace twinchute {
namespace {

/// A time that has come, to round-off.
bool is_due(double due, double time) {
    return std::isfinite(due) && due - time <= 64.0 * std::numeric_limits<double>::epsilon() * std::abs(due);
}

double phase_end(const Canopy& c) {
    return c.is_out() ? c.inflation.end_of(c.phase) : infinity;
}

double next_kink(const Canopy& c) {
    return c.is_out() && c.phase != Phase::open ? c.inflation.next_kink() : infinity;
}

bool is_filling(const Canopy& c) {
    return c.is_out() && (c.phase == Phase::initial || c.phase == Phase::filling);
}

}  // namespace

OpeningSequence::OpeningSequence(const Scene& scene, Alike alike) : scene_(&scene) {
    for (std::size_t k = 0; k < scene.parachutes.size(); ++k) {
        const Parachute& chute = scene.parachutes[k];
        using Kind = std::tuple<int, double, bool>;
        std::map<Kind, int> kinds;  // those of one lag do the same, reefed or not
        for (int i = 0; i < chute.count; ++i)
            ++kinds[{alike == Alike::each ? i : 0,
                     chute.lag.empty() ? 0.0 : chute.lag[static_cast<std::size_t>(i)],
                     i < chute.skips_reefing}];
        for (const auto& [kind, count] : kinds) {
            Canopy c;
            c.chute = &chute;
            c.index = k;
            c.count = count;
            c.steady_radius = steady_radius(chute);
            c.porosity = chute.geometric_porosity;
            if (chute.filling.is_predicted())
                c.filling = std::make_shared<const FillingCanopy>(filling_canopy(chute));
            std::tie(std::ignore, c.lag, c.skips_reefing) = kind;
            if (c.skips_reefing) c.stage = chute.reefing.size();
            all_.push_back(c);
        }
    }
    weigh();
}

OpeningSequence::OpeningSequence(const Parachute& chute, const Inflation& inflation, Phase phase) {
    Canopy c;
    c.chute = &chute;
    c.state = Canopy::State::open;
    c.stage = chute.reefing.size();
    c.phase = phase;
    c.inflation = inflation;
    c.steady_radius = steady_radius(chute);
    c.porosity = chute.geometric_porosity;
    all_.push_back(c);
    weigh();
}

double drag_distance(const Parachute& chute) {
    const double radius = steady_radius(chute), line = chute.line_length;
    return chute.riser_length + std::sqrt(std::max(0.0, line * line - radius * radius)) + radius / 1.5;
}

void OpeningSequence::weigh() {
    out_mass_ = packed_mass_ = distance_ = 0.0;
    double largest = 0.0;
    for (const Canopy& c : all_) {
        if (c.state == Canopy::State::open) {
            out_mass_ += c.count * c.chute->mass;
            if (c.inflation.steady_drag_area > largest) distance_ = drag_distance(*c.chute);
            largest = std::max(largest, c.inflation.steady_drag_area);
        }
        if (c.state == Canopy::State::packed && c.index != leaving_) packed_mass_ += c.count * c.chute->mass;
    }
}

void OpeningSequence::release(const FlightState& now) {
    past_.push_back({Trigger::Kind::release, 0, now.time});
    std::size_t before = all_.size();
    for (std::size_t i = 0; i < all_.size(); ++i) {
        if (all_[i].index == before) continue;  // a cluster leaves one pack
        before = all_[i].index;
        arm({Wait::What::deploy, i, trigger_of(Wait::What::deploy, all_[i])}, now);
    }
    unreported_ = advance(now);
}

const Trigger* OpeningSequence::trigger_of(Wait::What what, const Canopy& c) const {
    static const Trigger at_release{Trigger::Kind::release, 0.0, 0.0};
    switch (what) {
        case Wait::What::deploy:
            return c.chute->deploy_when ? &*c.chute->deploy_when : &at_release;
        case Wait::What::disreef:
            return &c.chute->reefing.at(c.stage).until;
        case Wait::What::cut:
            break;
    }
    return c.chute->cut ? &*c.chute->cut : nullptr;
}

/// Whether an event of a parachute, or of the flight, is the one that is waited for.
bool OpeningSequence::is_about(const Wait& wait, Trigger::Kind kind, std::size_t index) const {
    const Trigger& t = *wait.trigger;
    if (t.kind != kind) return false;
    const bool of_parachute =
        kind == Trigger::Kind::line_stretch || kind == Trigger::Kind::full_open || kind == Trigger::Kind::cut;
    if (!of_parachute) return true;
    return t.of.empty() ? all_[wait.canopy].index == index : scene_->parachutes[index].name == t.of;
}

/// [m], [m/s] or [Pa] until the condition on the flight is met.
double OpeningSequence::left(const Wait& wait, const FlightState& now) const {
    switch (wait.trigger->kind) {
        case Trigger::Kind::altitude:
            return std::max(now.altitude - wait.trigger->value, now.climb);  // not on the way up
        case Trigger::Kind::apogee:
            return now.climb;
        case Trigger::Kind::dynamic_pressure:
            return now.dynamic_pressure() - wait.trigger->value;
        default:
            return infinity;
    }
}

bool OpeningSequence::is_watched(const Wait& wait) const {
    using enum Trigger::Kind;
    const Trigger::Kind kind = wait.trigger->kind;
    return wait.due == infinity && (kind == altitude || kind == apogee || kind == dynamic_pressure);
}

/// Begins to wait; a condition that has been met before counts from now.
void OpeningSequence::arm(Wait wait, const FlightState& now) {
    const Trigger& t = *wait.trigger;
    if (t.kind == Trigger::Kind::time) wait.due = t.value + t.delay;
    for (const Past& p : past_)
        if (is_about(wait, p.kind, p.index) && p.kind != Trigger::Kind::steady_descent)
            wait.due = std::min(wait.due, p.time + t.delay);
    if (wait.due == infinity && left(wait, now) <= 0.0) wait.due = now.time + t.delay;
    wait.due = std::max(wait.due, now.time);
    waits_.push_back(wait);
}

void OpeningSequence::occurred(Trigger::Kind kind, std::size_t index, double time) {
    past_.push_back({kind, index, time});
    for (Wait& wait : waits_)
        if (wait.due == infinity && is_about(wait, kind, index)) wait.due = time + wait.trigger->delay;
}

void OpeningSequence::grown(std::size_t canopy, const FillingMotion& bulb, bool squids, double drag_area) {
    Canopy& c = all_[canopy];
    c.bulb = bulb;
    c.squids = squids;
    if (c.phase == Phase::open)
        c.inflation.steady_drag_area = drag_area;  // of a reefed stage: a result
    else
        c.inflation.eta = std::sqrt(drag_area / c.inflation.steady_drag_area);
}

void OpeningSequence::fills_up(std::size_t canopy, double time, bool held) {
    Canopy& c = all_[canopy];
    c.inflation.filling_time = time - c.inflation.snatch;
    c.held = held;
    if (!held) return;
    c.inflation.steady_drag_area *= c.inflation.eta * c.inflation.eta;
    c.inflation.eta = 1.0;
}

void OpeningSequence::descends_steadily(const FlightState& now) {
    occurred(Trigger::Kind::steady_descent, 0, now.time);
}

double OpeningSequence::next_time() const {
    double next = infinity;
    for (const Canopy& c : all_)
        next = std::min({next, phase_end(c), next_kink(c)});
    for (const Wait& wait : waits_)
        if (!is_blocked(wait)) next = std::min(next, wait.due);
    return next;
}

/// One pack after the other.
bool OpeningSequence::is_blocked(const Wait& wait) const {
    return leaving_ && wait.what == Wait::What::deploy && all_[wait.canopy].chute->deploy.starts_packed();
}

std::vector<double> OpeningSequence::watch(const FlightState& now) const {
    std::vector<double> values;
    for (const Wait& wait : waits_)
        if (is_watched(wait)) values.push_back(left(wait, now));
    return values;
}

void OpeningSequence::met(std::size_t watched, const FlightState& now) {
    for (Wait& wait : waits_)
        if (is_watched(wait) && watched-- == 0) {
            wait.due = now.time + wait.trigger->delay;
            return;
        }
}

std::size_t OpeningSequence::watch_count() const {
    return static_cast<std::size_t>(
        std::ranges::count_if(waits_, [this](const Wait& wait) { return is_watched(wait); }));
}

bool OpeningSequence::watches_pressure() const {
    return std::ranges::any_of(waits_, [this](const Wait& wait) {
        return is_watched(wait) && wait.trigger->kind == Trigger::Kind::dynamic_pressure;
    });
}

bool OpeningSequence::waits_for_steady_descent() const {
    return std::ranges::any_of(waits_, [](const Wait& wait) {
        return wait.due == infinity && wait.trigger->kind == Trigger::Kind::steady_descent;
    });
}

bool OpeningSequence::is_growing(std::size_t parachute) const {
    return std::ranges::any_of(
        all_, [&](const Canopy& c) { return c.index == parachute && is_filling(c) && !c.squids; });
}

bool OpeningSequence::is_quiet() const {
    return std::ranges::none_of(all_, [](const Canopy& c) { return c.is_out() && c.phase != Phase::open; });
}

bool OpeningSequence::is_filled() const {
    const bool all_let_open =
        std::ranges::all_of(waits_, [](const Wait& wait) { return wait.what == Wait::What::cut; });
    return all_let_open && !leaving_ && std::ranges::none_of(all_, is_filling);
}

bool OpeningSequence::is_settled() const {
    if (waits_.empty() || !is_quiet()) return is_quiet();
    // The cut of the only parachute that is out leaves nothing to descend with.
    const std::size_t only = all_[waits_.front().canopy].index;
    return std::ranges::all_of(waits_, [&](const Wait& wait) { return wait.what == Wait::What::cut; }) &&
           std::ranges::all_of(all_, [&](const Canopy& c) { return !c.is_out() || c.index == only; });
}

const Canopy* OpeningSequence::fills_itself() const {
    const auto found =
        std::ranges::find_if(all_, [](const Canopy& c) { return c.filling && is_filling(c) && !c.squids; });
    return found == all_.end() ? nullptr : &*found;
}

bool OpeningSequence::any_waits_to_leave() const {
    return std::ranges::any_of(all_, [](const Canopy& c) { return c.state == Canopy::State::packed; });
}

std::vector<OpeningSequence::Unopened> OpeningSequence::unopened() const {
    std::vector<Unopened> list;
    for (std::size_t i = 0; i < all_.size(); ++i) {
        const Canopy& c = all_[i];
        if (c.state == Canopy::State::packed && leaving_ == c.index)
            list.push_back({i, "it had begun to leave its pack and never came to snatch"});
        for (const Wait& wait : waits_) {
            const bool own = wait.what == Wait::What::deploy
                                 ? all_[wait.canopy].index == c.index && c.state == Canopy::State::packed
                                 : wait.what == Wait::What::disreef && wait.canopy == i;
            if (!own) continue;
            const std::string what = wait.what == Wait::What::deploy
                                         ? "deploy.when"
                                         : fmt::format("reefing.{}.until", c.stage + 1);
            list.push_back({i, fmt::format("{}, {}, was {}", what, trigger_text(*wait.trigger),
                                           wait.due == infinity ? "not met"
                                                                : fmt::format("due at {:.4g} s", wait.due))});
        }
    }
    return list;
}

bool OpeningSequence::is_open() const {
    return std::ranges::none_of(all_, is_filling);
}

bool OpeningSequence::go_by_mach() const {
    return std::ranges::any_of(all_,
                               [](const Canopy& c) { return c.chute->drag_area_mach_table.has_value(); });
}

double OpeningSequence::drag_area(double time, double mach) const {
    double sum = 0.0;
    for (const Canopy& c : all_)
        if (c.is_out()) sum += c.count * drag_area_of(c, time, mach);
    return sum;
}

double OpeningSequence::drag_area_of(const Canopy& c, double time, double mach) {
    const auto& table = c.chute->drag_area_mach_table;
    return drag_area_of(c, time) * (table ? table->factor(mach) : 1.0);
}

std::vector<OpeningEvent> OpeningSequence::advance(const FlightState& now) {
    std::vector<OpeningEvent> done = std::move(unreported_);
    unreported_.clear();
    // Conditions that the flight has met by now.
    for (Wait& wait : waits_)
        if (is_watched(wait) && left(wait, now) <= 0.0) wait.due = now.time + wait.trigger->delay;
    for (Canopy& c : all_)
        while (is_due(next_kink(c), now.time))
            ++c.inflation.piece;
    for (;;) {
        const auto ended =
            std::ranges::find_if(all_, [&](const Canopy& c) { return is_due(phase_end(c), now.time); });
        if (ended != all_.end()) {
            end_phase(*ended, now, done);
            continue;
        }
        const auto met = std::ranges::find_if(
            waits_, [&](const Wait& wait) { return !is_blocked(wait) && is_due(wait.due, now.time); });
        if (met == waits_.end()) break;
        const Wait wait = *met;
        waits_.erase(met);
        act(wait, now, done);
    }
    weigh();
    return done;
}

void OpeningSequence::act(const Wait& wait, const FlightState& now, std::vector<OpeningEvent>& done) {
    Canopy& c = all_[wait.canopy];
    switch (wait.what) {
        case Wait::What::deploy:
            c.waited = now.time - wait.due;
            if (c.chute->deploy.starts_packed())
                leaving_ = c.index;
            else
                open(c.index, now, done);
            return;
        case Wait::What::cut:
            if (!c.is_out()) return;
            c.state = Canopy::State::cut;
            std::erase_if(waits_, [&](const Wait& other) { return other.canopy == wait.canopy; });
            if (std::ranges::none_of(all_,
                                     [&](const Canopy& o) { return o.index == c.index && o.is_out(); })) {
                done.push_back({OpeningEvent::Kind::cut, c.index});
                occurred(Trigger::Kind::cut, c.index, now.time);
            }
            return;
        case Wait::What::disreef: {
            const bool was_full = c.filling && c.phase == Phase::open && !c.held;  // its line held nothing
            ++c.stage;
            c.held = false;
            if (c.phase == Phase::initial) {  // it has not begun to fill: as if that line had not been there
                c.inflation = make_inflation(*scene_, *c.chute, c.inflation.snatch, c.snatch_speed,
                                             c.snatch_density, c.stage);
                c.inflation.initial_time += c.lag;
                c.inflation.filling_time += c.lag;
            } else {
                c.inflation = next_stage(*scene_, *c.chute, c.stage, c.inflation, c.phase, now.time,
                                         now.airspeed, now.density);
                c.phase = Phase::filling;
                if (was_full) c.inflation.filling_time = 0.0;
            }
            if (std::ranges::none_of(all_, [&](const Canopy& o) {
                    return &o != &c && o.index == c.index && !o.skips_reefing && o.stage >= c.stage;
                }))
                done.push_back({OpeningEvent::Kind::disreef, c.index, c.stage});
            if (c.is_reefed())
                arm({Wait::What::disreef, wait.canopy, trigger_of(Wait::What::disreef, c)}, now);
        }
    }
}

void OpeningSequence::end_phase(Canopy& c, const FlightState& now, std::vector<OpeningEvent>& done) {
    const auto others = [&](auto&& is) {  // of its cluster
        return std::ranges::any_of(
            all_, [&](const Canopy& o) { return &o != &c && o.index == c.index && o.is_out() && is(o); });
    };
    if (c.phase == Phase::overshoot) {
        c.phase = Phase::open;
        return;
    }
    if (c.phase == Phase::initial) {
        c.phase = Phase::filling;
        if (!others([](const Canopy& o) { return o.phase != Phase::initial; }))
            done.push_back({OpeningEvent::Kind::filling, c.index, c.stage});
        return;
    }
    c.phase = c.inflation.after(c.phase);
    if (c.is_reefed()) {
        if (!others([&](const Canopy& o) {
                return !o.skips_reefing && o.stage == c.stage && o.phase != Phase::open;
            }))
            done.push_back({OpeningEvent::Kind::reefed_open, c.index, c.stage});
        return own_event(Trigger::Kind::full_open, static_cast<std::size_t>(&c - all_.data()), now.time);
    }
    if (others([](const Canopy& o) { return is_filling(o) || o.is_reefed(); })) return;
    done.push_back({OpeningEvent::Kind::full_open, c.index, c.stage});
    occurred(Trigger::Kind::full_open, c.index, now.time);
}

/// A reefing line's "line-stretch" and "full-open" are those of its own canopy.
void OpeningSequence::own_event(Trigger::Kind kind, std::size_t canopy, double time) {
    for (Wait& wait : waits_)
        if (wait.what == Wait::What::disreef && wait.canopy == canopy && wait.trigger->of.empty() &&
            wait.trigger->kind == kind && wait.due == infinity)
            wait.due = time + wait.trigger->delay;
}

void OpeningSequence::open_canopy(std::size_t canopy, const FlightState& now) {
    Canopy& c = all_[canopy];
    const bool is_open = c.chute->deploy.by == DeployBy::inflated;
    c.state = Canopy::State::open;
    c.snatch_speed = now.airspeed;
    c.snatch_density = now.density;
    c.inflation = is_open ? inflated(*c.chute)
                          : make_inflation(*scene_, *c.chute, now.time, now.airspeed, now.density, c.stage);
    c.inflation.initial_time += c.lag;
    c.inflation.filling_time += c.lag;
    c.phase = is_open ? Phase::open : c.inflation.initial_time > 0.0 ? Phase::initial : Phase::filling;
    if (c.is_reefed()) arm({Wait::What::disreef, canopy, trigger_of(Wait::What::disreef, c)}, now);
    if (c.chute->cut) arm({Wait::What::cut, canopy, trigger_of(Wait::What::cut, c)}, now);
    own_event(Trigger::Kind::line_stretch, canopy, now.time);
}

void OpeningSequence::open(std::size_t index, const FlightState& now, std::vector<OpeningEvent>& done) {
    done.push_back({OpeningEvent::Kind::snatch, index});
    occurred(Trigger::Kind::line_stretch, index, now.time);
    const bool is_open = scene_->parachutes[index].deploy.by == DeployBy::inflated;
    bool fills_at_once = false;
    for (std::size_t i = 0; i < all_.size(); ++i) {
        if (all_[i].index != index) continue;
        open_canopy(i, now);
        fills_at_once |= all_[i].phase == Phase::filling;
    }
    if (fills_at_once) done.push_back({OpeningEvent::Kind::filling, index});
    if (is_open) {
        done.push_back({OpeningEvent::Kind::full_open, index});
        occurred(Trigger::Kind::full_open, index, now.time);
    }
    weigh();
}

void OpeningSequence::snatched(std::size_t index, const FlightState& now) {
    leaving_.reset();
    open(index, now, unreported_);
}

void OpeningSequence::canopy_snatched(std::size_t canopy, const FlightState& now) {
    const std::size_t index = all_[canopy].index;
    const auto of_parachute = [&](auto&& is) {
        return std::ranges::any_of(all_, [&](const Canopy& c) { return c.index == index && is(c); });
    };
    const bool none_fills = !of_parachute([](const Canopy& c) { return c.phase != Phase::initial; });
    open_canopy(canopy, now);
    if (!of_parachute([](const Canopy& c) { return c.state == Canopy::State::packed; })) {
        leaving_.reset();
        unreported_.push_back({OpeningEvent::Kind::snatch, index});
        occurred(Trigger::Kind::line_stretch, index, now.time);
    }
    if (none_fills && all_[canopy].phase == Phase::filling)
        unreported_.push_back({OpeningEvent::Kind::filling, index});
    weigh();
}

void OpeningSequence::serialize(Archive& archive) {
    for (Canopy& c : all_) {
        archive.choice("canopy", c.state, Canopy::State::cut);
        archive.whole("stage", c.stage, 0, c.chute->reefing.size());
        archive.choice("phase", c.phase, Phase::open);
        twinchute::serialize(archive, c.inflation, c.chute->drag_area_law,
                             c.chute->drag_area_table ? &*c.chute->drag_area_table : nullptr);
        archive.number("snatch speed", c.snatch_speed);
        archive.number("snatch density", c.snatch_density);
        archive.number("waited", c.waited);
        archive.flag("held", c.held);
    }
    const std::size_t max_waits = 8 * all_.size() + 8;
    archive.length("waits", waits_, max_waits);
    for (Wait& wait : waits_) {
        archive.choice("waits for", wait.what, Wait::What::cut);
        archive.whole("canopy", wait.canopy, 0, all_.size() - 1);
        archive.number("due", wait.due);
        if (!archive.reads()) continue;
        const Canopy& c = all_[wait.canopy];
        const bool has_none =
            wait.what == Wait::What::disreef ? !c.is_reefed() : wait.what == Wait::What::cut && !c.chute->cut;
        if (has_none) archive.refuse("holds what no run writes", "something waits for nothing");
        wait.trigger = trigger_of(wait.what, c);
    }
    archive.length("past", past_, 1'000'000);
    for (Past& past : past_) {
        archive.choice("happened", past.kind, Trigger::Kind::cut);
        archive.whole("parachute", past.index, 0, all_.size());
        archive.number("at", past.time);
    }
    archive.length("unreported", unreported_, max_waits);
    for (OpeningEvent& what : unreported_) {
        archive.choice("occurred", what.kind, OpeningEvent::Kind::cut);
        archive.whole("parachute", what.index, 0, all_.size());
        archive.whole("stage", what.stage);
    }
    bool leaves = leaving_.has_value();
    std::size_t leaving = leaving_.value_or(0);
    archive.flag("leaves its pack", leaves);
    archive.whole("parachute", leaving, 0, all_.size());
    leaving_.reset();
    if (leaves) leaving_ = leaving;
    weigh();
}

}  // namespace twinchute
