#include "compare/records.hpp"

#include <system_error>

#include "compare/report/attribution_json.hpp"
#include "lib/record/read_record.hpp"
#include "lib/record/record_parts.hpp"

namespace twinchute::compare {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t largest_gap = 4u << 20;  // [bytes] a real one takes some 20 kB

}  // namespace

std::string summary_of(const std::filesystem::path& place, const Fidelity& fidelity) {
    return (place / fidelity.name / "summary.json").string();
}

RunRecord record_of(const std::filesystem::path& place, const Fidelity& fidelity) {
    RunRecord record = read_record(place / fidelity.name);
    if (record.fidelity != fidelity.name)
        throw RecordError({summary_of(place, fidelity)}, "is not a record of " + std::string(fidelity.name),
                          "it says that it is of '" + record.fidelity.substr(0, 40) + "'",
                          "put the records back in their places");
    return record;
}

std::optional<Attribution> attribution_in(const fs::path& place, const Comparison& comparison) {
    const fs::path file = place / "gap.json";
    std::error_code ignored;
    if (!fs::exists(file, ignored)) return {};
    return read_attribution(read_record_file(file, largest_gap), file.string(), comparison);
}

}  // namespace twinchute::compare
