#include "rom/rom_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "lib/models/snatch.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/solve/opening.hpp"
#include "rom/deployment.hpp"

namespace twinchute::rom {
namespace {

/// [-] Nylon cord breaks at about this strain.
constexpr double breaking_strain = 0.3;

}  // namespace

Vec3 place_of(const HistoryRow& row, const Scene& scene, int dimensions) {
    if (dimensions == 3) return {row.east, row.north, row.altitude};
    return row.east * heading_direction(scene.release) + row.altitude * Vec3::UnitZ();
}

bool needs_channels(std::string_view key) {
    constexpr std::array<std::string_view, 5> ends{"_percent_drag_area_s", "_drag_area_m2",
                                                   "_descent_rate_m_s", "_mach_number", "max_altitude_m"};
    return std::ranges::any_of(ends, [&](std::string_view end) { return key.ends_with(end); });
}

void add_channels(RunRecord& record, const std::vector<HistoryRow>& rows, const Scene& scene,
                  int dimensions) {
    const auto channel = [&](const char* name, const char* unit, auto&& value) {
        Channel c{name, unit, {}};
        c.values.reserve(rows.size());
        for (const HistoryRow& r : rows)
            c.values.push_back(value(r));
        record.channels.push_back(std::move(c));
    };
    const auto place = [&](const HistoryRow& r) { return place_of(r, scene, dimensions); };
    channel("time", "s", [](const HistoryRow& r) { return r.time; });
    channel("altitude", "m", [](const HistoryRow& r) { return r.altitude; });
    if (dimensions >= 2) {
        channel("east", "m", [&](const HistoryRow& r) { return place(r).x(); });
        channel("north", "m", [&](const HistoryRow& r) { return place(r).y(); });
    }
    channel("speed", "m/s", [](const HistoryRow& r) { return r.speed; });
    channel("vertical_speed", "m/s", [](const HistoryRow& r) { return r.vertical_speed; });
    channel("acceleration", "m/s^2", [](const HistoryRow& r) { return r.acceleration; });
    channel("force", "N", [](const HistoryRow& r) { return r.force; });
    channel("drag_area", "m^2", [](const HistoryRow& r) { return r.drag_area; });
    channel("dynamic_pressure", "Pa", [](const HistoryRow& r) { return r.dynamic_pressure; });
    if (std::ranges::any_of(rows, [](const HistoryRow& r) { return r.canopies > 1; }))
        channel("canopy_force", "N", [](const HistoryRow& r) { return r.canopy_force; });
    if (scene.aerodynamics.added_mass)
        channel("added_mass", "kg", [](const HistoryRow& r) { return r.added_mass; });
    if (std::ranges::any_of(scene.parachutes, [](const Parachute& p) { return p.filling.is_predicted(); })) {
        channel("canopy_volume", "m^3", [](const HistoryRow& r) { return r.volume; });
        channel("mouth_area", "m^2", [](const HistoryRow& r) { return r.mouth_area; });
        channel("inflow_ratio", "", [](const HistoryRow& r) { return r.inflow; });
    }
    if (std::ranges::any_of(scene.parachutes, [](const Parachute& p) { return p.deploy.starts_packed(); }))
        channel("separation", "m", [](const HistoryRow& r) { return r.separation; });
}

void add_snatch_forms(RunRecord& record, const Scene& scene, const Parachute& chute, double separation_speed,
                      double stretch) {
    if (scene.parachutes.size() == 1) {
        const std::string dv = fmt::format("at dv = {:.4g} m/s", separation_speed);
        const double strands = chute.count * chute.gores;
        record.add_metric(
            "snatch_force_mass_spring_N",
            snatch_force_mass_spring(separation_speed, line_stiffness(chute),
                                     reduced_mass(scene.payload.mass, chute.count * chute.mass)),
            MetricKind::result, "closed form dv sqrt(k m_red) " + dv);
        record.add_metric("snatch_force_wave_N",
                          snatch_force_wave(separation_speed, strands * chute.line.axial_stiffness(),
                                            strands * chute.line.linear_density()),
                          MetricKind::result,
                          "closed form dv sqrt(EA mu), the first wave along the lines " + dv);
    }
    if (stretch > breaking_strain)
        record.warnings.push_back({fmt::format("the snatch stretches the lines by {:.0f} %", 100.0 * stretch),
                                   "nylon cord breaks at about 30 %; this model's lines do not break",
                                   "slow the deployment, or give stronger lines"});
}

}  // namespace twinchute::rom
