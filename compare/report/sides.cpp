#include "compare/report/sides.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace twinchute::compare {
namespace {

PageSide side_of(const RunRecord& record, const ShapeFrames& frames, std::string_view title,
                 bool is_reference) {
    return {&record, &frames, title, is_reference ? "reference" : "candidate",
            is_reference ? Tone::reference : Tone::candidate};
}

}  // namespace

PageSides page_sides(const Comparison& comparison) {
    return {side_of(comparison.candidate, comparison.candidate_frames, comparison.candidate_title, false),
            side_of(comparison.reference, comparison.reference_frames, comparison.reference_title, true)};
}

PageSides page_sides(const RunRecord& record, const ShapeFrames& frames, std::string_view title,
                     bool is_reference) {
    return {side_of(record, frames, title, is_reference)};
}

SharedClock shared_clock(const PageSides& sides) {
    for (const char* name : {"snatch", "line-stretch"}) {
        SharedClock clock{{}, true};
        bool all = true;
        for (std::size_t s = 0; s < sides.size(); ++s) {
            const Event* event = sides[s].record->find_event(name);
            all = all && event != nullptr;
            if (event != nullptr) clock.zero[s] = event->time;
        }
        if (all) return clock;
    }
    return {};
}

std::vector<EventPair> event_pairs(const PageSides& sides) {
    const SharedClock clock = shared_clock(sides);
    std::vector<EventPair> pairs;
    for (std::size_t s = 0; s < sides.size(); ++s) {
        for (const Event& event : sides[s].record->events) {
            auto found = std::ranges::find(pairs, event.name, &EventPair::name);
            if (found == pairs.end())
                found = pairs.insert(pairs.end(), {event.name, {}, std::numeric_limits<double>::infinity()});
            if (found->event[s] != nullptr) continue;
            found->event[s] = &event;
            if (std::isfinite(event.time)) found->first = std::min(found->first, event.time - clock.zero[s]);
        }
    }
    std::ranges::stable_sort(pairs, {}, &EventPair::first);
    return pairs;
}

}  // namespace twinchute::compare
