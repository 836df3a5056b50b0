#include "compare/drop_test_option.hpp"

#include <fmt/format.h>

#include <charconv>

#include "lib/scene/data_files.hpp"
#include "lib/scene/units.hpp"

namespace twinchute::compare {
namespace {

/// [s]
double release_on_clock(const std::string& text) {
    double number = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    const bool is_plain = error == std::errc{} && end == text.data() + text.size();
    try {
        return to_si(is_plain ? text + " s" : text, "s");
    } catch (const UnitError& problem) {
        throw UsageError(fmt::format("--test-clock {}: {} ({}), write e.g. --test-clock 12.4", text,
                                     problem.problem(), problem.why()));
    }
}

}  // namespace

std::vector<Option> drop_test_options() {
    return {{"test", "FILE",
             "draw what a test recorded beside both: a CSV file with time, and any of " + test_channels()},
            {"test-clock", "TIME", "what the clock of --test reads at release, 0 s unless given"}};
}

std::optional<DropTestHistories> test_of(const Arguments& arguments) {
    const auto file = arguments.value("test"), clock = arguments.value("test-clock");
    if (clock && !file)
        throw UsageError(
            "--test-clock is of the file of --test, give both, e.g. --test drop.csv --test-clock 12.4");
    if (!file) return {};
    return read_test_histories(read_text_file(*file), std::string(*file),
                               clock ? release_on_clock(*clock) : 0.0);
}

}  // namespace twinchute::compare
