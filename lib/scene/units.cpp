#include "lib/scene/units.hpp"

#include <fmt/format.h>
#include <locale.h>
#include <udunits2.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <utility>

namespace twinchute {
namespace {

constexpr std::array<UnitAlias, 12> aliases{{
    {"deg", "0.017453292519943295 rad", "UDUNITS-2 has only arc_degree and degree"},
    {"oz", "0.0625 lb", "UDUNITS-2 reads the US fluid ounce, a volume"},
    {"lbm", "lb", "pound mass, unknown to UDUNITS-2"},
    {"lbs", "lb", "plural of lb, unknown to UDUNITS-2"},
    {"mph", "mile/hour", "UDUNITS-2 reads milliphot, an illuminance"},
    {"kph", "km/hour", "UDUNITS-2 reads kilophot, an illuminance"},
    {"psf", "lbf/ft2", "pound per square foot, unknown to UDUNITS-2"},
    {"fps", "ft/s", "foot per second, unknown to UDUNITS-2"},
    {"cfm", "ft3/min", "cubic foot per minute, unknown to UDUNITS-2"},
    {"nmi", "nautical_mile", "UDUNITS-2 reads nano-mile"},
    {"slug", "lbf s2/ft", "UDUNITS-2 has it to six digits only"},
    {"g0", "standard_free_fall", "UDUNITS-2 reads gram to the power 0, which is 1"},
}};

// Most scenes need no others, and the database takes longer to read than such a scene to run.
constexpr std::array<CommonUnit, 32> common{{
    {"deg", "rad", 0.017453292519943295},
    {"%", "1", 0.01},
    {"ms", "s", 0.001},
    {"min", "s", 60.0},
    {"s-1", "1/s", 1.0},
    {"Hz", "1/s", 1.0},
    {"mm", "m", 0.001},
    {"cm", "m", 0.01},
    {"km", "m", 1000.0},
    {"in", "m", 2.54 * 0.01},  // as the database multiplies it
    {"ft", "m", 0.3048},
    {"m2", "m^2", 1.0},
    {"cm^2", "m^2", 0.0001},
    {"ft^2", "m^2", 0.09290304},
    {"g", "kg", 0.001},
    {"t", "kg", 1000.0},
    {"oz", "kg", 0.028349523125},
    {"lb", "kg", 0.45359237},
    {"lbm", "kg", 0.45359237},
    {"kN", "N", 1000.0},
    {"lbf", "N", 4.4482216152605},
    {"km/h", "m/s", 1000.0 / 3600.0},
    {"ft/s", "m/s", 0.3048},
    {"fps", "m/s", 0.3048},
    {"mph", "m/s", 0.44704},
    {"g0", "m/s^2", 9.80665},
    {"m/s2", "m/s^2", 1.0},
    {"kPa", "Pa", 1000.0},
    {"MPa", "Pa", 1e6},
    {"GPa", "Pa", 1e9},
    {"kg/m3", "kg/m^3", 1.0},
    {"g/m^2", "kg/m^2", 0.001},
}};

std::atomic<bool> loaded = false;

struct FreeUnit {
    void operator()(ut_unit* unit) const { ut_free(unit); }
};
using UnitPtr = std::unique_ptr<ut_unit, FreeUnit>;

struct FreeConverter {
    void operator()(cv_converter* converter) const { cv_free(converter); }
};
using ConverterPtr = std::unique_ptr<cv_converter, FreeConverter>;

/// UDUNITS-2 reads numbers with strtod and sscanf, which follow LC_NUMERIC: this thread speaks
/// the C locale while one of these lives, whatever the process has set.
class PlainLocale {
public:
    PlainLocale() : plain_(newlocale(LC_ALL_MASK, "C", nullptr)), before_(uselocale(plain_)) {}
    ~PlainLocale() {
        uselocale(before_);
        if (plain_) freelocale(plain_);
    }
    PlainLocale(const PlainLocale&) = delete;
    PlainLocale& operator=(const PlainLocale&) = delete;

private:
    locale_t plain_, before_;
};

/// The database with our aliases in it.
class Database {
public:
    Database() {
        ut_set_error_message_handler(ut_ignore);
        system_ = ut_read_xml(nullptr);
        if (!system_) {
            const char* path = std::getenv("UDUNITS2_XML_PATH");
            throw UnitError("the unit database of UDUNITS-2 cannot be read",
                            path ? fmt::format("UDUNITS2_XML_PATH is '{}'", path) : "default path",
                            "install the package udunits (Debian: libudunits2-data)");
        }
        for (const UnitAlias& row : aliases) {
            // Unmapped first: mapping a name that already has a meaning would be refused.
            const std::string name(row.name);
            ut_unmap_name_to_unit(system_, name.c_str(), UT_ASCII);
            ut_unmap_symbol_to_unit(system_, name.c_str(), UT_ASCII);
            const UnitPtr unit = parse(std::string(row.definition));
            if (!unit || ut_map_symbol_to_unit(name.c_str(), UT_ASCII, unit.get()) != UT_SUCCESS)
                throw UnitError(fmt::format("the unit '{}' cannot be defined", name),
                                "the database of UDUNITS-2 is not the one expected",
                                "unset UDUNITS2_XML_PATH");
        }
        loaded = true;
    }
    ~Database() { ut_free_system(system_); }
    Database(const Database&) = delete;
    Database& operator=(const Database&) = delete;

    UnitPtr parse(const std::string& text) const { return UnitPtr(ut_parse(system_, text.c_str(), UT_UTF8)); }

private:
    ut_system* system_ = nullptr;
};

/// Loaded on first use; an attempt that throws is made again next time.
const Database& database() {
    static const Database instance;
    return instance;
}

/// The unit in base units, e.g. "0.3048 m.s-1".
std::string definition(const ut_unit* unit) {
    std::array<char, 256> buffer{};
    const int length = ut_format(unit, buffer.data(), buffer.size() - 1, UT_ASCII | UT_DEFINITION);
    return length > 0 ? std::string(buffer.data()) : std::string();
}

/// Dimension of a unit in words of a message.
std::string kind_of(const ut_unit* unit) {
    const std::string text = definition(unit);
    return text.ends_with(" 1") || text == "1" ? "a plain ratio" : text;
}

/// The power of rad in a unit. UDUNITS-2 takes rad for 1, so that it would convert "5 deg" to a
/// ratio and "60 rpm" to 1/s without a word.
int angle_power(const ut_unit* unit) {
    const std::string text = definition(unit);
    const auto at = text.find("rad");
    if (at == std::string::npos) return 0;
    int power = 1;
    std::from_chars(text.data() + at + 3, text.data() + text.size(), power);
    return power;
}

bool is_letter(char c) {
    return (c | 32) >= 'a' && (c | 32) <= 'z';
}
bool is_digit(char c) {
    return c >= '0' && c <= '9';
}
/// The first thing in a unit that is more than a unit, or nothing. UDUNITS-2 reads factors
/// ("m 3" is 3 m), shifts ("m @ 5"), times and logarithms; in a scene each would be a slip.
std::string_view foreign_part(std::string_view unit) {
    for (std::size_t i = 0; i < unit.size(); ++i) {
        const char c = unit[i];
        if (is_digit(c)) {
            std::size_t end = i;
            while (end < unit.size() && is_digit(unit[end]))
                ++end;
            std::size_t first = i;  // of the exponent, sign included
            if (first > 0 && unit[first - 1] == '-') --first;
            const char before = first > 0 ? unit[first - 1] : ' ';
            const bool exponent = is_letter(before) || before == '^' || before == ')';
            const std::string_view rest = trimmed(unit.substr(end));
            const bool zero = unit.find_first_not_of('0', i) >= end;  // "g^0" would be 1
            const bool one_over =
                i == 0 && unit.substr(0, end) == "1" && (rest.empty() || rest.front() == '/');
            if (zero || (!exponent && !one_over)) return unit.substr(first, end - first);
            i = end - 1;
        } else if (!is_letter(c) && !is_space(c) && static_cast<unsigned char>(c) < 0x80 &&
                   std::string_view("_.*/^-()%").find(c) == std::string_view::npos) {
            return unit.substr(i, 1);
        }
    }
    return {};
}

/// "g0" cannot be mapped: the scanner of UDUNITS-2 takes trailing digits for an exponent.
std::string spelled_out(std::string_view unit) {
    std::string text(unit);
    for (std::size_t at = 0; (at = text.find("g0", at)) != std::string::npos;) {
        const bool starts = at == 0 || !(is_letter(text[at - 1]) || text[at - 1] == '_');
        const bool ends = at + 2 == text.size() || !is_digit(text[at + 2]);
        if (starts && ends) text.replace(at, 2, "standard_free_fall");
        at += 2;
    }
    return text;
}

std::string example(double number, std::string_view si_unit) {
    if (si_unit == "1") return fmt::format("write a plain number or per cent, e.g. \"{} %\"", number);
    if (si_unit == "rad") return fmt::format("write e.g. \"{} deg\"", number);
    return fmt::format("write e.g. \"{} {}\"", number, si_unit);
}

[[noreturn]] void refuse_not_finite(std::string_view text) {
    throw UnitError(fmt::format("'{}' is not a finite number", text), "", "write a finite number");
}

/// The factor from a unit to SI. Throws UnitError.
double factor(std::string_view unit, std::string_view si_unit, double number) {
    static std::mutex mutex;  // the parser of UDUNITS-2 keeps its state in globals
    const std::lock_guard lock(mutex);
    const PlainLocale plain;

    const std::string hint = example(number, si_unit);
    const auto unknown = [&](std::string why) {
        return UnitError(fmt::format("unknown unit '{}'", unit), std::move(why), hint);
    };
    if (unit.front() == ',')
        throw UnitError("a number with a comma", "the decimal sign is a point in every locale",
                        "write e.g. 1.5");
    if (unit.size() > 60) throw unknown("longer than any unit");
    const std::string spelled = spelled_out(unit);
    if (const auto part = foreign_part(spelled); !part.empty())
        throw unknown(fmt::format("'{}' is not part of a unit", part));

    const Database& units = database();
    const UnitPtr from = units.parse(spelled), to = units.parse(spelled_out(si_unit));
    if (!from) throw unknown("neither UDUNITS-2 nor the alias table has it");
    if (!ut_are_convertible(from.get(), to.get()) || angle_power(from.get()) != angle_power(to.get()))
        throw UnitError(fmt::format("'{}' is the wrong kind of unit", unit),
                        fmt::format("it is {}, expected {}", kind_of(from.get()),
                                    si_unit == "1" ? "a plain ratio" : si_unit),
                        hint);
    const ConverterPtr converter(ut_get_converter(from.get(), to.get()));
    if (!converter) throw unknown("it cannot be converted");
    const double scale = cv_convert_double(converter.get(), 1.0);
    const double offset = cv_convert_double(converter.get(), 0.0);
    if (offset != 0.0)
        throw UnitError(fmt::format("'{}' has an offset", unit),
                        "a temperature and a difference of temperatures would convert differently", hint);
    if (!(scale > 0.0) || std::abs(cv_convert_double(converter.get(), 3.0) - 3.0 * scale) > 1e-9 * scale)
        throw unknown("it is not proportional to SI");
    return scale;
}

}  // namespace

UnitError::UnitError(std::string problem, std::string why, std::string suggestion)
    : std::runtime_error(problem + (why.empty() ? "" : " (" + why + ")") +
                         (suggestion.empty() ? "" : ", " + suggestion)),
      problem_(std::move(problem)),
      why_(std::move(why)),
      suggestion_(std::move(suggestion)) {}

double to_si(std::string_view text, std::string_view si_unit) {
    const std::string_view whole = trimmed(text);
    std::string_view rest = whole;
    if (rest.size() > 1 && rest[0] == '+' && (is_digit(rest[1]) || rest[1] == '.')) rest.remove_prefix(1);
    double number = 0.0;
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), number);
    if (error == std::errc::invalid_argument)
        throw UnitError(fmt::format("'{}' does not start with a number", text), "", example(1, si_unit));
    if (error == std::errc::result_out_of_range || !std::isfinite(number)) refuse_not_finite(whole);
    rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
    rest = trimmed(rest);

    if (rest.empty()) {
        if (si_unit == "1") return number;
        throw UnitError(fmt::format("'{}' has no unit", text), "a number in quotes needs one",
                        example(number, si_unit));
    }
    // Exact for SI itself, and no database for it nor for common units.
    const auto is_it = [&](const CommonUnit& row) { return row.name == rest && row.si_unit == si_unit; };
    const auto row = std::ranges::find_if(common, is_it);
    const double scale = rest == si_unit       ? 1.0
                         : row != common.end() ? row->factor
                                               : factor(rest, si_unit, number);
    const double value = number * scale;
    if (!std::isfinite(value)) refuse_not_finite(whole);
    return value;
}

std::span<const UnitAlias> unit_aliases() {
    return aliases;
}

std::span<const CommonUnit> common_units() {
    return common;
}

bool is_space(char c) {
    return c == ' ' || c == '\t';
}

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && is_space(text.front()))
        text.remove_prefix(1);
    while (!text.empty() && is_space(text.back()))
        text.remove_suffix(1);
    return text;
}

bool is_share(std::string_view text) {
    std::string spelled(trimmed(text));  // UDUNITS-2 minds no case
    std::ranges::transform(spelled, spelled.begin(),
                           [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
    return spelled.ends_with('%') || spelled.ends_with("percent");
}

bool units_loaded() {
    return loaded;
}

}  // namespace twinchute
