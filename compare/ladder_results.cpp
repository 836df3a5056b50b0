// Conclusions from all levels of a ladder; it needs nothing that runs them.
#include <fmt/format.h>

#include <algorithm>

#include "compare/ladder.hpp"
#include "lib/cli/record_text.hpp"

namespace twinchute::compare {

const LevelMetric* LevelResult::find(std::string_view metric) const {
    const auto found =
        std::ranges::find_if(metrics, [&](const LevelMetric& m) { return m.row->name == metric; });
    return found == metrics.end() ? nullptr : &*found;
}

LevelMetric* LevelResult::find(std::string_view metric) {
    const auto found =
        std::ranges::find_if(metrics, [&](const LevelMetric& m) { return m.row->name == metric; });
    return found == metrics.end() ? nullptr : &*found;
}

std::optional<Worst> LevelResult::gap_to(std::string_view fidelity) const {
    const auto found = std::ranges::find_if(gaps, [&](const auto& gap) { return gap.first == fidelity; });
    if (found == gaps.end()) return {};
    return found->second;
}

bool LevelResult::ended() const {
    return was_run && twinchute::exit_code(status.code) == ExitCode::done;
}

const LevelResult* cheapest(const Ladder& ladder, std::string_view fidelity, double wanted) {
    const LevelResult* best = nullptr;
    for (const LevelResult& result : ladder.levels) {
        if (result.level.fidelity != fidelity || !result.error || result.error->value > wanted) continue;
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
            const LevelResult* level = cheapest(ladder, fidelity, wanted);
            text += separator;
            text += level == nullptr ? fmt::format("no level of {}", fidelity)
                                     : fmt::format("{} ({})", level->level.name, time_text(level->wall_s));
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
    for (const LevelResult& result : ladder.levels) {
        if (result.status.code == StatusCode::interrupted) return ExitCode::interrupted;
        if (result.level.given && !result.ended()) code = twinchute::exit_code(result.status.code);
    }
    return code;
}

}  // namespace twinchute::compare
