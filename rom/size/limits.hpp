// Limits that a parachute has to meet, a row each, and how near a run comes to them.
#pragma once

#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "lib/record/run_record.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::rom {

/// A limit is on a metric of the reduced-order model's record.
struct LimitRow {
    std::string_view name, unit, title;
    std::optional<double> SizeSpec::*limit;  ///< in `unit`
    std::string_view metric;
    double to_unit;               ///< value in `unit` over the metric's
    bool is_load;                 ///< a force or a deceleration: what an opening does
    std::string_view alone = {};  ///< metric that says the same of a record without the other one
};

std::span<const LimitRow> limit_rows();

/// A limit that the scene gives, and what a run makes of it.
struct Met {
    const LimitRow* row = nullptr;
    double value = 0.0, limit = 0.0;  ///< in the row's unit
    double share() const { return value / limit; }
};

/// A run held against the limits of its scene.
struct Judged {
    /// Largest share of a limit that is used [-]: 1 and less meets them all. `nowhere` where the run does not
    /// come to what is limited.
    double used = 0.0;
    std::vector<Met> limits;  ///< in the order of the rows
    std::string why_not;      ///< why it does not come to it; else empty
    RunRecord record;

    bool meets() const { return used <= 1.0; }
    /// Largest share of the limits on loads [-], of all where there is none on loads.
    double loaded() const;
    /// The limit that the run uses most; null where it comes to none.
    const Met* binding() const;
};

/// Larger than any share of a limit, and still a number that root finders can take.
inline constexpr double nowhere = 1e6;

/// Runs a scene with limits.
Judged judge(const Scene& scene, const std::stop_token& stop);

}  // namespace twinchute::rom
