#include "lib/solve/plan.hpp"

#include <algorithm>
#include <array>

namespace twinchute {

std::string_view kind_name(PlanPart::Kind kind) {
    static constexpr std::array<std::string_view, 5> names{"dimension", "physics", "force block", "event",
                                                           "output"};
    return names[static_cast<std::size_t>(kind)];
}

std::vector<LeftOut> left_out_of(const std::vector<PlanPart>& parts) {
    std::vector<LeftOut> rows;
    for (const PlanPart& part : parts) {
        if (part.needed || part.kind == PlanPart::Kind::event || part.kind == PlanPart::Kind::output)
            continue;
        const auto same = std::ranges::find(rows, part.why, &LeftOut::why);
        if (same == rows.end())
            rows.push_back({part.name, part.why});
        else
            same->what += ", " + part.name;
    }
    return rows;
}

void add_bytes(std::vector<PlanArray>& arrays, std::string_view name, std::size_t bytes) {
    if (bytes == 0) return;
    const auto found = std::ranges::find(arrays, name, &PlanArray::name);
    if (found == arrays.end())
        arrays.push_back({std::string(name), bytes});
    else
        found->bytes += bytes;
}

double Plan::steps() const {
    double sum = 0.0;
    for (const PlanStage& stage : stages)
        sum += stage.steps;
    return sum;
}

double Plan::seconds() const {
    double sum = 0.0;
    for (const PlanStage& stage : stages)
        sum += stage.seconds;
    return sum;
}

std::size_t Plan::bytes() const {
    std::size_t sum = 0;
    for (const PlanArray& array : arrays)
        sum += array.bytes;
    return sum;
}

}  // namespace twinchute
