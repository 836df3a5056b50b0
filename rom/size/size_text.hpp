// Results of sizing, for reading and for scripts.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "lib/cli/text.hpp"
#include "rom/size/size.hpp"

namespace twinchute::rom {

/// The table of candidates, the limits of the best one, its peak force by formula, and what was assumed.
std::string size_text(const Scene& scene, const Sized& sized, const Style& style);

/// docs/schema/size.schema.json.
nlohmann::ordered_json size_json(const Scene& scene, const Sized& sized);

}  // namespace twinchute::rom
