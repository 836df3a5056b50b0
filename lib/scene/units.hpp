// From "152.4 kg" to 152.4: the only place where a unit is ever read.
#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace twinchute {

/// A text that is not a quantity of the wanted kind. what() reads "problem (why), suggestion".
class UnitError : public std::runtime_error {
public:
    UnitError(std::string problem, std::string why, std::string suggestion);

    const std::string& problem() const { return problem_; }
    const std::string& why() const { return why_; }
    const std::string& suggestion() const { return suggestion_; }

private:
    std::string problem_, why_, suggestion_;
};

/// Converts a number followed by a unit, e.g. to_si("30 ft/s", "m/s") = 9.144.
///
/// `si_unit` is the unit of the result as in the table of keys: "kg", "m/s", "rad", "1", ...
/// The number is read by std::from_chars whatever the locale, only the rest by UDUNITS-2, whose
/// database is loaded on the first call that meets a unit. Angles and plain ratios are kept apart
/// although both are dimensionless; a dimensionless quantity may be written without a unit or in
/// per cent. Units with an offset (degC) are refused: whether a temperature or a difference is
/// meant cannot be seen from the text. Safe to call from several threads.
///
/// Throws UnitError: no number, no or an unknown unit, another dimension, not finite.
double to_si(std::string_view text, std::string_view si_unit);

/// A unit that engineers type and UDUNITS-2 lacks or reads as something else.
struct UnitAlias {
    std::string_view name;
    std::string_view definition;  ///< in units that UDUNITS-2 reads as engineers do
    std::string_view why;
};

std::span<const UnitAlias> unit_aliases();

/// A unit that is converted without the database, to the bits of it.
struct CommonUnit {
    std::string_view name, si_unit;  ///< as in a scene, and of the table of keys
    double factor;
};

std::span<const CommonUnit> common_units();

/// A blank or a tab.
bool is_space(char c);
/// The text without blanks and tabs at its ends.
std::string_view trimmed(std::string_view text);

/// Whether an amount is a share: "10 %", "10 Percent ".
bool is_share(std::string_view text);

/// True once the database of UDUNITS-2 is in memory (it takes milliseconds to load).
bool units_loaded();

}  // namespace twinchute
