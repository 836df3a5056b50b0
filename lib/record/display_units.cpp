#include "lib/record/display_units.hpp"

#include <algorithm>
#include <array>

namespace twinchute {
namespace {

DisplayUnits chosen = DisplayUnits::si;

constexpr double foot = 0.3048, pound = 0.45359237, pound_force = pound * 9.80665;

constexpr std::array pairs{
    UnitPair{"m", "ft", 1.0 / foot},
    UnitPair{"m^2", "ft^2", 1.0 / (foot * foot)},
    UnitPair{"m^3", "ft^3", 1.0 / (foot * foot * foot)},
    UnitPair{"m/s", "ft/s", 1.0 / foot},
    UnitPair{"m/s^2", "ft/s^2", 1.0 / foot},
    UnitPair{"kg", "lb", 1.0 / pound},
    UnitPair{"kg/m^3", "lb/ft^3", foot* foot* foot / pound},
    UnitPair{"N", "lbf", 1.0 / pound_force},
    UnitPair{"N s", "lbf s", 1.0 / pound_force},
    UnitPair{"N/m", "lbf/in", foot / 12.0 / pound_force},
    UnitPair{"Pa", "psf", foot* foot / pound_force},
    UnitPair{"J", "ft lbf", 1.0 / (foot * pound_force)},
    UnitPair{"kJ", "ft lbf", 1000.0 / (foot * pound_force)},
};

const UnitPair* pair_of(std::string_view si_unit) {
    if (chosen == DisplayUnits::si) return nullptr;
    const auto pair = std::ranges::find(pairs, si_unit, &UnitPair::si);
    return pair == pairs.end() ? nullptr : &*pair;
}

}  // namespace

void choose_display_units(DisplayUnits units) {
    chosen = units;
}

DisplayUnits display_units() {
    return chosen;
}

std::span<const UnitPair> unit_pairs() {
    return pairs;
}

Shown shown(double value, std::string_view si_unit) {
    return {shown_factor(si_unit) * value, shown_unit(si_unit)};
}

double shown_factor(std::string_view si_unit) {
    const UnitPair* pair = pair_of(si_unit);
    return pair == nullptr ? 1.0 : pair->factor;
}

std::string_view shown_unit(std::string_view si_unit) {
    const UnitPair* pair = pair_of(si_unit);
    return pair == nullptr ? si_unit : pair->us;
}

std::string spaced_unit(std::string_view si_unit) {
    return si_unit.empty() ? std::string() : " " + std::string(shown_unit(si_unit));
}

std::string_view units_remark() {
    return chosen == DisplayUnits::us
               ? "numbers in US customary units; inputs, notes, reasons and warnings in SI, as in the records"
               : "";
}

}  // namespace twinchute
