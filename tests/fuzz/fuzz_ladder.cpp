// Any bytes as the ladder.json that lies beside a comparison: a ladder of which plot, tables and page can be
// made, or a RecordError with a place.
#include <array>

#include "compare/report/html_parts.hpp"
#include "compare/report/ladder_files.hpp"
#include "compare/report/read_ladder.hpp"
#include "lib/record/record_error.hpp"
#include "tests/fuzz/fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace twinchute;
    constexpr std::array<std::string_view, 2> fidelities{"rom", "full"};
    try {
        const compare::Ladder ladder =
            compare::read_ladder(fuzz::text_of(data, size), "d/ladder.json", fidelities);
        const std::string part = compare::ladder_section({ladder, {}});
        fuzz::require(part.starts_with("<section id=\"ladder\">") && part.find("<script") == part.npos,
                      "a ladder is a part of the page and brings no script");
        const compare::Ladder again =
            compare::read_ladder(compare::ladder_json(ladder), "d/ladder.json", fidelities);
        fuzz::require(compare::ladder_section({again, {}}) == part,
                      "a ladder is the same when it is read again");
    } catch (const RecordError& error) {
        fuzz::require(error.place().file == "d/ladder.json", "an error has a place");
        fuzz::require(*error.what() != '\0', "an error says something");
    }
    return 0;
}
