// Histories of both sides over one clock, for curves above each other and the difference between them.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "compare/report/sides.hpp"

namespace twinchute::compare {

struct AlignedChannel {
    std::string_view channel, title;
    std::string unit;
    /// By side, one value an instant; NaN where the side has none: before its first row, after its last.
    std::array<std::vector<double>, 2> value;
    std::array<bool, 2> there{};
    std::vector<double> test;  ///< likewise, at its own instants alone; empty where nothing was measured
};

struct AlignedHistories {
    /// [s] as SharedClock says; it does not fall. An instant at which a history jumps stands there twice:
    /// what was before it, and what follows.
    std::vector<double> clock;
    double opening_end = 0.0;              ///< [s] on it: by then the opening is over on all sides
    std::vector<AlignedChannel> channels;  ///< those that at least one side has
};

/// The channels of history_rows(), smooth between the rows of a record (modified Akima, H. Akima, J. ACM
/// 17, 1970), on either side of a jump by itself: two rows of one time are one. The clock has the rows of
/// all sides where a page can hold them, and is fine until opening_end and coarse after it where not; it has
/// the instant at which each channel of each side is largest, so that no peak is cut.
AlignedHistories aligned_histories(const PageSides& sides, const DropTestHistories* test = nullptr);

}  // namespace twinchute::compare
