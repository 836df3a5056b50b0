// A drawing under construction: lines and words of an SVG file.
#pragma once

#include <iterator>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "compare/render/escape.hpp"

namespace twinchute::compare {

/// Places in pixels from the upper left corner; colours as SVG has them; `more` are further attributes.
class SvgCanvas {
public:
    template <typename... Values>
    void add(fmt::format_string<Values...> format, Values&&... values) {
        fmt::format_to(std::back_inserter(text_), format, std::forward<Values>(values)...);
        text_ += '\n';
    }
    void line(double x1, double y1, double x2, double y2, std::string_view stroke,
              std::string_view more = "") {
        add(R"(<line x1="{:.1f}" y1="{:.1f}" x2="{:.1f}" y2="{:.1f}" stroke="{}"{}/>)", x1, y1, x2, y2,
            stroke, more);
    }
    void words(double x, double y, std::string_view anchor, std::string_view fill, std::string_view text,
               std::string_view more = "") {
        add(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="{}" fill="{}"{}>{}</text>)", x, y, anchor, fill, more,
            xml_text(text));
    }
    /// The file: a white sheet with what was drawn. It reads the same on a dark page and on paper.
    std::string sheet(double width, double height, std::string_view title) const {
        return fmt::format(
            R"(<svg xmlns="http://www.w3.org/2000/svg" width="{0}" height="{1}" viewBox="0 0 {0} {1}" role="img" )"
            R"(font-family="Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif" font-size="13">)"
            "\n<title>{2}</title>\n<rect width=\"{0}\" height=\"{1}\" rx=\"6\" "
            "fill=\"#ffffff\"/>\n{3}</svg>\n",
            width, height, xml_text(title), text_);
    }

private:
    std::string text_;
};

}  // namespace twinchute::compare
