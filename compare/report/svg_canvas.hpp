// A drawing under construction: lines and words of an SVG file.
#pragma once

#include <iterator>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "compare/report/escape.hpp"

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
    const std::string& text() const { return text_; }

private:
    std::string text_;
};

}  // namespace twinchute::compare
