// Words of triggers: their events, and what they wait for.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "lib/scene/scene.hpp"

namespace twinchute {

/// The word of an event, e.g. "line-stretch"; empty for conditions with a value.
std::string_view event_name(Trigger::Kind kind);

/// The event that a word means.
std::optional<Trigger::Kind> find_event(std::string_view name);

/// A trigger in words: "altitude 150 m", "drogue.full-open", "line-stretch and 2 s".
std::string trigger_text(const Trigger& trigger);

}  // namespace twinchute
