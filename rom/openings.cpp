#include "rom/openings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace twinchute::rom {
namespace {

const Canopy& canopy_of(const Canopies& canopies, std::size_t index) {
    return *std::ranges::find(canopies.all(), index, &Canopy::index);
}

void keep_larger(std::optional<CanopyPeak>& largest, const CanopyPeak& peak) {
    if (peak.force > 0.0 && (!largest || peak.force > largest->force)) largest = peak;
}

}  // namespace

void Openings::before_stage(const std::vector<Occurrence>& done, const Situation& now) {
    for (const Occurrence& what : done)
        note_forces(what, now);
}

void Openings::after_stage(const std::vector<Occurrence>& done, double time) {
    for (const Occurrence& what : done)
        note_event(what, time);
}

CanopyPeak Openings::take_canopy_peak() {
    const auto [peak, canopy] = context_.observer.take_canopy_peak();
    const Canopy& whose = canopies_.all()[canopy];
    std::string note = fmt::format("{} at t = {:.4g} s", whose.chute->name, peak.at);
    if (whose.chute->count > whose.count)
        note = fmt::format("{} of {} {}, lag {:g} s, at t = {:.4g} s", whose.count, whose.chute->count,
                           whose.chute->name, whose.lag, peak.at);
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
    if (result.parachutes.empty()) return;
    ParachuteResult& chute = result.parachutes.back();
    if (chute.stages.empty()) {
        chute.snatch_force = peak.value;
        return;
    }
    if (peak.value < 0.0) return;
    if (has_several_canopies(scene_)) keep_larger(result.peak_canopy_force, canopy_peak_);
    chute.stages.back().peak_force = peak.value;
    chute.stages.back().peak_time = peak.at;
}

void Openings::lines_taut() {
    if (!result.parachutes.empty()) close();
}

void Openings::note_snatch(const Occurrence& what, const Situation& now) {
    const Parachute& chute = scene_.parachutes[what.index];
    const bool packed = chute.deploy.starts_packed();
    if (!packed && !result.parachutes.empty()) close();
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
    add_opening_warnings(context_.record, scene_, chute, canopy_of(canopies_, what.index).inflation,
                         now.airspeed, now.density);
}

/// A stage is full, or the whole canopy.
void Openings::note_full(ParachuteResult& chute, const Occurrence& what, double time) {
    if (chute.stages.empty()) return;
    ParachuteResult::Stage& stage = chute.stages.back();
    if (!stage.full) stage.full = time;
    if (what.kind != Occurrence::Kind::full_open || scene_.parachutes.size() > 1) return;
    double last = 0.0;  // of those that opened without stages the time itself, not a difference
    for (const Canopy& c : canopies_.all())
        if (c.index == what.index) last = std::max(last, c.inflation.filling_time);
    const bool at_once = canopy_of(canopies_, what.index).inflation.snatch == chute.snatch_time;
    if (scene_.parachutes[what.index].deploy.by != DeployBy::inflated)
        result.filling_time = at_once ? last : time - chute.snatch_time;
}

void Openings::note_forces(const Occurrence& what, const Situation& now) {
    if (what.kind == Occurrence::Kind::snatch) return note_snatch(what, now);
    const auto found = std::ranges::find(result.parachutes, what.index, &ParachuteResult::index);
    if (found == result.parachutes.end()) return;
    ParachuteResult& chute = *found;
    switch (what.kind) {
        case Occurrence::Kind::filling:
            if (!chute.stages.empty()) return;
            chute.snatch_force = take_peak().value;  // from here on the peak counts
            chute.stages.push_back({chute.snatch_time});
            return;
        case Occurrence::Kind::disreef:
            if (chute.stages.empty() || what.stage < chute.stages.size()) return;
            if (&chute == &result.parachutes.back()) close();
            chute.stages.push_back({now.time});
            return;
        case Occurrence::Kind::reefed_open:
        case Occurrence::Kind::full_open:
            return note_full(chute, what, now.time);
        case Occurrence::Kind::snatch:
        case Occurrence::Kind::cut:
            return;
    }
}

void Openings::note_event(const Occurrence& what, double time) {
    const Deployment& deploy = scene_.parachutes[what.index].deploy;
    if (deploy.by == DeployBy::inflated && what.kind != Occurrence::Kind::cut) return;
    switch (what.kind) {
        case Occurrence::Kind::snatch:
            context_.add_event(what.index, deploy.starts_packed() ? "snatch" : "line-stretch");
            if (!canopies_.any_waits_to_leave()) context_.met(Trigger::Kind::line_stretch, time);
            return;
        case Occurrence::Kind::filling:
            if (canopy_of(canopies_, what.index).inflation.initial_time > 0.0)
                context_.add_event(what.index, "end-of-initial-phase");
            return;
        case Occurrence::Kind::reefed_open:
            context_.add_event(what.index, "reefed-open");
            return;
        case Occurrence::Kind::disreef:
            context_.add_event(what.index, "disreef");
            return;
        case Occurrence::Kind::full_open:
            context_.add_event(what.index, "full-open");
            if (canopies_.is_filled()) context_.met(Trigger::Kind::full_open, time);
            return;
        case Occurrence::Kind::cut:
            context_.add_event(what.index, "cut");
    }
}

RunStatus Openings::check() const {
    for (const Canopy& c : canopies_.all()) {
        if (!c.is_out() || c.chute->deploy.by == DeployBy::inflated) continue;
        const Inflation& inflation = c.inflation;
        if (std::isfinite(inflation.filling_time) && inflation.initial_time < inflation.filling_time)
            continue;
        const std::string whose = scene_.parachutes.size() > 1 ? c.chute->name + ": " : "";
        return {
            StatusCode::refused,
            fmt::format("{}at snatch the initial phase is not shorter than the filling time (t_s = {:.4g} s, "
                        "t_i = {:.4g} s, t_f = {:.4g} s), shorten parachute.initial_phase or lengthen "
                        "fill_time",
                        whose, inflation.snatch, inflation.initial_time, inflation.filling_time)};
    }
    return {};
}

}  // namespace twinchute::rom
