#include "lib/solve/shortfall.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "lib/scene/trigger.hpp"
#include "lib/solve/opening.hpp"

namespace twinchute {

std::vector<NeverOpened> never_opened(const OpeningSequence& sequence) {
    std::vector<NeverOpened> list;
    for (OpeningSequence::Unopened& one : sequence.unopened()) {
        const Canopy& c = sequence.all()[one.canopy];
        if (!list.empty() && list.back().parachute == c.index)
            list.back().count += c.count;
        else
            list.push_back({c.index, c.count, std::move(one.why)});
    }
    return list;
}

void note_never_opened(RunRecord& record, const Scene& scene, const std::vector<NeverOpened>& unopened,
                       const Reached& reached) {
    RunStatus& status = record.status;
    const bool ended = status.code == StatusCode::completed || status.code == StatusCode::stopped_by_event;
    if (!ended || (!reached.ground && !std::ranges::any_of(unopened, &NeverOpened::in_the_air))) return;
    if (unopened.empty()) {
        if (!reached.full_open)
            record.warnings.push_back({"on the ground before the canopy was full",
                                       "the payload landed while it was still filling",
                                       "open higher, or fill faster"});
        return;
    }
    int count = 0;
    std::string names, why;
    for (const NeverOpened& one : unopened) {
        const Parachute& chute = scene.parachutes[one.parachute];
        const std::string who = one.count < chute.count ? fmt::format("{} of {} canopies of {}", one.count,
                                                                      chute.count, chute.name)
                                                        : chute.name;
        count += one.count;
        names += (names.empty() ? "" : ", ") + who;
        why += fmt::format("; {} never opened ({})", who, one.why);
        record.warnings.push_back({fmt::format("{} never opened", who),
                                   one.why + (one.in_the_air ? "" : " when it was on the ground"),
                                   one.remedy.empty()
                                       ? "check what it waits for, the height that this takes, and stop"
                                       : one.remedy});
    }
    record.add_metric("unopened_parachutes", count, MetricKind::result, names);
    status = {StatusCode::not_opened, status.detail + why};
}

void warn_of_sequence(RunRecord& record, const Scene& scene, const OpeningSequence& sequence) {
    constexpr double at_once = 1e-6;  // [s] round-off of event times
    for (const Canopy& c : sequence.all())
        if (c.waited > at_once)
            record.warnings.push_back(
                {fmt::format("{} left its pack {:.4g} s later than its deploy.when says", c.chute->name,
                             c.waited),
                 "it waited for another to come out of its own: packs leave one after the other here, those "
                 "due at one time in the order of the tables",
                 "do not trust what the two do to each other, or deploy one of them later"});
    for (std::size_t p = 0; p < scene.parachutes.size(); ++p) {
        const bool early = std::ranges::any_of(sequence.all(), [&](const Canopy& c) {
            return c.index == p && c.state == Canopy::State::cut &&
                   (c.phase == Phase::initial || c.phase == Phase::filling || c.is_reefed());
        });
        const Parachute& chute = scene.parachutes[p];
        if (early)
            record.warnings.push_back({fmt::format("{} was cut before it was full", chute.name),
                                       fmt::format("its cut, {}, came while it was still filling or reefed",
                                                   trigger_text(*chute.cut)),
                                       "cut it later, or let it fill faster"});
    }
    if (record.find_event("ground") != nullptr && all_are_cut(record, scene))
        record.warnings.push_back(
            {"the payload landed without a parachute",
             "the last one had been cut: there is no descent rate, and speed and energy "
             "of the landing are those of a payload that falls alone",
             "check parachute.cut, or give another parachute"});
}

void note_missing_metrics(RunRecord& record, const Scene& scene, const Reached& reached) {
    const StatusCode code = record.status.code;
    const bool own_stop = code == StatusCode::completed;
    if (!own_stop && code != StatusCode::stopped_by_event && !failed_to_open(code)) return;
    const bool in_time = own_stop && (reached.full_open || !reached.ground);
    const auto note_missing = [&](const char* key, std::string why, bool not_reached) {
        if (!record.find_metric(key)) record.missing.push_back({key, std::move(why), not_reached});
    };
    const auto before = [&](const char* what) {
        return fmt::format("{} before {}",
                           reached.ground ? "the payload was on the ground" : "the run stopped", what);
    };
    const Parachute& chute = scene.parachutes.front();
    if (scene.parachutes.size() == 1 && chute.deploy.by != DeployBy::inflated) {
        if (reached.full_open && !reached.no_filling_time.empty())
            note_missing("filling_time_s", reached.no_filling_time, own_stop && reached.filling_cut_short);
        else
            note_missing("filling_time_s", before("the canopy was full"), in_time);
    }
    if (reached.filling && !reached.ground && !record.find_metric("peak_force_N"))
        record.warnings.push_back({"no peak force", before("the canopy was full"),
                                   "stop later; the maximum of the force is that until the end of the run"});
    note_missing("peak_force_N", before(reached.filling ? "the canopy was full" : "a canopy began to fill"),
                 in_time);
    note_missing("descent_rate_m_s", before("the descent was steady"), in_time);
    for (const char* key : {"flight_time_s", "landing_vertical_speed_m_s", "landing_energy_J", "drift_m"})
        note_missing(key, "the run stopped before the landing", own_stop);
}

}  // namespace twinchute
