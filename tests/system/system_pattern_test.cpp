// `twinchute pattern`: gores as they are cut. The cut of a gore that is straight across the axis is exact, so
// that its area is that of the mesh, whose triangles are cut from it.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <regex>
#include <set>
#include <tuple>

#include "tests/support/program_test.hpp"

namespace twinchute::test {
namespace {

struct Point {
    double x, y;  // [mm]
};

/// [mm^2]; positive where it turns as a drawing's right seam does, away from the apex first.
double area_of(const std::vector<Point>& p) {
    double twice = 0.0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        const Point &a = p[i], &b = p[(i + 1) % p.size()];
        twice += a.x * b.y - b.x * a.y;
    }
    return 0.5 * twice;
}

class SystemPattern : public ProgramTest {
protected:
    json of(const std::string& command, const Words& words) {
        const Ended ended = run(Words{command, c9_inflation, "--json"} + words);
        EXPECT_EQ(ended.code, 0) << ended.err;
        return json::parse(ended.out);
    }
    std::vector<Point> polygon(const std::string& file, const std::string& id) {
        const std::string svg = text(file);
        const std::size_t row = svg.find("<polygon id=\"" + id + "\""),
                          begin = svg.find("points=\"", row) + 8;
        std::istringstream numbers(svg.substr(begin, svg.find('"', begin) - begin));
        std::vector<Point> points;
        Point p{};
        for (char comma = 0; numbers >> p.x >> comma >> p.y;)
            points.push_back(p);
        return points;
    }
};

TEST_F(SystemPattern, AreasAndMassesAreThoseOfTheMesh) {
    const json pattern = of("pattern", {}), mesh = of("mesh", {});
    const double area = pattern["gores"].get<double>() * pattern["gore_area_m2"].get<double>();
    EXPECT_NEAR(area / mesh["fabric_area_m2"].get<double>(), 1.0,
                1e-6);  // the promise; both are round-off apart
    EXPECT_EQ(pattern["fabric_mass_kg"], mesh["mass_kg"]["fabric"]);
    for (const json& part : pattern["parts"]) {
        const std::string name = part["part"];
        EXPECT_EQ(part["mass_kg"], mesh["mass_kg"][name]) << name;
        if (name == "line") {
            EXPECT_EQ(part["count"], pattern["gores"]);
        }
        // Every riser of the C-9 gathers the cords of seven lines.
        EXPECT_EQ(part["strands"], name == "riser" ? 7 : 1) << name;
    }
    EXPECT_TRUE(nothing_written());
}

/// Cones at any angle are as exact. Arcs are drawn by 256 chords, and the mesh has fewer: both are inscribed,
/// so that the mesh comes up to the drawing with the square of its rows.
TEST_F(SystemPattern, PanelsAreExactWhateverTheirAngle) {
    const auto ratio = [&](const Words& words) {
        const json pattern = of("pattern", words), mesh = of("mesh", words);
        return pattern["gores"].get<double>() * pattern["gore_area_m2"].get<double>() /
               mesh["fabric_area_m2"].get<double>();
    };
    for (const char* type : {"conical", "biconical", "triconical", "extended-skirt-10", "extended-skirt-14"})
        EXPECT_NEAR(ratio({"--set", "parachute.type='" + std::string(type) + "'"}), 1.0, 1e-6) << type;
    const auto excess = [&](const char* rows) {
        return ratio({"--set", "parachute.type='hemispherical'", "--set", "full.mesh.grading='uniform'",
                      "--set", "full.mesh.gore_rows=" + std::string(rows)}) -
               1.0;
    };
    const double coarse = excess("34"), fine = excess("68");
    EXPECT_LT(fine, 1e-4);
    EXPECT_GT(fine, 0.0);
    EXPECT_NEAR(coarse / fine, 4.0, 0.5);
}

TEST_F(SystemPattern, TheDrawingIsTrueToScaleAndTheAllowanceRunsAroundIt) {
    const json pattern =
        of("pattern", {"--out", "gore.svg", "--allowance", "15 mm", "--set", "parachute.type='biconical'"});
    EXPECT_EQ(pattern["file"], "gore.svg");
    const std::vector<Point> sew = polygon("gore.svg", "sew"), cut = polygon("gore.svg", "cut");
    ASSERT_EQ(sew.size(), 6u);  // vent, corner between the panels, skirt; twice
    ASSERT_EQ(cut.size(), 6u);
    // Four digits behind the point of a mm.
    EXPECT_NEAR(std::abs(area_of(sew)) / 1e6, pattern["gore_area_m2"].get<double>(), 1e-6);
    EXPECT_NEAR(std::abs(area_of(cut)) / 1e6, pattern["gore_cut_area_m2"].get<double>(), 1e-6);
    for (std::size_t i = 0; i < sew.size(); ++i) {  // each edge is 15 mm from its own, and beside it
        const Point &a = sew[i], &b = sew[(i + 1) % sew.size()];
        const double length = std::hypot(b.x - a.x, b.y - a.y);
        for (const Point& c : {cut[i], cut[(i + 1) % cut.size()]})
            EXPECT_NEAR(((c.x - a.x) * (b.y - a.y) - (c.y - a.y) * (b.x - a.x)) / length, 15.0, 1e-3) << i;
    }
    const std::string svg = text("gore.svg");
    std::smatch size;
    ASSERT_TRUE(std::regex_search(svg, size,
                                  std::regex("width=\"([0-9.]+)mm\" height=\"([0-9.]+)mm\" "
                                             "viewBox=\"0 0 ([0-9.]+) ([0-9.]+)\"")));
    EXPECT_EQ(size[1], size[3]);  // a unit is a mm
    EXPECT_EQ(size[2], size[4]);
}

TEST_F(SystemPattern, ADxfFileIsWhatReadersOfDxfTakeAndHasTheSameOutline) {
    const json pattern = of("pattern", {"--out", "gore.dxf", "--allowance", "10 mm"});
    here_.write("read.py",
                "import sys\ntry:\n    import ezdxf\nexcept ImportError:\n    print('none'); sys.exit(0)\n"
                "doc = ezdxf.readfile('gore.dxf')\nfaults = doc.audit().errors\n"
                "def area(layer):\n"
                "    line, = doc.modelspace().query('POLYLINE[layer==\"%s\"]' % layer)\n"
                "    p = [v.dxf.location for v in line.vertices]\n    assert line.is_closed\n"
                "    return abs(sum(a.x*b.y - b.x*a.y for a, b in zip(p, p[1:] + p[:1]))) / 2e6\n"
                "print(len(faults), area('SEW'), area('CUT'), len(doc.modelspace().query('TEXT')))\n");
    const Ended read = Process({"/usr/bin/python3", "read.py"}, here_.path()).wait();
    if (read.code == 127 || read.out == "none\n") GTEST_SKIP() << "python3-ezdxf is not installed";
    std::istringstream numbers(read.out);
    double faults = -1, sew = 0, cut = 0, texts = 0;
    numbers >> faults >> sew >> cut >> texts;
    EXPECT_EQ(faults, 0) << read.out << read.err;
    EXPECT_NEAR(sew, pattern["gore_area_m2"].get<double>(), 1e-8);
    EXPECT_NEAR(cut, pattern["gore_cut_area_m2"].get<double>(), 1e-8);
    EXPECT_EQ(texts, 1);
}

/// Panels as pieces: nothing of the fabric is lost, and a gap has none.
TEST_F(SystemPattern, PanelsAsPiecesHaveTheFabricOfTheMesh) {
    for (const auto& [type, count] :
         std::vector<std::pair<std::string, std::size_t>>{{"triconical", 3}, {"disk-gap-band", 2}}) {
        const Words words{"--set", "parachute.type='" + type + "'"};
        const json pattern = of("pattern", words + Words{"--pieces", "panels", "--allowance", "15 mm",
                                                         "--out", type + ".svg"}),
                   mesh = of("mesh", words);
        ASSERT_EQ(pattern["pieces"].size(), count) << type;
        double area = 0.0;
        double lowest = 0.0;  // [mm] down the drawing
        for (std::size_t i = 0; i < count; ++i) {
            const json& piece = pattern["pieces"][i];
            const std::string number = "-" + std::to_string(i + 1);
            const std::vector<Point> sew = polygon(type + ".svg", "sew" + number),
                                     cut = polygon(type + ".svg", "cut" + number);
            EXPECT_EQ(piece["piece"], "panel " + std::to_string(i + 1));
            // Four digits behind the point of a mm.
            EXPECT_NEAR(area_of(sew) / 1e6, piece["area_m2"].get<double>(), 1e-6);
            EXPECT_NEAR(area_of(cut) / 1e6, piece["cut_area_m2"].get<double>(), 1e-6);
            const auto [high, low] = std::ranges::minmax(cut, {}, &Point::y);
            EXPECT_GE(high.y, lowest + (i > 0 ? 19.9 : 0.0));  // [mm] apart
            lowest = low.y;
            area += piece["area_m2"].get<double>();
        }
        EXPECT_NEAR(area, pattern["gore_area_m2"].get<double>(), 1e-12 * area);
        EXPECT_NEAR(pattern["gores"].get<double>() * area / mesh["fabric_area_m2"].get<double>(), 1.0, 1e-6);
    }
}

/// Numbers of each sheet before an operator of PDF, whose streams are not compressed.
std::vector<std::vector<std::vector<double>>> sheets_of(const std::string& pdf,
                                                        const std::string& operation) {
    std::vector<std::vector<std::vector<double>>> sheets;
    for (std::size_t at = pdf.find("\nstream"); at != std::string::npos; at = pdf.find("\nstream", at + 1)) {
        std::istringstream words(pdf.substr(at + 8, pdf.find("endstream", at) - at - 8));
        sheets.emplace_back();
        std::vector<double> numbers;
        for (std::string word; words >> word;) {
            char* end = nullptr;
            const double number = std::strtod(word.c_str(), &end);
            if (*end == '\0') {
                numbers.push_back(number);
                continue;
            }
            if (word == operation) sheets.back().push_back(numbers);
            numbers.clear();
        }
    }
    return sheets;
}

/// The square to measure is 100 mm wide, and tiles that are laid as their names and frames say have the
/// corners of the outline where the drawing has them. A point of PDF is 1/72 inch.
TEST_F(SystemPattern, TilesOnPaperAreTrueToScale) {
    constexpr double mm = 72.0 / 25.4;
    for (const auto& [name, width, height] : std::vector<std::tuple<std::string, double, double>>{
             {"a4", 210.0, 297.0}, {"letter", 215.9, 279.4}}) {
        const json pattern = of("pattern", {"--out", "gore.pdf", "--allowance", "15 mm", "--paper", name});
        const std::string pdf = text("gore.pdf");
        std::smatch box;
        ASSERT_TRUE(std::regex_search(pdf, box, std::regex("/MediaBox \\[ 0 0 ([0-9.]+) ([0-9.]+) \\]")));
        EXPECT_NEAR(std::stod(box[1]), width * mm, 1e-3);
        EXPECT_NEAR(std::stod(box[2]), height * mm, 1e-3);
        const auto boxes = sheets_of(pdf, "re");
        ASSERT_GT(boxes.size(), 10u);
        EXPECT_NEAR(boxes[0][0][2], 100.0 * mm, 1e-3);
        EXPECT_NEAR(boxes[0][0][3], 100.0 * mm, 1e-3);

        // Where the frame of each tile lies in the drawing: its name says so, in steps of a frame less 10 mm.
        std::set<std::size_t> corners;
        std::vector<std::string> names;
        const std::regex label("\\(([A-Z]+)([0-9]+)   ");
        for (std::sregex_iterator i(pdf.begin(), pdf.end(), label), end; i != end; ++i)
            names.push_back((*i)[1].str() + " " + (*i)[2].str());
        ASSERT_EQ(names.size() + 1, boxes.size());
        const auto begins = sheets_of(pdf, "m"), ends = sheets_of(pdf, "l");
        const std::vector<Point> cut = [&] {
            of("pattern", {"--out", "gore.svg", "--allowance", "15 mm"});
            return polygon("gore.svg", "cut");
        }();
        for (std::size_t sheet = 1; sheet < boxes.size(); ++sheet) {
            EXPECT_NEAR(boxes[sheet][0][2], (width - 20.0) * mm, 1e-3);
            EXPECT_NEAR(boxes[sheet][0][3], (height - 20.0) * mm, 1e-3);
            const std::string& tile = names[sheet - 1];
            const double left = (tile[0] - 'A') * (width - 30.0),
                         top = (std::stod(tile.substr(2)) - 1.0) * (height - 30.0);
            for (const auto* points : {&begins[sheet], &ends[sheet]})
                for (const std::vector<double>& p : *points) {
                    const Point at{p[0] / mm - 10.0 + left, height - p[1] / mm - 10.0 + top};
                    for (std::size_t i = 0; i < cut.size(); ++i)
                        if (std::hypot(at.x - cut[i].x, at.y - cut[i].y) < 0.01) corners.insert(i);
                }
        }
        EXPECT_EQ(corners.size(), cut.size())
            << "corners of the outline, 0.01 mm from where the tiles have them";
    }
}

TEST_F(SystemPattern, WhatWouldBeAnotherCanopysPatternIsRefused) {
    const auto refused = [&](const Words& words, const std::string& what) {
        const Ended ended = run(Words{"pattern"} + words);
        EXPECT_EQ(ended.code, 2) << ended.out;
        EXPECT_NE(ended.err.find(what), std::string::npos) << ended.err;
    };
    refused({c9_inflation, "--set", "parachute.type='rotafoil'"}, "parachute.type");
    refused({c9_inflation, "--set", "parachute.design='cross-example'", "--set", "full.contact='none'"},
            "no gore of a cross");
    refused({c9_inflation, "--set", "parachute.type='ringslot'", "--set", "parachute.geometric_porosity=0.2"},
            "a canopy with slots");
    refused({c9_inflation, "--set", "parachute.type='disk-gap-band'"}, "--pieces panels");
    refused({shipped_scene("c9-window")}, "parachute.mesh");
    refused({shipped_scene("rocket-dual-deploy")}, "--parachute");
    refused({c9_inflation, "--parachute", "drogue"}, "there is no parachute 'drogue'");
    refused({c9_inflation, "--allowance", "15"}, "--allowance");
    refused({c9_inflation, "--allowance", "-1 mm"}, "--allowance");
    refused({c9_inflation, "--out", "gore.ps"}, ".svg, .dxf or .pdf");
    refused({c9_inflation, "--pieces", "pannels"}, "did you mean 'panels'?");
    refused({c9_inflation, "--out", "gore.pdf", "--paper", "a3"}, "a4 or letter");
    here_.write("mine.pdf", "%PDF-1.3\n");
    refused({c9_inflation, "--out", "mine.pdf"}, "is no pattern of twinchute");
    here_.write("mine.svg", "<svg/>");
    refused({c9_inflation, "--out", "mine.svg"}, "is no pattern of twinchute");
    EXPECT_EQ(text("mine.svg"), "<svg/>");
    for (const char* own : {"own.svg", "own.dxf", "own.pdf", "own.svg", "own.dxf", "own.pdf"})
        EXPECT_EQ(run({"pattern", c9_inflation, "--out", own, "--quiet"}).code, 0) << own;
}

}  // namespace
}  // namespace twinchute::test
