// The search for values that meet the limits.
#pragma once

#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "rom/size/limits.hpp"
#include "rom/size/vary.hpp"

namespace twinchute::rom {

/// Result of a search.
struct Found {
    Scene scene;  ///< with the values; where none meets the limits, those that miss them least
    Judged judged;
    std::vector<std::string> notes;  ///< other values that would do, a bound that was reached
};

/// Decides on each row of `vary` in turn: the first at its goal among those values with which the others can
/// still meet the limits, and so on. Samples each between its bounds, because loads need not grow with it,
/// then refines by Brent's methods. Of several ranges that meet the limits it takes the lowest and says so.
/// Throws Interrupted.
Found search(const Scene& scene, const std::vector<const VaryRow*>& vary, const std::stop_token& stop);

/// Somebody asked for an early end.
struct Interrupted {};

}  // namespace twinchute::rom
