// The shape: three-dimensional where the browser can, and a drawing of a few moments everywhere.
#include <fmt/format.h>

#include "compare/render/escape.hpp"
#include "compare/report/html_parts.hpp"

namespace twinchute::compare {
namespace {

// Hidden until a script finds that it can draw.
constexpr std::string_view stage = R"html(<div class="stage" id="stage" hidden>
<div class="controls">
<button type="button" id="play" aria-pressed="false">Play</button>
<label class="cursor">Time <input type="range" id="scrub" min="0" max="1000" step="1" value="0"></label>
<output id="scrub-time" for="scrub"></output>
<label>Speed <select id="pace"><option value="1">1</option><option value="0.5">1/2</option><option value="0.25" selected>1/4</option><option value="0.1">1/10</option></select></label>
<label>Colour <select id="colour"><option value="stress" selected>stress</option><option value="folds">wrinkling</option></select></label>
<button type="button" id="home">Reset view</button>
</div>
<div class="scene"><canvas id="canopy" tabindex="0" role="img" aria-label="The canopy in three dimensions. Drag or use the arrow keys to turn it, plus and minus to come closer."></canvas>
</div>
<div class="legend" id="legend"></div>
</div>
)html";

}  // namespace

std::string canopy_section(const PageSides& sides) {
    const SharedClock clock = shared_clock(sides);
    for (std::size_t s = sides.size(); s-- > 0;) {
        const ShapeFrames& shape = *sides[s].frames;
        if (shape.empty()) continue;
        const std::size_t shown = page_frames(shape).frames.size();
        std::string text = fmt::format(
            "<section id=\"canopy-section\"><h2>The canopy</h2>\n<p>As {} sees it: {} triangles of fabric, "
            "{} of "
            "{} frames in this page.{}</p>\n",
            side_name(sides[s]), shape.triangles.size(), shown, shape.frames.size(),
            sides.size() > 1 && sides[1 - s].frames->empty()
                ? fmt::format(" {} has no shape.", side_name(sides[1 - s]))
                : "");
        text +=
            "<p class=\"quiet\" id=\"no-canopy\">Where the browser offers WebGL and scripts run, the opening "
            "plays here in "
            "three dimensions.</p>\n";
        text += stage;
        text +=
            "<figure>\n<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Moments of the "
            "opening\">\n" +
            canopy_still(shape, *sides[s].record, clock.zero[s]);
        return text + fmt::format(
                          "</div>\n<figcaption>The opening at a few moments, to one scale, from the side; "
                          "{}.</figcaption>"
                          "</figure></section>\n",
                          clock.from_snatch ? "time counts from snatch" : "time counts from release");
    }
    return {};
}

}  // namespace twinchute::compare
