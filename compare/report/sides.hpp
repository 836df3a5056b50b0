// The records that a report shows: candidate and reference of a comparison, or one run alone.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "compare/gap.hpp"
#include "compare/render/table.hpp"

namespace twinchute::compare {

/// A record, and the class that gives it its colour.
struct PageSide {
    const RunRecord* record;
    const ShapeFrames* frames;
    std::string_view title;  ///< e.g. "reduced-order model"
    std::string_view style;  ///< "candidate" or "reference"
    Tone tone;
};

/// One or two, candidate first, as in every table.
using PageSides = std::vector<PageSide>;

PageSides page_sides(const Comparison& comparison);
/// A run alone, in the colour that its model has in a comparison.
PageSides page_sides(const RunRecord& record, const ShapeFrames& frames, std::string_view title,
                     bool is_reference);

/// The clock that all sides share: seconds since their snatch, or line stretch; else since release.
struct SharedClock {
    std::array<double, 2> zero{};  ///< [s] since release, by side
    bool from_snatch = false;
    std::string label() const { return from_snatch ? "time since snatch [s]" : "time since release [s]"; }
};
SharedClock shared_clock(const PageSides& sides);

/// An event of one name on either side or both.
struct EventPair {
    std::string name;
    std::array<const Event*, 2> event{};  ///< by side; null where it did not happen
    double first = 0.0;                   ///< [s] of the shared clock; infinite where no time is finite
};
/// Each name once, in the order in which it first happens on either side.
std::vector<EventPair> event_pairs(const PageSides& sides);

}  // namespace twinchute::compare
