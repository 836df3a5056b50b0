// Curves over one clock. Scripts draw them; without a script, and on paper, the same curves stand there as
// SVG.
#include <fmt/format.h>

#include "compare/render/escape.hpp"
#include "compare/report/aligned.hpp"
#include "compare/report/html_parts.hpp"
#include "compare/report/plots.hpp"

namespace twinchute::compare {
namespace {

std::string note_of(const AlignedChannel& channel, const PageSides& sides) {
    for (std::size_t s = 0; s < sides.size(); ++s)
        if (!channel.there[s])
            return fmt::format("{} has none: there is no difference to draw.",
                               xml_text(sides[s].record->fidelity));
    return {};
}

std::string figure(const AlignedChannel& channel, const PageSides& sides, const DropTestHistories* test) {
    const std::string id = xml_text(channel.channel);
    const bool both = channel.there[0] && channel.there[1];
    std::string text = fmt::format(
        "<figure class=\"history\" data-channel=\"{0}\">\n<figcaption><strong>{1} [{2}]</strong>"
        "<output class=\"readout\" id=\"readout-{0}\"></output></figcaption>\n"
        "<div class=\"live\" role=\"img\" aria-label=\"Curves: {1} against time; the time cursor above reads "
        "them off\"><div class=\"curve\"></div>",
        id, xml_text(channel.title), xml_text(unit_for_reading(channel.unit)));
    if (both) text += "<div class=\"difference\"></div>";
    text += "</div>\n";
    if (const std::string note = note_of(channel, sides); !note.empty())
        text += fmt::format("<p class=\"quiet\">{}</p>\n", note);
    return text + fmt::format("<div class=\"still\">{}</div>\n</figure>\n",
                              history_svg(sides, test, channel.channel));
}

}  // namespace

std::string histories_section(const PageSides& sides, const DropTestHistories* test) {
    const AlignedHistories aligned = aligned_histories(sides, test);
    if (aligned.channels.empty()) return {};
    const bool compares = sides.size() > 1, from_snatch = shared_clock(sides).from_snatch;
    std::string text = "<section id=\"histories\"><h2>Histories</h2>\n<p>";
    if (compares)
        text += fmt::format("{0} dashed, {1} in full; below each pair their difference, {1} minus {0}. ",
                            side_name(sides[0]), side_name(sides[1]));
    text +=
        fmt::format("Time counts from {}.</p>\n",
                    !from_snatch ? "release"
                    : compares ? "the snatch (or line stretch) of each, so that the openings lie above each "
                                 "other"
                               : "the snatch (or line stretch)");
    if (test != nullptr)
        text += fmt::format("<p>Dots: what a test measured, <code>{}</code>.</p>\n", xml_text(test->file));
    text +=
        "<div class=\"controls\">\n"
        "<div class=\"choice\" role=\"group\" aria-label=\"Time shown\"><button type=\"button\" "
        "data-window=\"opening\" "
        "aria-pressed=\"true\">Opening</button><button type=\"button\" data-window=\"all\" "
        "aria-pressed=\"false\">Whole "
        "run</button></div>\n"
        "<label class=\"cursor\">Time cursor <input type=\"range\" id=\"cursor\" min=\"0\" max=\"1\" "
        "step=\"1\" "
        "value=\"0\"></label> <output id=\"cursor-time\" for=\"cursor\"></output>\n"
        "<button type=\"button\" id=\"full-range\" aria-pressed=\"false\" hidden>Whole spikes</button>\n"
        "<p class=\"quiet hint\">Point at a curve, or move the cursor with the arrow keys. Drag to zoom, "
        "double click to "
        "go back. Dotted lines are events, named below.<span id=\"cut-off\" hidden> A spike much higher than "
        "all else is cut off at the top of its plot, which says how high it is.</span></p></div>\n<div "
        "class=\"histories\">\n";
    for (const AlignedChannel& channel : aligned.channels)
        text += figure(channel, sides, test);
    return text + "</div></section>\n";
}

}  // namespace twinchute::compare
