// Any bytes as a CSV table of air (first byte even) or wind: a table, or a SceneError with a place.
#include "lib/scene/scene_error.hpp"
#include "lib/scene/soundings.hpp"
#include "tests/fuzz/fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace twinchute;
    if (size == 0) return 0;
    const std::string_view text = fuzz::text_of(data, size).substr(1);
    try {
        if (data[0] % 2 == 0) {
            read_air_table(text, "air.csv", "air.csv");
        } else {
            read_wind_table(text, "wind.csv", "wind.csv");
        }
    } catch (const SceneError& error) {
        const SourcePlace& place = error.place();
        fuzz::require(!place.file.empty() && place.line > 0 && place.column > 0, "an error has a place");
    }
    return 0;
}
