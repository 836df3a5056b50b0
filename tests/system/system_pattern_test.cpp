// `twinchute pattern`: gores as they are cut. The cut of a gore that is straight across the axis is exact, so
// that its area is that of the mesh, whose triangles are cut from it.
#include <cmath>
#include <regex>

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

TEST_F(SystemPattern, WhatWouldBeAnotherCanopysPatternIsRefused) {
    const auto refused = [&](const Words& words, const std::string& what) {
        const Ended ended = run(Words{"pattern"} + words);
        EXPECT_EQ(ended.code, 2) << ended.out;
        EXPECT_NE(ended.err.find(what), std::string::npos) << ended.err;
    };
    refused({c9_inflation, "--set", "parachute.type='cross'"}, "parachute.type");
    refused({c9_inflation, "--set", "parachute.type='ringslot'", "--set", "parachute.geometric_porosity=0.2"},
            "a canopy with slots");
    refused({c9_inflation, "--set", "parachute.type='disk-gap-band'"}, "a canopy with gaps");
    refused({shipped_scene("c9-window")}, "parachute.mesh");
    refused({shipped_scene("rocket-dual-deploy")}, "--parachute");
    refused({c9_inflation, "--parachute", "drogue"}, "there is no parachute 'drogue'");
    refused({c9_inflation, "--allowance", "15"}, "--allowance");
    refused({c9_inflation, "--allowance", "-1 mm"}, "--allowance");
    refused({c9_inflation, "--out", "gore.pdf"}, ".svg or .dxf");
    here_.write("mine.svg", "<svg/>");
    refused({c9_inflation, "--out", "mine.svg"}, "is no pattern of twinchute");
    EXPECT_EQ(text("mine.svg"), "<svg/>");
    EXPECT_EQ(run({"pattern", c9_inflation, "--out", "own.svg", "--quiet"}).code, 0);
    EXPECT_EQ(run({"pattern", c9_inflation, "--out", "own.svg", "--quiet"}).code, 0);
}

}  // namespace
}  // namespace twinchute::test
