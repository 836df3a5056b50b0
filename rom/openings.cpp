#include "rom/openings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace twinchute::rom {
namespace {

/// [-] upward share of the speed from which a payload turns over its canopy at the apogee.
constexpr double steep_climb = 0.5;

const Canopy& canopy_of(const OpeningSequence& sequence, std::size_t index) {
    return *std::ranges::find(sequence.all(), index, &Canopy::index);
}

void keep_larger(std::optional<CanopyPeak>& largest, const CanopyPeak& peak) {
    if (peak.force > 0.0 && (!largest || peak.force > largest->force)) largest = peak;
}

}  // namespace

void Openings::before_stage(const std::vector<OpeningEvent>& done, const FlightState& now) {
    for (const OpeningEvent& what : done)
        note_forces(what, now);
}

void Openings::after_stage(const std::vector<OpeningEvent>& done, double time) {
    for (const OpeningEvent& what : done)
        note_event(what, time);
}

CanopyPeak Openings::take_canopy_peak() {
    const auto [peak, canopy] = context_.observer.take_canopy_peak();
    const Canopy& whose = sequence_.all()[canopy];
    std::string note = fmt::format("{} at t = {:.4g} s", whose.chute->name, peak.at);
    if (whose.chute->count > whose.count)
        note = fmt::format("{} of {} {}, lag {:g} s{}, at t = {:.4g} s", whose.count, whose.chute->count,
                           whose.chute->name, whose.lag, whose.skips_reefing ? ", not reefed" : "", peak.at);
    return {peak.value, std::move(note)};
}

Maximum Openings::take_peak() {
    const Maximum peak = context_.observer.take_peak();
    result.max_force = std::max(result.max_force, peak.value);
    if (!has_several_canopies(scene_)) return peak;
    canopy_peak_ = take_canopy_peak();
    keep_larger(result.max_canopy_force, canopy_peak_);
    return peak;
}

void Openings::close() {
    const Maximum peak = take_peak();
    if (result.parachutes.empty() || snatches_) return;  // it is of a snatch that has not come to its end
    ParachuteResult& chute = result.parachutes.back();
    if (chute.stages.empty()) {
        chute.snatch_force = peak.value;
        return;
    }
    const bool had_no_time = std::exchange(cut_at_once_, false);
    if (peak.value < 0.0 || had_no_time) return;
    if (has_several_canopies(scene_)) keep_larger(result.peak_canopy_force, canopy_peak_);
    chute.stages.back().peak_force = peak.value;
    chute.stages.back().peak_time = peak.at;
}

/// Another parachute pulls from here on: the peak of one that still fills is not known.
void Openings::close_for_another() {
    close();
    ParachuteResult& before = result.parachutes.back();
    if (!before.stages.empty() && sequence_.is_growing(before.index)) before.stages.back().peak_force.reset();
}

void Openings::lines_taut() {
    if (!result.parachutes.empty()) close_for_another();
    snatches_ = true;
}

void Openings::note_snatch(const OpeningEvent& what, const FlightState& now) {
    const Parachute& chute = scene_.parachutes[what.index];
    const bool packed = chute.deploy.starts_packed();
    snatches_ = false;
    if (!packed && !result.parachutes.empty()) {
        close_for_another();
        ParachuteResult& before = result.parachutes.back();
        if (before.snatch_time == now.time && !before.stages.empty()) before.stages.back().peak_force.reset();
    }
    result.parachutes.push_back({what.index, now.time, now.airspeed, {}, {}});
    if (!packed) result.parachutes.back().stages.push_back({now.time});
    if (chute.deploy.by == DeployBy::inflated) return;
    if (!result.snatched) {
        result.snatched = true;
        result.snatch_time = now.time;
        result.snatch_speed = now.airspeed;
        if (now.airspeed > 0.0)
            result.snatch_path_angle = std::asin(std::clamp(-now.climb / now.airspeed, -1.0, 1.0));
        result.snatch_density = now.density;
        if (!packed) result.payload_snatch_speed = now.airspeed;
    }
    add_opening_warnings(context_.record, scene_, chute, canopy_of(sequence_, what.index).inflation,
                         now.altitude, now.airspeed, now.density);
    if (now.climb > steep_climb * now.airspeed)
        context_.record.warnings.push_back(
            {fmt::format("{} opens while the payload climbs",
                         scene_.parachutes.size() > 1 ? chute.name : "the canopy"),
             "the model keeps it behind the payload: near the apogee lines go slack and the payload "
             "overtakes it",
             "look at the full model, or deploy at the apogee"});
}

/// A stage is full, or the whole canopy.
void Openings::note_full(ParachuteResult& chute, const OpeningEvent& what, double time) {
    if (chute.stages.empty()) return;
    ParachuteResult::Stage& stage = chute.stages.back();
    if (!stage.full) stage.full = time;
    if (what.kind != OpeningEvent::Kind::full_open || scene_.parachutes.size() > 1) return;
    double last = 0.0;  // of those that opened without stages the time itself, not a difference
    bool at_once = true;
    for (const Canopy& c : sequence_.all()) {
        if (c.index != what.index) continue;
        last = std::max(last, c.inflation.filling_time);
        at_once = at_once && c.inflation.snatch == chute.snatch_time;
    }
    if (scene_.parachutes[what.index].deploy.by != DeployBy::inflated)
        result.filling_time = at_once ? last : time - chute.snatch_time;
}

void Openings::note_forces(const OpeningEvent& what, const FlightState& now) {
    if (what.kind == OpeningEvent::Kind::snatch) return note_snatch(what, now);
    const auto found = std::ranges::find(result.parachutes, what.index, &ParachuteResult::index);
    if (found == result.parachutes.end()) return;
    ParachuteResult& chute = *found;
    switch (what.kind) {
        case OpeningEvent::Kind::filling:
            if (!chute.stages.empty()) return;
            chute.snatch_force = take_peak().value;  // from here on the peak counts
            chute.stages.push_back({chute.snatch_time});
            return;
        case OpeningEvent::Kind::disreef:
            if (chute.stages.empty() || what.stage < chute.stages.size()) return;
            if (&chute == &result.parachutes.back()) close();
            chute.stages.push_back({now.time});
            return;
        case OpeningEvent::Kind::reefed_open:
        case OpeningEvent::Kind::full_open:
            return note_full(chute, what, now.time);
        case OpeningEvent::Kind::cut:
            if (&chute == &result.parachutes.back() && !chute.stages.empty() &&
                chute.stages.back().begin == now.time)
                cut_at_once_ = true;
            return;
        case OpeningEvent::Kind::snatch:
            return;
    }
}

void Openings::note_event(const OpeningEvent& what, double time) {
    const Deployment& deploy = scene_.parachutes[what.index].deploy;
    const bool comes_out_open = deploy.by == DeployBy::inflated;
    if (comes_out_open && what.kind != OpeningEvent::Kind::full_open && what.kind != OpeningEvent::Kind::cut)
        return;
    switch (what.kind) {
        case OpeningEvent::Kind::snatch:
            context_.add_event(what.index, deploy.starts_packed() ? "snatch" : "line-stretch");
            if (!sequence_.any_waits_to_leave()) context_.met(Trigger::Kind::line_stretch, time);
            return;
        case OpeningEvent::Kind::filling:
            if (canopy_of(sequence_, what.index).inflation.initial_time > 0.0)
                context_.add_event(what.index, "end-of-initial-phase");
            return;
        case OpeningEvent::Kind::reefed_open:
            context_.add_event(what.index, "reefed-open");
            return;
        case OpeningEvent::Kind::disreef:
            context_.add_event(what.index, "disreef");
            return;
        case OpeningEvent::Kind::full_open:
            context_.add_event(what.index, "full-open");
            if (sequence_.is_filled()) context_.met(Trigger::Kind::full_open, time);
            return;
        case OpeningEvent::Kind::cut:
            context_.add_event(what.index, "cut");
    }
}

RunStatus Openings::check() const {
    for (const Canopy& c : sequence_.all()) {
        if (!c.is_out() || c.chute->deploy.by == DeployBy::inflated || c.filling) continue;
        const auto chute = std::ranges::find(result.parachutes, c.index, &ParachuteResult::index);
        const double speed = chute == result.parachutes.end() ? 0.0 : chute->snatch_speed;
        if (const auto refused = refused_opening(c.inflation, speed)) {
            const std::string whose = scene_.parachutes.size() > 1 ? c.chute->name + ": " : "";
            return {refused->code, whose + refused->detail};
        }
    }
    return {};
}

}  // namespace twinchute::rom
