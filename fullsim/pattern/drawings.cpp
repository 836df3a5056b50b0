#include "fullsim/pattern/drawings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace twinchute::fullsim {
namespace {

constexpr double mm = 1000.0;  // of a metre

std::string xml_escaped(const std::string& text) {
    std::string out;
    for (const char c : text)
        out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
    return out;
}

}  // namespace

std::string piece_label(const GorePattern& pattern, const PatternPiece& piece, const PatternNotes& notes) {
    return fmt::format("{}, {}: 1 of {}, seam allowance {:g} mm, true scale", notes.title, piece.name,
                       notes.gores, mm * pattern.allowance);
}

double letter_height(const PatternPiece& piece, const std::string& label) {
    constexpr double largest = 20.0, width_of_a_letter = 0.6;  // [mm]; of its height
    // From below the grain's end, which lies at three quarters of a piece, to its upper edge.
    const double room = 1.4 * mm * (piece.grain.to.y() - piece.grain.from.y());
    return std::min(largest, room / (width_of_a_letter * static_cast<double>(label.size())));
}

Extent extent_of(const GorePattern& pattern) {
    Extent extent{pattern.pieces.front().cut.front(), pattern.pieces.front().cut.front()};
    for (const PatternPiece& piece : pattern.pieces)
        for (const PatternPoint& p : piece.cut) {
            extent.low = extent.low.cwiseMin(p);
            extent.high = extent.high.cwiseMax(p);
        }
    return extent;
}

std::string pattern_svg(const GorePattern& pattern, const PatternNotes& notes) {
    const Extent extent = extent_of(pattern);
    const PatternPoint size = mm * (extent.high - extent.low);
    const auto at = [&](const PatternPoint& p) { return PatternPoint(mm * (p - extent.low)); };
    std::string text = fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- twinchute pattern -->\n"
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.3f}mm\" height=\"{1:.3f}mm\" "
        "viewBox=\"0 0 {0:.3f} {1:.3f}\" fill=\"none\" stroke=\"black\">\n<title>{2}</title>\n",
        size.x(), size.y(), xml_escaped(notes.title));
    std::string number;  // of the piece, in ids
    const auto polygon = [&](const char* name, const std::vector<PatternPoint>& points, const char* style) {
        text += fmt::format("<polygon id=\"{}{}\" {} points=\"", name, number, style);
        for (const PatternPoint& p : points)
            text += fmt::format("{:.4f},{:.4f} ", at(p).x(), at(p).y());
        text += "\"/>\n";
    };
    const auto lines = [&](const char* name, const std::vector<PatternLine>& all, const char* style) {
        text += fmt::format("<g id=\"{}{}\" {}>\n", name, number, style);
        for (const PatternLine& line : all)
            text += fmt::format("<line x1=\"{:.4f}\" y1=\"{:.4f}\" x2=\"{:.4f}\" y2=\"{:.4f}\"/>\n",
                                at(line.from).x(), at(line.from).y(), at(line.to).x(), at(line.to).y());
        text += "</g>\n";
    };
    for (std::size_t i = 0; i < pattern.pieces.size(); ++i) {
        const PatternPiece& piece = pattern.pieces[i];
        if (pattern.pieces.size() > 1) number = fmt::format("-{}", i + 1);
        polygon("cut", piece.cut, "stroke-width=\"1\"");
        polygon("sew", piece.sew, "stroke-width=\"0.5\" stroke-dasharray=\"8 4\"");
        lines("panels", piece.panels, "stroke-width=\"0.5\"");
        lines("marks", piece.marks, "stroke-width=\"1\"");
        lines("grain", {piece.grain}, "stroke-width=\"0.5\" stroke-dasharray=\"20 4 4 4\"");
        const std::string label = piece_label(pattern, piece, notes);
        const double height = letter_height(piece, label);
        const PatternPoint begin = at(piece.grain.to) + PatternPoint(-0.5 * height, 0.0);  // beside the grain
        text += fmt::format(
            "<text transform=\"translate({:.1f} {:.1f}) rotate(-90)\" font-family=\"sans-serif\" "
            "font-size=\"{:.1f}\" fill=\"black\" stroke=\"none\">{}</text>\n",
            begin.x(), begin.y(), height, xml_escaped(label));
    }
    return text + "</svg>\n";
}

std::string pattern_dxf(const GorePattern& pattern, const PatternNotes& notes) {
    std::string text = "999\ntwinchute pattern\n";
    const auto pair = [&](int code, const auto& value) { text += fmt::format("{}\n{}\n", code, value); };
    const auto point = [&](int offset, const PatternPoint& p) {  // y up, as drawings have it
        pair(10 + offset, fmt::format("{:.6f}", mm * p.x()));
        pair(20 + offset, fmt::format("{:.6f}", -mm * p.y()));
        pair(30 + offset, "0.0");
    };
    constexpr const char* layers[] = {"CUT", "SEW", "PANELS", "MARKS", "GRAIN", "TEXT"};
    pair(0, "SECTION"), pair(2, "HEADER"), pair(9, "$ACADVER"), pair(1, "AC1009"), pair(0, "ENDSEC");
    pair(0, "SECTION"), pair(2, "TABLES"), pair(0, "TABLE"), pair(2, "LTYPE"), pair(70, 1);
    pair(0, "LTYPE"), pair(2, "CONTINUOUS"), pair(70, 0), pair(3, "Solid"), pair(72, 65), pair(73, 0);
    pair(40, "0.0"), pair(0, "ENDTAB"), pair(0, "TABLE"), pair(2, "LAYER"), pair(70, std::size(layers));
    for (std::size_t i = 0; i < std::size(layers); ++i)
        pair(0, "LAYER"), pair(2, layers[i]), pair(70, 0), pair(62, i + 1), pair(6, "CONTINUOUS");
    pair(0, "ENDTAB"), pair(0, "ENDSEC"), pair(0, "SECTION"), pair(2, "ENTITIES");
    const auto polygon = [&](const char* layer, const std::vector<PatternPoint>& points) {
        pair(0, "POLYLINE"), pair(8, layer), pair(66, 1), point(0, {0.0, 0.0}), pair(70, 1);
        for (const PatternPoint& p : points)
            pair(0, "VERTEX"), pair(8, layer), point(0, p);
        pair(0, "SEQEND"), pair(8, layer);
    };
    const auto lines = [&](const char* layer, const std::vector<PatternLine>& all) {
        for (const PatternLine& line : all)
            pair(0, "LINE"), pair(8, layer), point(0, line.from), point(1, line.to);
    };
    for (const PatternPiece& piece : pattern.pieces) {
        polygon("CUT", piece.cut);
        polygon("SEW", piece.sew);
        lines("PANELS", piece.panels);
        lines("MARKS", piece.marks);
        lines("GRAIN", {piece.grain});
        const std::string label = piece_label(pattern, piece, notes);
        pair(0, "TEXT"), pair(8, "TEXT"), point(0, piece.grain.to - PatternPoint(0.01, 0.0));
        pair(40, fmt::format("{:.1f}", letter_height(piece, label))), pair(1, label), pair(50, "90.0");
    }
    pair(0, "ENDSEC"), pair(0, "EOF");
    return text;
}

}  // namespace twinchute::fullsim
