#include "compare/metrics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "compare/histories.hpp"

namespace twinchute::compare {
namespace {

// Judged by default are the three that size a system: how long it takes, how hard it pulls, how fast
// it lands. 10 % is the scatter between repeated drops that the field accepts; whoever knows better says so.
constexpr Tolerance ten_percent{0.10, true};
constexpr std::optional<Tolerance> none;

// clang-format off
constexpr std::array metric_table{
    MetricRow{"line_stretch_time", "line_stretch_time_s", "s", "Line stretch"},
    MetricRow{"snatch_time", "snatch_time_s", "s", "Snatch"},
    MetricRow{"payload_snatch_speed", "payload_snatch_speed_m_s", "m/s", "Payload's speed at snatch", none, Show::when_judged},
    MetricRow{"snatch_force", "snatch_force_N", "N", "Snatch force"},
    MetricRow{"snatch_speed", "snatch_speed_m_s", "m/s", "Snatch speed"},
    MetricRow{"filling_time", "filling_time_s", "s", "Filling time", ten_percent},
    MetricRow{"peak_force", "peak_force_N", "N", "Peak opening force", ten_percent},
    MetricRow{"peak_canopy_force", "peak_canopy_force_N", "N", "Peak force of one canopy"},
    MetricRow{"stage_1_peak_force", "stage_1_peak_force_N", "N", "Peak opening force, stage 1"},
    MetricRow{"stage_2_peak_force", "stage_2_peak_force_N", "N", "Peak opening force, stage 2"},
    MetricRow{"stage_3_peak_force", "stage_3_peak_force_N", "N", "Peak opening force, stage 3"},
    MetricRow{"stage_4_peak_force", "stage_4_peak_force_N", "N", "Peak opening force, stage 4"},
    MetricRow{"time_to_peak_force", "time_to_peak_force_s", "s", "Time to peak force"},
    MetricRow{"peak_force_ratio", "peak_force_ratio", "", "Peak force ratio X_p"},
    MetricRow{"opening_shock_coefficient", "opening_shock_coefficient", "", "Opening shock coefficient"},
    MetricRow{"load_factor", "load_factor", "", "Load factor"},
    MetricRow{"max_deceleration", "max_deceleration_g", "g", "Maximum deceleration"},
    MetricRow{"impulse", "impulse_N_s", "N s", "Impulse"},
    MetricRow{"descent_rate", "descent_rate_m_s", "m/s", "Descent rate", ten_percent},
    MetricRow{"descent_rate_amplitude", "descent_rate_amplitude", "", "Amplitude of the descent rate", none, Show::when_judged},
    MetricRow{"descent_rate_remaining_change", "descent_rate_remaining_change", "", "Change of the descent rate that remains", none, Show::when_judged},
    MetricRow{"altitude_loss", "altitude_loss_m", "m", "Altitude loss"},
    MetricRow{"projected_diameter_ratio", "projected_diameter_ratio", "", "Projected diameter ratio D_p/D0"},
    MetricRow{"mass_ratio", "mass_ratio", "", "Mass ratio"},
    MetricRow{"froude_number", "froude_number", "", "Froude number"},
    MetricRow{"operational_froude_number", "operational_froude_number", "", "Operational Froude number", none, Show::when_judged},
    MetricRow{"peak_force_raw", "peak_force_raw_N", "N", "Peak opening force, unfiltered", none, Show::when_judged},
    MetricRow{"max_force", "max_force_N", "N", "Maximum force", none, Show::when_judged},
    MetricRow{"max_canopy_force", "max_canopy_force_N", "N", "Maximum force of one canopy", none, Show::when_judged},
    MetricRow{"unopened_parachutes", "unopened_parachutes", "", "Parachutes that never opened"},
    MetricRow{"descent_altitude", "descent_altitude_m", "m", "Altitude of steady descent", none, Show::when_judged},
    MetricRow{"flight_time", "flight_time_s", "s", "Flight time"},
    MetricRow{"landing_east", "landing_east_m", "m", "Landing point, east"},
    MetricRow{"landing_north", "landing_north_m", "m", "Landing point, north"},
    MetricRow{"seam_diameter_ratio", "seam_diameter_ratio", "", "Seam diameter ratio", none, Show::when_judged},
    MetricRow{"canopy_depth_ratio", "canopy_depth_ratio", "", "Canopy depth ratio h/D_p", none, Show::when_judged},
    MetricRow{"signed_area_ratio", "signed_area_ratio", "", "Signed area ratio", none, Show::when_judged},
    MetricRow{"max_line_tension", "max_line_tension_N", "N", "Maximum line tension"},
    MetricRow{"line_strength_margin", "line_strength_margin", "", "Margin to the lines' strength"},
    MetricRow{"max_membrane_stress", "max_membrane_stress_N_m", "N/m", "Maximum membrane stress"},
    MetricRow{"membrane_strength_margin", "membrane_strength_margin", "", "Margin to the fabric's strength"},
};
// clang-format on

twinchute::Table metrics_table() {
    twinchute::Table table;
    table.header = {"metric", "unit", "record key", "default tolerance", "meaning"};
    for (const MetricRow& row : metric_table) {
        table.rows.push_back(
            {std::string(row.name), row.unit.empty() ? "1" : std::string(row.unit), std::string(row.key),
             row.tolerance ? tolerance_text(*row.tolerance, row.unit) : "-", std::string(row.title)});
    }
    for (const HistoryRow& row : history_rows())
        table.rows.push_back({std::string(row.name), "1", "-", "-",
                              std::string(row.title) + " over time: relative L2 norm of the difference"});
    return table;
}

}  // namespace

std::span<const MetricRow> metric_rows() {
    return metric_table;
}

const MetricRow* find_metric_row(std::string_view name) {
    const auto row = std::ranges::find(metric_table, name, &MetricRow::name);
    return row == metric_table.end() ? nullptr : &*row;
}

ListTopic metrics_topic() {
    return {"metrics", "what two fidelities are compared in, and the tolerances", metrics_table};
}

std::string tolerance_text(const Tolerance& tolerance, std::string_view unit) {
    if (tolerance.relative) return fmt::format("{:.6g} %", 100 * tolerance.value);
    return fmt::format("{:.6g}{}{}", tolerance.value, unit.empty() ? "" : " ", unit);
}

}  // namespace twinchute::compare
