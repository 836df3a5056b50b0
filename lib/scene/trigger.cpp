#include "lib/scene/trigger.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "lib/scene/binding.hpp"

namespace twinchute {
namespace {

constexpr Word<Trigger::Kind> events[] = {{"steady-descent", Trigger::Kind::steady_descent},
                                          {"peak-force", Trigger::Kind::peak_force},
                                          {"full-open", Trigger::Kind::full_open},
                                          {"line-stretch", Trigger::Kind::line_stretch},
                                          {"ground", Trigger::Kind::ground},
                                          {"release", Trigger::Kind::release},
                                          {"apogee", Trigger::Kind::apogee},
                                          {"cut", Trigger::Kind::cut}};

}  // namespace

std::string_view event_name(Trigger::Kind kind) {
    const auto* event = std::ranges::find(events, kind, &Word<Trigger::Kind>::value);
    return event == std::end(events) ? std::string_view{} : event->name;
}

std::optional<Trigger::Kind> find_event(std::string_view name) {
    const auto* event = std::ranges::find(events, name, &Word<Trigger::Kind>::name);
    return event == std::end(events) ? std::nullopt : std::optional(event->value);
}

std::string trigger_text(const Trigger& t) {
    std::string text;
    if (t.kind == Trigger::Kind::time)
        text = fmt::format("time {:g} s", t.value);
    else if (t.kind == Trigger::Kind::altitude)
        text = fmt::format("altitude {:g} m", t.value);
    else if (t.kind == Trigger::Kind::dynamic_pressure)
        text = fmt::format("dynamic pressure {:g} Pa", t.value);
    else
        text = fmt::format("{}{}{}", t.of, t.of.empty() ? "" : ".", event_name(t.kind));
    return t.delay > 0.0 ? fmt::format("{} and {:g} s", text, t.delay) : text;
}

}  // namespace twinchute
