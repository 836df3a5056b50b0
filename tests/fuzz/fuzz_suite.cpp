// Any bytes as a suite, a table of reference values (first byte 1) or a recording (2): what they say, or a
// SceneError with a place.
#include "compare/validate/suite.hpp"
#include "compare/validate/tables.hpp"
#include "tests/fuzz/fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace twinchute;
    const std::string_view text = fuzz::text_of(data, size);
    const int kind = size > 0 ? data[0] : 0;
    try {
        if (kind == 1) {
            const compare::ReferenceTable table = compare::read_reference_table(text.substr(1), "fuzz.csv");
            for (std::size_t i = 0; i < table.lines.size(); ++i)
                for (std::size_t column = 0; column < table.names.size(); ++column)
                    table.number(i, column);
            compare::canopy_type_keys(table, "flat_circular");
        } else if (kind == 2) {
            const Scene scene;
            const RunRecord record = compare::read_recording(text.substr(1), "fuzz.csv", scene);
            for (const compare::Quantity& quantity : compare::quantities())
                quantity.of(record, scene, {0.1, 10.0, 20.0, 10.0});
        } else {
            const compare::ValidationSuite suite = compare::read_suite_text(text, "fuzz.toml");
            fuzz::require(!suite.cases.empty(), "a suite without an error has cases");
            for (const compare::ValidationCase& one : suite.cases) {
                const bool runs = one.missing.empty() && one.shown_by.empty();
                fuzz::require(!runs || (!one.rows.empty() && !one.scene.empty()),
                              "a case that runs has rows");
            }
        }
    } catch (const SceneError& error) {
        const SourcePlace& place = error.place();
        fuzz::require(!place.file.empty(), "an error has a place");
        fuzz::require(kind != 0 || place.line > 0, "an error of a suite has a line");
        fuzz::require(*error.what() != '\0', "an error says something");
    }
    return 0;
}
