#include "compare/records.hpp"

#include "lib/record/read_record.hpp"

namespace twinchute::compare {

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

}  // namespace twinchute::compare
