// Results of sizing, for reading and for scripts.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "compare/render/table.hpp"
#include "rom/size/size.hpp"

namespace twinchute::study {

/// A row a candidate: what varies, what it comes to, whether it meets the limits.
compare::Table trade_table(const rom::Sized& sized);
/// Share of each limit that a run uses.
compare::Table limits_table(const rom::Judged& judged);
/// The candidate's type, or that it is the scene's.
std::string type_text(const rom::Candidate& candidate);
/// Whether the best candidate meets the limits, in words.
std::string found_text(const rom::Sized& sized, const rom::Candidate& best);
/// Assumptions, a sentence each.
std::vector<std::string> size_notes(const Scene& scene, const rom::Sized& sized, const rom::Candidate& best);

/// The table of candidates, the limits of the best one, its peak force by formula, and what was assumed.
std::string size_text(const Scene& scene, const rom::Sized& sized, const Style& style);

/// docs/schema/size.schema.json.
nlohmann::ordered_json size_json(const Scene& scene, const rom::Sized& sized);

}  // namespace twinchute::study
