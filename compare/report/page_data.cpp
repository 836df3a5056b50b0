// Data that the scripts of the page draw.
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "compare/render/escape.hpp"
#include "compare/report/aligned.hpp"
#include "compare/report/html_parts.hpp"
#include "lib/record/display_units.hpp"

namespace twinchute::compare {
namespace {

// [bytes] of frames: with everything else, a page that a mailbox takes.
constexpr std::size_t most_frame_bytes = 1'000'000;

/// Five digits: a curve shows no more. What is not finite is a gap.
std::string numbers(const std::vector<double>& values) {
    std::string text = "[";
    for (const double value : values)
        text += std::isfinite(value) ? fmt::format("{:.5g},", value) : "null,";
    if (text.size() > 1) text.pop_back();
    return text + "]";
}

/// A string of JSON in which no tag of HTML can begin or end.
std::string word(std::string_view text) {
    std::string json = nlohmann::json(clean_text(text)).dump(-1, ' ', true);
    std::string safe;
    for (const char c : json)
        safe += c == '<' || c == '>' || c == '&' ? fmt::format("\\u{:04x}", static_cast<int>(c))
                                                 : std::string(1, c);
    return safe;
}

/// Never falling, whatever the rounding did. An instant that stands there twice is a jump: scripts draw it
/// upright.
std::string clock_numbers(const std::vector<double>& clock) {
    std::string text = "[";
    for (const double t : clock)
        text += fmt::format("{:.8g},", t);
    if (text.size() > 1) text.pop_back();
    return text + "]";
}

std::string events_json(const PageSides& sides, const SharedClock& clock) {
    std::string text = "[";
    for (std::size_t s = 0; s < sides.size(); ++s)
        for (const Event& event : sides[s].record->events)
            if (std::isfinite(event.time))
                text += fmt::format("{{\"side\":{},\"name\":{},\"time\":{:.8g}}},", s, word(event.name),
                                    event.time - clock.zero[s]);
    if (text.size() > 1) text.pop_back();
    return text + "]";
}

}  // namespace

ShapeFrames page_frames(const ShapeFrames& shape) {
    return thinned(shape, most_frame_bytes);
}

std::string page_data(const PageSides& sides, const DropTestHistories* test) {
    const AlignedHistories aligned = aligned_histories(sides, test);
    const SharedClock clock = shared_clock(sides);
    const std::size_t shaped = sides.back().frames->empty() ? 0 : sides.size() - 1;
    std::vector<std::string> names, styles;
    for (const PageSide& side : sides) {
        names.push_back(word(side.record->fidelity));
        styles.push_back(word(side.style));
    }
    std::string text = fmt::format(
        "{{\"stress\":{{\"factor\":{:.8g},\"unit\":{}}},\"sides\":[{}],\"styles\":[{}],\"clockLabel\":{},"
        "\"openingEnd\":{:.8g},\"frameZero\":{:.8g},\n\"clock\":{},\n\"events\":{},\n\"channels\":[",
        shown_factor("N/m"), word(shown_unit("N/m")), fmt::join(names, ","), fmt::join(styles, ","),
        word(clock.label()), aligned.opening_end, clock.zero[shaped], clock_numbers(aligned.clock),
        events_json(sides, clock));
    for (const AlignedChannel& channel : aligned.channels) {
        text += fmt::format("\n{{\"id\":{},\"title\":{},\"unit\":{},\"values\":[", word(channel.channel),
                            word(channel.title), word(unit_for_reading(channel.unit)));
        for (std::size_t s = 0; s < sides.size(); ++s)
            text += (s == 0 ? "" : ",") + (channel.there[s] ? numbers(channel.value[s]) : "null");
        text += "]" + (channel.test.empty() ? "" : ",\"test\":" + numbers(channel.test)) + "},";
    }
    if (!aligned.channels.empty()) text.pop_back();
    return text + "]}";
}

}  // namespace twinchute::compare
