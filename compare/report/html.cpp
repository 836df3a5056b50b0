#include "compare/report/html.hpp"

#include <fmt/format.h>

#include "compare/render/escape.hpp"
#include "compare/report/glossary.hpp"
#include "compare/report/html_parts.hpp"
#include "compare/report/page_files.hpp"

namespace twinchute::compare {
namespace {

// Nothing may be fetched, sent or framed, whatever a name in a scene manages to smuggle in.
constexpr std::string_view policy =
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:; "
    "base-uri 'none'; form-action 'none'";

std::string base64(std::string_view bytes) {
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve(4 * (bytes.size() / 3 + 1));
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t there = std::min<std::size_t>(3, bytes.size() - i);
        std::uint32_t three = 0;
        for (std::size_t k = 0; k < 3; ++k)
            three = three << 8 | (k < there ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k)
            text += k <= there ? digits[three >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

std::string script(std::string_view name) {
    return fmt::format("<script>\n{}\n</script>\n", page_file(name));
}

std::string navigation(const std::vector<std::pair<std::string, std::string>>& parts) {
    std::string text = "<nav aria-label=\"Parts of this report\"><ul>\n";
    for (const auto& [id, title] : parts)
        text += fmt::format("<li><a href=\"#{}\">{}</a></li>\n", id, title);
    return text + "</ul></nav>\n";
}

/// id and title of each section that is there, read from its own heading.
std::vector<std::pair<std::string, std::string>> parts_of(std::string_view html) {
    constexpr std::string_view before = "<section id=\"", heading = "<h2>";
    std::vector<std::pair<std::string, std::string>> parts;
    for (std::size_t at = 0; (at = html.find(before, at)) != html.npos;) {
        at += before.size();
        const std::string_view id = html.substr(at, html.find('"', at) - at);
        const std::size_t title = html.find(heading, at) + heading.size();
        parts.emplace_back(id, html.substr(title, html.find("</h2>", title) - title));
    }
    return parts;
}

/// `name` as it is.
std::string whole_page(std::string_view name, const std::string& sections, const PageSides& sides,
                       const DropTestHistories* test) {
    const std::string body = with_glossary(sections);
    const ShapeFrames* shape = nullptr;
    for (const PageSide& side : sides)
        if (!side.frames->empty()) shape = side.frames;
    std::string page =
        "<!DOCTYPE html>\n<html lang=\"en\" class=\"no-script\">\n<head>\n<meta charset=\"utf-8\">\n";
    page += fmt::format("<meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\n", policy);
    page +=
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
        "<meta name=\"color-scheme\" content=\"light dark\">\n<meta name=\"generator\" "
        "content=\"twinchute\">\n";
    page += fmt::format("<title>{} - twinchute</title>\n<style>\n{}</style>\n", xml_text(name),
                        page_file("report.css"));
    page += "<script>document.documentElement.className = \"script\";</script>\n</head>\n<body>\n";
    page += fmt::format("<a class=\"skip\" href=\"#summary\">To the {}</a>\n",
                        sides.size() > 1 ? "verdict" : "key figures");
    page += navigation(parts_of(body)) + "<main>\n" + body + "</main>\n";
    page += fmt::format("<script type=\"application/json\" id=\"report-data\">{}</script>\n",
                        page_data(sides, test));
    if (shape != nullptr)
        page += fmt::format("<script type=\"text/plain\" id=\"report-frames\">{}</script>\n",
                            base64(frames_bytes(page_frames(*shape))));
    page += script("dygraph.min.js");
    if (shape != nullptr) page += script("three.min.js") + script("OrbitControls.js");
    page += script("shared.js") + script("clock.js") + script("charts.js");
    if (shape != nullptr) page += script("frames.js") + script("canopy.js");
    return page + "</body>\n</html>\n";
}

}  // namespace

std::string report_html(const Comparison& comparison, const LadderBeside& beside) {
    const PageSides sides = page_sides(comparison);
    const DropTestHistories* test = comparison.test ? &*comparison.test : nullptr;
    return whole_page(comparison.reference.scene.name,
                      summary_section(comparison) + histories_section(sides, test) +
                          events_section_html(sides) + attribution_section(comparison) +
                          energy_section_html(sides) + canopy_section(sides) + ladder_section(beside) +
                          calibration_section(comparison) + notes_sections(sides),
                      sides, test);
}

std::string record_html(const RunRecord& record, const ShapeFrames& frames, std::string_view title,
                        bool is_reference) {
    const PageSides sides = page_sides(record, frames, title, is_reference);
    return whole_page(record.scene.name,
                      record_summary(sides.front()) + histories_section(sides, nullptr) +
                          events_section_html(sides) + energy_section_html(sides) + canopy_section(sides) +
                          notes_sections(sides),
                      sides, nullptr);
}

}  // namespace twinchute::compare
