// Patterns on paper. libharu keeps its errors in the document: one look at the end tells of all.
#include <fmt/format.h>
#include <hpdf.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <type_traits>

#include "fullsim/pattern/drawings.hpp"

namespace twinchute::fullsim {
namespace {

constexpr double pt_of_mm = 72.0 / 25.4;
constexpr double margin = 10.0;   // [mm] that printers leave white
constexpr double overlap = 10.0;  // [mm] of a tile and the next
constexpr double square = 100.0;  // [mm] to measure

struct Free {
    void operator()(HPDF_Doc document) const { HPDF_Free(document); }
};
using Document = std::unique_ptr<std::remove_pointer_t<HPDF_Doc>, Free>;

/// As the fonts that each reader of PDF brings along have it: Latin-1.
std::string latin(const std::string& utf8) {
    std::string text;
    for (std::size_t i = 0; i < utf8.size(); ++i) {
        const auto byte = static_cast<unsigned char>(utf8[i]);
        if (byte < 0x80) {
            text += utf8[i];
        } else if ((byte == 0xc2 || byte == 0xc3) && i + 1 < utf8.size()) {
            text += static_cast<char>(((byte & 3) << 6) | (static_cast<unsigned char>(utf8[++i]) & 0x3f));
        } else if (byte >= 0xc0) {
            text += '?';
        }  // else: a later byte of such a letter
    }
    return text;
}

/// Part of the drawing on one sheet [mm], y away from the apex.
struct Tile {
    int row, column;
    PatternPoint low, high;

    std::string name() const {  // A1, B1, ... AA1
        std::string letters;
        for (int c = column; c >= 0; c = c / 26 - 1)
            letters.insert(letters.begin(), static_cast<char>('A' + c % 26));
        return letters + std::to_string(row + 1);
    }
};

/// Whether the segment has a point in the tile.
bool meets(const Tile& tile, const PatternPoint& a, const PatternPoint& b) {
    double first = 0.0, last = 1.0;
    for (int axis = 0; axis < 2; ++axis) {
        const double way = b[axis] - a[axis];
        double in = (tile.low[axis] - a[axis]) / way, out = (tile.high[axis] - a[axis]) / way;
        if (way == 0.0) {
            if (a[axis] < tile.low[axis] || a[axis] > tile.high[axis]) return false;
            continue;
        }
        if (in > out) std::swap(in, out);
        first = std::max(first, in);
        last = std::min(last, out);
    }
    return first <= last;
}

/// Whether any of a piece of fabric [mm] lies in the tile.
bool meets(const Tile& tile, const std::vector<PatternPoint>& piece) {
    const PatternPoint centre = 0.5 * (tile.low + tile.high);
    bool inside = false;
    for (std::size_t i = 0; i < piece.size(); ++i) {
        const PatternPoint &a = piece[i], &b = piece[(i + 1) % piece.size()];
        if (meets(tile, a, b)) return true;
        if ((a.y() > centre.y()) != (b.y() > centre.y()) &&
            centre.x() < a.x() + (b.x() - a.x()) * (centre.y() - a.y()) / (b.y() - a.y()))
            inside = !inside;
    }
    return inside;
}

class Printer {
public:
    Printer(const GorePattern& pattern, const PatternNotes& notes)
        : pattern_(pattern), notes_(notes), document_(HPDF_New(nullptr, nullptr)) {
        if (!document_) throw std::bad_alloc();
        HPDF_SetInfoAttr(document_.get(), HPDF_INFO_CREATOR, "twinchute pattern");
        HPDF_SetInfoAttr(document_.get(), HPDF_INFO_TITLE, latin(notes.title).c_str());
        font_ = HPDF_GetFont(document_.get(), "Helvetica", "WinAnsiEncoding");
        list_font_ = HPDF_GetFont(document_.get(), "Courier", "WinAnsiEncoding");
        const Extent extent = extent_of(pattern);
        low_ = extent.low;
        size_ = 1000.0 * (extent.high - extent.low);
        make_tiles();
    }

    std::string print() {
        first_sheet();
        for (const Tile& tile : tiles_)
            sheet_of(tile);
        HPDF_SaveToStream(document_.get());
        std::string text(HPDF_GetStreamSize(document_.get()), '\0');
        auto size = static_cast<HPDF_UINT32>(text.size());
        HPDF_ReadFromStream(document_.get(), reinterpret_cast<HPDF_BYTE*>(text.data()), &size);
        if (const HPDF_STATUS error = HPDF_GetError(document_.get()); error != HPDF_OK || size != text.size())
            throw std::runtime_error(fmt::format("the PDF file was not made (libharu: {:#x})", error));
        return text;
    }

private:
    PatternPoint drawn(const PatternPoint& p) const { return 1000.0 * (p - low_); }

    void make_tiles() {
        const PatternPoint window(notes_.paper->width - 2.0 * margin, notes_.paper->height - 2.0 * margin);
        const auto count = [&](int axis) {
            const double more = (size_[axis] - window[axis]) / (window[axis] - overlap);
            return 1 + std::max(0, static_cast<int>(std::ceil(more)));
        };
        std::vector<std::vector<PatternPoint>> pieces;
        for (const PatternPiece& piece : pattern_.pieces) {
            pieces.emplace_back();
            for (const PatternPoint& p : piece.cut)
                pieces.back().push_back(drawn(p));
        }
        columns_ = count(0), rows_ = count(1);
        for (int row = 0; row < rows_; ++row)
            for (int column = 0; column < columns_; ++column) {
                Tile tile{row, column, {}, {}};
                tile.low = PatternPoint(column * (window.x() - overlap), row * (window.y() - overlap));
                tile.high = tile.low + window;
                if (std::ranges::any_of(pieces, [&](const auto& piece) { return meets(tile, piece); }))
                    tiles_.push_back(tile);
            }
    }

    void begin_sheet() {
        page_ = HPDF_AddPage(document_.get());
        HPDF_Page_SetWidth(page_, real(notes_.paper->width));
        HPDF_Page_SetHeight(page_, real(notes_.paper->height));
    }
    static float real(double length) { return static_cast<float>(length * pt_of_mm); }  // [mm]
    /// Places on a sheet: from its upper left corner, y downward [mm].
    float up(double y) const { return real(notes_.paper->height - y); }
    void write(double x, double y, double letters, const std::string& text, bool upward = false) {
        HPDF_Page_BeginText(page_);
        HPDF_Page_SetFontAndSize(page_, font_, real(letters));
        HPDF_Page_SetTextMatrix(page_, upward ? 0.0F : 1.0F, upward ? 1.0F : 0.0F, upward ? -1.0F : 0.0F,
                                upward ? 0.0F : 1.0F, real(x), up(y));
        HPDF_Page_ShowText(page_, latin(text).c_str());
        HPDF_Page_EndText(page_);
    }
    void rectangle(double x, double y, double width, double height) {
        HPDF_Page_Rectangle(page_, real(x), up(y + height), real(width), real(height));
        HPDF_Page_Stroke(page_);
    }
    void line(double x1, double y1, double x2, double y2) {
        HPDF_Page_MoveTo(page_, real(x1), up(y1));
        HPDF_Page_LineTo(page_, real(x2), up(y2));
        HPDF_Page_Stroke(page_);
    }

    /// A square to measure, the plan of the tiles, the list of parts.
    void first_sheet() {
        begin_sheet();
        const double right = notes_.paper->width - margin;
        write(margin, 18.0, 5.0, notes_.title);
        HPDF_Page_SetLineWidth(page_, 0.5F);
        rectangle(margin, 25.0, square, square);
        const double beside = margin + square + 6.0;
        double y = 32.0;
        for (const std::string& row :
             {fmt::format("This square is {:g} mm wide and high.", square),
              std::string("Measure it; print at 100 %, without"), std::string("\"fit to page\"."),
              std::string(),
              fmt::format("{} tiles on {}, {} columns", tiles_.size(), notes_.paper->label, columns_),
              fmt::format("and {} rows. They overlap by {:g} mm:", rows_, overlap),
              std::string("lay the edge of a frame on the"),
              std::string("dashed line of the tile before.")}) {
            write(beside, y, 4.0, row);
            y += 6.0;
        }
        y = 25.0 + square + 8.0;
        const double bottom = notes_.paper->height - margin;
        const double list = 3.6 * static_cast<double>(notes_.parts.size()) + 4.0;
        plan(margin, y, right - margin, std::max(40.0, bottom - y - list));
        y = bottom - list + 6.0;
        HPDF_Page_BeginText(page_);
        HPDF_Page_SetFontAndSize(page_, list_font_, real(2.8));
        for (const std::string& row : notes_.parts) {
            HPDF_Page_SetTextMatrix(page_, 1.0F, 0.0F, 0.0F, 1.0F, real(margin), up(y));
            HPDF_Page_ShowText(page_, latin(row).c_str());
            y += 3.6;
        }
        HPDF_Page_EndText(page_);
    }

    void plan(double left, double top, double width, double height) {
        const PatternPoint all(tiles_.front().high - tiles_.front().low +
                               PatternPoint((columns_ - 1) * step().x(), (rows_ - 1) * step().y()));
        const double scale = std::min(width / all.x(), height / all.y());
        const double letters = std::min(3.0, 0.3 * scale * step().minCoeff());
        HPDF_Page_SetLineWidth(page_, 0.25F);
        for (const Tile& tile : tiles_) {
            rectangle(left + scale * tile.low.x(), top + scale * tile.low.y(), scale * step().x(),
                      scale * step().y());
            write(left + scale * tile.low.x() + 0.5, top + scale * tile.low.y() + letters + 0.5, letters,
                  tile.name());
        }
        HPDF_Page_SetLineWidth(page_, 0.75F);
        for (const PatternPiece& piece : pattern_.pieces) {
            for (std::size_t i = 0; i <= piece.cut.size(); ++i) {
                const PatternPoint p = scale * drawn(piece.cut[i % piece.cut.size()]);
                (i == 0 ? HPDF_Page_MoveTo : HPDF_Page_LineTo)(page_, real(left + p.x()), up(top + p.y()));
            }
            HPDF_Page_Stroke(page_);
        }
    }
    PatternPoint step() const {
        return tiles_.front().high - tiles_.front().low - PatternPoint(overlap, overlap);
    }

    void sheet_of(const Tile& tile) {
        begin_sheet();
        const PatternPoint window = tile.high - tile.low;
        HPDF_Page_SetGrayStroke(page_, 0.5F);
        HPDF_Page_SetLineWidth(page_, 0.25F);
        rectangle(margin, margin, window.x(), window.y());
        HPDF_Page_SetDash(page_, dashes(2, 2), 2, 0);
        if (tile.column + 1 < columns_)
            line(margin + step().x(), margin, margin + step().x(), margin + window.y());
        if (tile.row + 1 < rows_) line(margin, margin + step().y(), margin + window.x(), margin + step().y());
        write(margin, margin - 2.0, 4.0, fmt::format("{}   {}", tile.name(), notes_.title));

        HPDF_Page_GSave(page_);
        HPDF_Page_Rectangle(page_, real(margin), up(margin + window.y()), real(window.x()), real(window.y()));
        HPDF_Page_Clip(page_);
        HPDF_Page_EndPath(page_);
        HPDF_Page_SetGrayStroke(page_, 0.0F);
        for (const PatternPiece& piece : pattern_.pieces) {
            style(1.0, nullptr, 0);
            outline(tile, piece.cut);
            segments(tile, piece.marks);
            style(0.5, nullptr, 0);
            segments(tile, piece.panels);
            style(0.5, dashes(8, 4), 2);
            outline(tile, piece.sew);
            style(0.5, dashes(20, 4, 4, 4), 4);
            segments(tile, {piece.grain});
            const std::string label = piece_label(pattern_, piece, notes_);
            const PatternPoint end = drawn(piece.grain.to) - tile.low + PatternPoint(margin, margin);
            const double letters = letter_height(piece, label);
            write(end.x() - 0.5 * letters, end.y(), letters, label, true);
        }
        HPDF_Page_GRestore(page_);
    }

    template <class... Lengths>
    const HPDF_UINT16* dashes(Lengths... of_mm) {
        dashes_.assign({static_cast<HPDF_UINT16>(std::lround(of_mm * pt_of_mm))...});
        return dashes_.data();
    }
    void style(double width, const HPDF_UINT16* dashes, int count) {  // [mm], half of it on screens
        HPDF_Page_SetLineWidth(page_, real(0.5 * width));
        HPDF_Page_SetDash(page_, dashes, static_cast<HPDF_UINT>(count), 0);
    }
    void outline(const Tile& tile, const std::vector<PatternPoint>& points) {
        bool goes_on = false, any = false;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const PatternPoint a = drawn(points[i]), b = drawn(points[(i + 1) % points.size()]);
            if (!meets(tile, a, b)) {
                goes_on = false;
                continue;
            }
            if (!goes_on) to(HPDF_Page_MoveTo, tile, a);
            to(HPDF_Page_LineTo, tile, b);
            goes_on = any = true;
        }
        if (any) HPDF_Page_Stroke(page_);
    }
    void segments(const Tile& tile, const std::vector<PatternLine>& lines) {
        for (const PatternLine& line : lines)
            outline(tile, {line.from, line.to});
    }
    template <class Operator>
    void to(Operator where, const Tile& tile, const PatternPoint& p) {
        where(page_, real(margin + p.x() - tile.low.x()), up(margin + p.y() - tile.low.y()));
    }

    const GorePattern& pattern_;
    const PatternNotes& notes_;
    Document document_;
    HPDF_Font font_ = nullptr, list_font_ = nullptr;
    HPDF_Page page_ = nullptr;
    PatternPoint low_, size_;  // [m] upper left corner; [mm]
    std::vector<Tile> tiles_;
    int columns_ = 0, rows_ = 0;
    std::vector<HPDF_UINT16> dashes_;
};

}  // namespace

std::string pattern_pdf(const GorePattern& pattern, const PatternNotes& notes) {
    return Printer(pattern, notes).print();
}

}  // namespace twinchute::fullsim
