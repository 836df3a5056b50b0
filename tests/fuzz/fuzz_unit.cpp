// Any text as a quantity, the first byte choosing what is wanted: a finite number, the same every time, or a
// UnitError.
#include <array>
#include <cmath>
#include <optional>

#include "lib/scene/units.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

std::optional<double> converted(std::string_view text, std::string_view unit) {
    try {
        return twinchute::to_si(text, unit);
    } catch (const twinchute::UnitError& error) {
        twinchute::fuzz::require(!error.problem().empty(), "an error says something");
        return std::nullopt;
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace twinchute;
    constexpr std::array<std::string_view, 12> units{"1",  "kg",     "m",   "s",  "rad",    "m/s",
                                                     "m2", "kg/m^3", "N/m", "Pa", "kg/m^2", "K"};
    if (size == 0) return 0;
    const std::string_view unit = units[data[0] % units.size()], text = fuzz::text_of(data, size).substr(1);
    const std::optional<double> value = converted(text, unit);
    fuzz::require(!value || std::isfinite(*value), "a quantity is finite");
    fuzz::require(converted(text, unit) == value, "the same text is the same quantity");
    return 0;
}
