#include "lib/record/metrics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <mutex>

namespace twinchute {
namespace {

struct Suffix {
    std::string_view suffix, unit;
};

// Longer ones first: "_N_s" also ends in "_s".
constexpr std::array suffixes{
    Suffix{"_m_s", "m/s"}, Suffix{"_N_s", "N s"}, Suffix{"_N_m", "N/m"}, Suffix{"_N", "N"}, Suffix{"_s", "s"},
    Suffix{"_m", "m"},     Suffix{"_g", "g"},     Suffix{"_m2", "m^2"},  Suffix{"_J", "J"},
};

constexpr MetricKey split(std::string_view key) {
    for (const auto& [suffix, unit] : suffixes)
        if (key.size() > suffix.size() && key.ends_with(suffix))
            return {key.substr(0, key.size() - suffix.size()), unit};
    return {key, {}};
}

// Judged by default are the three that size a system: how long it takes, how hard it pulls, how fast
// it lands. 10 % is the scatter between repeated drops that the field accepts; whoever knows better says so.
constexpr Tolerance ten_percent{0.10, true};
constexpr std::optional<Tolerance> none;

/// The key says name and unit.
constexpr MetricRow number(std::string_view key, std::string_view title,
                           std::optional<Tolerance> tolerance = none, Show show = Show::always) {
    return {split(key).name, key, split(key).unit, title, tolerance, show};
}

// clang-format off
constexpr std::array rows{
    number("line_stretch_time_s", "Line stretch"),
    number("snatch_time_s", "Snatch"),
    number("payload_snatch_speed_m_s", "Payload's speed at snatch", none, Show::when_judged),
    number("snatch_force_N", "Snatch force"),
    number("snatch_speed_m_s", "Snatch speed"),
    number("filling_time_s", "Filling time", ten_percent),
    number("fill_constant", "Fill constant n = t_f v_s/D0", none, Show::when_judged),
    number("initial_mouth_ratio", "Initial mouth ratio", none, Show::when_judged),
    number("time_to_15_percent_drag_area_s", "15 % of the drag area", none, Show::when_judged),
    number("time_to_70_percent_drag_area_s", "70 % of the drag area", none, Show::when_judged),
    number("time_to_98_percent_drag_area_s", "98 % of the drag area", none, Show::when_judged),
    number("peak_force_N", "Peak opening force", ten_percent),
    number("peak_canopy_force_N", "Peak force of one canopy"),
    number("stage_1_peak_force_N", "Peak opening force, stage 1"),
    number("stage_2_peak_force_N", "Peak opening force, stage 2"),
    number("stage_3_peak_force_N", "Peak opening force, stage 3"),
    number("stage_4_peak_force_N", "Peak opening force, stage 4"),
    number("stage_1_drag_area_m2", "Drag area, reefed stage 1"),
    number("stage_2_drag_area_m2", "Drag area, reefed stage 2"),
    number("stage_3_drag_area_m2", "Drag area, reefed stage 3"),
    number("stage_1_descent_rate_m_s", "Descent rate, reefed stage 1"),
    number("stage_2_descent_rate_m_s", "Descent rate, reefed stage 2"),
    number("stage_3_descent_rate_m_s", "Descent rate, reefed stage 3"),
    number("time_to_peak_force_s", "Time to peak force"),
    number("peak_force_ratio", "Peak force ratio X_p"),
    number("opening_shock_coefficient", "Opening shock coefficient"),
    number("load_factor", "Load factor"),
    number("max_deceleration_g", "Maximum deceleration"),
    number("impulse_N_s", "Impulse"),
    number("descent_rate_m_s", "Descent rate", ten_percent),
    number("descent_rate_amplitude", "Amplitude of the descent rate", none, Show::when_judged),
    number("descent_rate_remaining_change", "Change of the descent rate that remains", none, Show::when_judged),
    number("altitude_loss_m", "Altitude loss"),
    number("projected_diameter_ratio", "Projected diameter ratio D_p/D0"),
    number("mass_ratio", "Mass ratio"),
    number("froude_number", "Froude number"),
    number("operational_froude_number", "Operational Froude number", none, Show::when_judged),
    number("peak_force_raw_N", "Peak opening force, unfiltered", none, Show::when_judged),
    number("max_force_N", "Maximum force"),
    number("max_canopy_force_N", "Maximum force of one canopy", none, Show::when_judged),
    number("unopened_parachutes", "Parachutes that never opened"),
    number("descent_altitude_m", "Altitude of steady descent", none, Show::when_judged),
    number("flight_time_s", "Flight time"),
    number("landing_vertical_speed_m_s", "Vertical landing speed"),
    number("landing_energy_J", "Landing energy of the payload"),
    number("drift_m", "Drift"),
    number("landing_east_m", "Landing point, east"),
    number("landing_north_m", "Landing point, north"),
    number("max_altitude_m", "Highest altitude", none, Show::when_judged),
    number("max_mach_number", "Highest Mach number", none, Show::when_judged),
    number("snatch_mach_number", "Mach number at snatch", none, Show::when_judged),
    number("max_line_reynolds_number", "Highest Reynolds number of a line", none, Show::when_judged),
    number("seam_diameter_ratio", "Seam diameter ratio", none, Show::when_judged),
    number("canopy_depth_ratio", "Canopy depth ratio h/D_p", none, Show::when_judged),
    number("signed_area_ratio", "Signed area ratio", none, Show::when_judged),
    number("max_canopy_contact_force_N", "Maximum contact force between canopies", none, Show::when_judged),
    number("max_canopy_contact_depth_m", "Deepest contact between canopies", none, Show::when_judged),
    number("max_line_tension_N", "Maximum line tension"),
    number("line_strength_margin", "Margin to the lines' strength"),
    number("max_radial_tape_tension_N", "Maximum tension of a radial tape", none, Show::when_judged),
    number("max_skirt_band_tension_N", "Maximum tension of the skirt band", none, Show::when_judged),
    number("max_vent_band_tension_N", "Maximum tension of the vent band", none, Show::when_judged),
    number("max_vent_line_tension_N", "Maximum tension of a vent line", none, Show::when_judged),
    number("max_reefing_line_tension_N", "Maximum tension of the reefing line"),
    number("cord_strength_margin", "Margin to the strength of tapes, bands, vent and reefing lines"),
    number("max_sling_tension_N", "Maximum sling tension"),
    number("max_membrane_stress_N_m", "Maximum membrane stress"),
    number("membrane_strength_margin", "Margin to the fabric's strength"),
    number("membrane_stress_p90_N_m", "Membrane stress, 90th percentile"),
    number("membrane_strength_margin_p90", "Margin to the fabric's strength, 90th percentile"),
    MetricRow{"force_history", "force", "N", "Opening force"},
    MetricRow{"speed_history", "speed", "m/s", "Speed of the payload"},
    MetricRow{"acceleration_history", "acceleration", "m/s^2", "Acceleration of the payload"},
    MetricRow{"drag_area_history", "drag_area", "m^2", "Drag area"},
    MetricRow{"projected_area_history", "projected_area", "m^2", "Projected area"},
    MetricRow{"canopy_volume_history", "canopy_volume", "m^3", "Volume of the canopy"},
    MetricRow{"mouth_area_history", "mouth_area", "m^2", "Area of the mouth"},
    MetricRow{"inflow_ratio_history", "inflow_ratio", "", "Inflow over airspeed at the mouth"},
    MetricRow{"payload_tilt_history", "payload_tilt", "rad", "Tilt of the payload"},
};
// clang-format on

constexpr auto numbers = std::ranges::find_if(rows, &MetricRow::is_history) - rows.begin();

const MetricRow* find_row(std::span<const MetricRow> among, std::string_view name) {
    const auto row = std::ranges::find(among, name, &MetricRow::name);
    return row == among.end() ? nullptr : &*row;
}

/// Row of which `name` is that of one parachute: with the longest name, so that "main_stage_1_peak_force" is
/// stage_1_peak_force of "main".
const MetricRow* row_of_any(std::string_view name) {
    const MetricRow* longest = nullptr;
    for (const MetricRow& row : std::span(rows).first(numbers)) {
        const std::size_t size = row.name.size();
        if (name.size() < size + 2 || !name.ends_with(row.name) || name[name.size() - size - 1] != '_')
            continue;
        if (!longest || size > longest->name.size()) longest = &row;
    }
    return longest;
}

/// Row of one parachute's metric; made once, and there from then on.
const MetricRow* row_of_one(std::string_view name) {
    struct Made {
        std::string name, key, title;
        MetricRow row;
    };
    static std::map<std::string, std::unique_ptr<Made>, std::less<>> made;
    static std::mutex mutex;
    const MetricRow* of_any = row_of_any(name);
    if (!of_any) return nullptr;
    const std::scoped_lock lock(mutex);
    auto found = made.find(name);
    if (found == made.end()) {
        const std::string head(name.substr(0, name.size() - of_any->name.size()));
        auto one = std::make_unique<Made>();
        one->name = name;
        one->key = head + std::string(of_any->key);
        one->title = fmt::format("{}: {}", head.substr(0, head.size() - 1), of_any->title);
        one->row = {one->name, one->key, of_any->unit, one->title, of_any->tolerance, of_any->show};
        found = made.emplace(std::string(name), std::move(one)).first;
    }
    return &found->second->row;
}

}  // namespace

std::string metric_head(std::string name) {
    for (char& c : name)
        c = c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c == '-' ? '_' : c;
    return name.empty() ? name : name + "_";
}

std::string_view head_of_judgeable(std::string_view name) {
    if (find_row(judgeable_rows(), name)) return {};
    const MetricRow* of_any = row_of_any(name);
    return of_any ? name.substr(0, name.size() - of_any->name.size()) : std::string_view{};
}

std::string_view MetricRow::tolerance_unit() const {
    if (is_history() || unit.empty()) return "1";
    return unit == "g" ? "g0" : unit;
}

std::span<const MetricRow> judgeable_rows() {
    return rows;
}

std::span<const MetricRow> metric_rows() {
    return judgeable_rows().first(numbers);
}

std::span<const MetricRow> history_rows() {
    return judgeable_rows().subspan(numbers);
}

const MetricRow* find_judgeable_row(std::string_view name) {
    const MetricRow* row = find_row(judgeable_rows(), name);
    return row ? row : row_of_one(name);
}

const MetricRow* find_metric_row(std::string_view name) {
    const MetricRow* row = find_judgeable_row(name);
    return row && !row->is_history() ? row : nullptr;
}

std::string tolerance_text(const Tolerance& tolerance, std::string_view unit) {
    if (tolerance.relative) return fmt::format("{:.6g} %", 100 * tolerance.value);
    return fmt::format("{:.6g}{}{}", tolerance.value, unit.empty() ? "" : " ", unit);
}

bool is_extreme(std::string_view key) {
    const std::string_view whole = split(key).name;
    const std::string_view name = whole.substr(head_of_judgeable(whole).size());
    return name.starts_with("max_") || name.ends_with("_strength_margin") || name.ends_with("_p90") ||
           name == "load_factor";
}

MetricKey split_metric_key(std::string_view key) {
    return split(key);
}

std::string metric_words(std::string_view key) {
    std::string words(split(key).name);
    std::ranges::replace(words, '_', ' ');
    return words;
}

}  // namespace twinchute
