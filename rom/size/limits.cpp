#include "rom/size/limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/models/atmosphere.hpp"
#include "rom/run_rom.hpp"

namespace twinchute::rom {
namespace {

constexpr std::array<LimitRow, 4> limits_table{{
    {"max_descent_rate", "m/s", "descent rate", &SizeSpec::max_descent_rate, "descent_rate_m_s", 1.0, false},
    {"max_force", "N", "largest force", &SizeSpec::max_force, "max_force_N", 1.0, true},
    {"max_canopy_force", "N", "largest force of a canopy", &SizeSpec::max_canopy_force, "max_canopy_force_N",
     1.0, true, "max_force_N"},  // one canopy at a time: all of it
    {"max_deceleration", "m/s^2", "deceleration", &SizeSpec::max_deceleration, "max_deceleration_g",
     standard_gravity, true},
}};

/// Whether a run came to the forces of an opening, that of the parachute which is sized.
bool has_opened(const Scene& scene, const RunRecord& record) {
    const auto sized = std::ranges::find(scene.parachutes, scene.size->parachute, &Parachute::name);
    const Parachute& chute = sized != scene.parachutes.end() ? *sized : scene.parachutes.front();
    if (chute.deploy.by == DeployBy::inflated) return true;
    const bool one = scene.parachutes.size() == 1;
    if (one && scene.stop.kind == Trigger::Kind::peak_force) return record.metric("peak_force_N").has_value();
    return record.find_event(one ? "full-open" : chute.name + ".full-open") != nullptr;
}

}  // namespace

std::span<const LimitRow> limit_rows() {
    return limits_table;
}

const Met* Judged::binding() const {
    const auto worst = std::ranges::max_element(limits, {}, &Met::share);
    return worst == limits.end() ? nullptr : &*worst;
}

double Judged::loaded() const {
    double share = 0.0;
    for (const Met& met : limits)
        if (met.row->is_load) share = std::max(share, met.share());
    return why_not.empty() && share > 0.0 ? std::min(share, nowhere) : used;
}

Judged judge(const Scene& scene, const std::stop_token& stop) {
    Run run;
    run.stop = stop;
    Judged judged;
    judged.record = run_rom(scene, run);
    const RunStatus& status = judged.record.status;
    for (const LimitRow& row : limits_table) {
        const auto limit = (*scene.size).*row.limit;
        if (!limit) continue;
        auto value = judged.record.metric(row.metric);
        if (!value) value = judged.record.metric(row.alone);
        if (row.is_load && !has_opened(scene, judged.record)) value.reset();
        if (value && std::isfinite(*value))
            judged.limits.push_back({&row, *value * row.to_unit, *limit});
        else
            judged.why_not =
                fmt::format("the run ends before there is a {}: {}",
                            row.is_load ? "canopy that is full, and its largest loads" : row.title,
                            status_name(status.code));
    }
    const bool ran = status.code == StatusCode::completed || status.code == StatusCode::stopped_by_event;
    if (!ran) judged.why_not = fmt::format("{}: {}", status_name(status.code), status.detail);
    const Met* worst = judged.binding();
    judged.used = judged.why_not.empty() && worst ? std::min(worst->share(), nowhere) : nowhere;
    return judged;
}

}  // namespace twinchute::rom
