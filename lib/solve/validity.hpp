// Where the correlations that a run rests on hold, and where the run went beyond them: the same table for
// every fidelity.
#pragma once

#include <span>
#include <string_view>
#include <utility>

#include "lib/record/run_record.hpp"
#include "lib/scene/keys.hpp"
#include "lib/scene/scene.hpp"
#include "lib/solve/opening.hpp"

namespace twinchute {

/// Quantity that the range of a correlation is stated in.
enum class RangedQuantity {
    mach_number,         ///< [-] largest of the air that the payload or the open canopy meets
    snatch_mach_number,  ///< [-] at snatch
    line_reynolds,       ///< [-] largest of a suspension line across that air
    altitude             ///< [m] above sea level, of the payload; its whole range has to be inside
};

/// A row of the table of correlations and where they hold.
struct CorrelationRow {
    std::string_view name;
    RangedQuantity quantity;
    double low, high;  ///< of that quantity, where `range` does not say otherwise
    std::string_view source;
    KeyUser user;       ///< the fidelity that rests on it, or both
    bool of_parachute;  ///< asked for each parachute, while it is out; otherwise once, for all of the flight
    bool (*used)(const Scene&, const Parachute&);
    /// Range that the scene itself brings along; may be null.
    std::pair<double, double> (*range)(const Scene&, const Parachute&) = nullptr;
};

std::span<const CorrelationRow> correlation_rows();

/// Adds the metrics max_mach_number and max_altitude_m, of each parachute snatch_mach_number and, where lines
/// have drag, max_line_reynolds_number, and a warning for each quantity that left the range of a correlation
/// which the scene uses. The record has its channels. Air without a temperature has no Mach number: its
/// metrics are absent, and what is warned of is judged at the temperature of its viscosity.
void add_validity(RunRecord& record, const Scene& scene, const OpeningResult& result);

}  // namespace twinchute
