// What the rungs of a ladder say together; it needs nothing that runs them.
#include <fmt/format.h>

#include <algorithm>

#include "compare/ladder.hpp"
#include "lib/cli/record_text.hpp"

namespace twinchute::compare {

const RungMetric* RungResult::find(std::string_view metric) const {
    const auto found =
        std::ranges::find_if(metrics, [&](const RungMetric& m) { return m.row->name == metric; });
    return found == metrics.end() ? nullptr : &*found;
}

RungMetric* RungResult::find(std::string_view metric) {
    const auto found =
        std::ranges::find_if(metrics, [&](const RungMetric& m) { return m.row->name == metric; });
    return found == metrics.end() ? nullptr : &*found;
}

std::optional<Worst> RungResult::gap_to(std::string_view fidelity) const {
    const auto found = std::ranges::find_if(gaps, [&](const auto& gap) { return gap.first == fidelity; });
    if (found == gaps.end()) return {};
    return found->second;
}

bool RungResult::ended() const {
    return was_run && twinchute::exit_code(status.code) == ExitCode::done;
}

const RungResult* cheapest(const Ladder& ladder, std::string_view fidelity, double wanted) {
    const RungResult* best = nullptr;
    for (const RungResult& result : ladder.rungs) {
        if (result.rung.fidelity != fidelity || !result.error || result.error->value > wanted) continue;
        if (best == nullptr || result.wall_s < best->wall_s) best = &result;
    }
    return best;
}

std::string advice(const Ladder& ladder) {
    std::string text = "to use:";
    for (const auto& [wanted, word] : wanted_accuracies) {
        text += fmt::format(" for {}", word);
        const char* separator = " ";
        for (const std::string_view fidelity : ladder.fidelities) {
            const RungResult* rung = cheapest(ladder, fidelity, wanted);
            text += separator;
            text += rung == nullptr ? fmt::format("no rung of {}", fidelity)
                                    : fmt::format("{} ({})", rung->rung.name, time_text(rung->wall_s));
            separator = " or ";
        }
        text += ";";
    }
    if (!ladder.gap) return text + " the gap between the fidelities is unknown";
    return text + fmt::format(" the gap between {} and {} is {:.2g} % ({})", ladder.fidelities[0],
                              ladder.fidelities[1], 100 * ladder.gap->value, ladder.gap->metric);
}

ExitCode exit_code(const Ladder& ladder) {
    ExitCode code = ExitCode::done;
    for (const RungResult& result : ladder.rungs) {
        if (result.status.code == StatusCode::interrupted) return ExitCode::interrupted;
        if (result.rung.given && !result.ended()) code = twinchute::exit_code(result.status.code);
    }
    return code;
}

}  // namespace twinchute::compare
