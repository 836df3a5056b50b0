// Units in which numbers are shown to people. Files for machines (JSON, CSV, the fields) are SI whatever is
// chosen here, and so are scenes and all that is computed.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace twinchute {

enum class DisplayUnits { si, us };

/// Chosen once for the whole process, before anything is shown; SI at first.
void choose_display_units(DisplayUnits units);
DisplayUnits display_units();

/// An SI unit, and the US customary one in its place: value in US units = factor x value in SI. Quantities
/// with a zero of their own, such as temperatures on a scale, are not among them: none is shown.
struct UnitPair {
    std::string_view si, us;
    double factor;
};
/// Definitions: international foot 0.3048 m, pound 0.45359237 kg, and pound-force of standard gravity
/// 9.80665 m/s^2 (NIST SP 811, 2008, B.8).
std::span<const UnitPair> unit_pairs();

/// A number with its unit, as it is shown; units that have no US one, such as "s" and "g", stay.
struct Shown {
    double value;
    std::string_view unit;
};
Shown shown(double value, std::string_view si_unit);

/// Factor by which a number of that unit is multiplied to be shown, and the unit it then has.
double shown_factor(std::string_view si_unit);
std::string_view shown_unit(std::string_view si_unit);

/// " ft/s" for what follows a number; nothing where there is no unit.
std::string spaced_unit(std::string_view si_unit);

/// Says that not everything is in US units; empty in SI.
std::string_view units_remark();

}  // namespace twinchute
