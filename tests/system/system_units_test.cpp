// What --units us changes, and what it leaves: numbers go with their units on the terminal and on pages, JSON
// and CSV stay SI, and no SI unit is left outside of prose that says it is in SI.
#include <gtest/gtest.h>

#include <cmath>
#include <regex>
#include <sstream>

#include "tests/support/program_test.hpp"
#include "tests/support/short_scene.hpp"

namespace twinchute {
namespace {

using namespace test;

/// The text without all of these; longer ones before the shorter ones that they hold.
std::string without(std::string text, std::vector<std::string> parts) {
    std::ranges::sort(parts, std::greater<>(), &std::string::size);
    for (const std::string& part : parts)
        for (std::size_t at = 0; !part.empty() && (at = text.find(part, at)) != text.npos;)
            text.erase(at, part.size());
    return text;
}

/// Every string in a JSON document: notes, warnings and reasons among them.
void collect(const json& node, std::vector<std::string>& strings) {
    if (node.is_string()) {
        if (node.get<std::string>().size() > 8) strings.push_back(node.get<std::string>());
    } else if (node.is_structured()) {
        for (const auto& child : node)
            collect(child, strings);
    }
}

std::vector<std::string> prose_of(const json& document) {
    std::vector<std::string> strings;
    collect(document, strings);
    return strings;
}

/// Numbers with an SI unit, and headings in one.
std::vector<std::string> si_units_in(const std::string& text) {
    static const std::regex si(
        R"((?:[0-9]\s+|\[)(?:m/s\^2|m/s|m\^2|m\^3|kg/m\^3|kg|N s|N/m|kN|kJ|N|J|Pa|m|m²|m/s²|m³)(?![\w/^.]|\s*=))");
    std::vector<std::string> found;
    for (auto at = std::sregex_iterator(text.begin(), text.end(), si); at != std::sregex_iterator(); ++at)
        found.push_back(at->prefix().str().substr(std::max<long>(0, at->prefix().length() - 40)) + at->str());
    return found;
}

void expect_none(const std::vector<std::string>& found, const std::string& whole) {
    for (const std::string& one : found)
        ADD_FAILURE() << "SI left: ..." << one << "\n";
    if (!found.empty()) std::cout << whole.substr(0, 6000);
}

/// The number and the unit behind the first of these words in a text.
std::pair<double, std::string> after(const std::string& text, const std::string& words) {
    const std::size_t at = text.find(words);
    if (at == text.npos) return {std::nan(""), "no " + words};
    std::istringstream rest(text.substr(at + words.size()));
    double value = 0.0;
    std::string unit;
    rest >> value >> unit;
    return {value, unit};
}

constexpr double foot = 0.3048, pound_force = 4.4482216152605;
constexpr double four_digits = 5.1e-4;  // [-] what rounding to them may take

class SystemUnits : public ShortScene {};

TEST_F(SystemUnits, TheCheckItselfFindsSi) {
    EXPECT_EQ(si_units_in("a 5 m/s, b 3.2 N, c [kg] d 7 m").size(), 4u);
    EXPECT_TRUE(si_units_in("a 5 ft/s, 3 lbf, [ft] in 4 min, 2 s, 1 g, 80 Ns, m = 3").empty());
}

TEST_F(SystemUnits, TheReducedModelSpeaksUsUnits) {
    for (const std::string& scene :
         {c9_inflation, shipped_scene("rocket-dual-deploy"), shipped_scene("c9-predicted")}) {
        const json si = json::parse(run({"rom", scene, "--json"}).out);
        const json us_json = json::parse(run({"rom", scene, "--json", "--units", "us"}).out);
        EXPECT_EQ(si["metrics"], us_json["metrics"]) << scene;
        const std::string us = run({"rom", scene, "--units", "us"}).out;
        expect_none(si_units_in(without(us, prose_of(si))), us);
        const auto [force, force_unit] = after(us, "peak force");
        EXPECT_EQ(force_unit, "lbf");
        const double newtons = si["metrics"]["peak_force_N"];
        EXPECT_NEAR(force * pound_force, newtons, four_digits * newtons);
        const auto [rate, rate_unit] = after(us, "descent rate");
        EXPECT_EQ(rate_unit, "ft/s");
        const double metres = si["metrics"]["descent_rate_m_s"];
        EXPECT_NEAR(rate * foot, metres, four_digits * metres);
        EXPECT_NE(us.find("units     numbers in US customary units"), us.npos);
    }
}

TEST_F(SystemUnits, TheFullModelAndTheComparisonDoSoToo) {
    ASSERT_LT(run({"full", "scene.toml", "--quiet", "--out", "full"}).code, 2);
    const std::string full = run({"full", "scene.toml", "--out", "full-us", "--units", "us"}).out;
    expect_none(si_units_in(without(full, prose_of(read("full-us/summary.json")))), full);
    EXPECT_EQ(text("full/history.csv"), text("full-us/history.csv"));
    EXPECT_EQ(text("full/events.csv"), text("full-us/events.csv"));

    const Ended si = run({"compare", "scene.toml", "--out", "out"});
    const std::string gap = text("out/gap.json");
    const Ended us = run({"report", "out", "--units", "us"});
    EXPECT_EQ(us.code, si.code);
    EXPECT_EQ(text("out/gap.json"), gap);  // the files for machines do not know
    std::vector<std::string> prose = prose_of(json::parse(gap));
    for (const char* side : {"out/rom/summary.json", "out/full/summary.json"})
        for (const std::string& one : prose_of(read(side)))
            prose.push_back(one);
    expect_none(si_units_in(without(us.out, prose)), us.out);
    const auto [force, unit] = after(us.out, "Peak opening force");
    EXPECT_EQ(unit, "lbf");
    const double newtons = json::parse(gap)["metrics"]["peak_force_N"]["candidate"];
    EXPECT_NEAR(force * pound_force, newtons, four_digits * newtons);

    // What stands before the tables of reasons, inputs and provenance; scripts and styles are no text.
    std::string page = text("out/report.html");
    page = page.substr(0, page.find("<section id=\"left-out\""));
    page = page.substr(page.find("</style>"));
    page = std::regex_replace(page, std::regex("<details>[^]*?</details>"), "");
    page = std::regex_replace(page, std::regex("<[^>]*>"), " ");
    expect_none(si_units_in(without(page, prose)), "");
    EXPECT_NE(page.find("lbf"), page.npos);
    // Curves go with the unit of their channel: the largest force of the page is that of the record.
    const std::string whole = text("out/report.html");
    EXPECT_NE(whole.find("\"id\":\"force\",\"title\":\"Opening force\",\"unit\":\"lbf\""), whole.npos);
    EXPECT_EQ(whole.find("\"unit\":\"N\""), whole.npos);
    EXPECT_NE(text("out/force.svg").find("opening force [lbf]"), std::string::npos);

    EXPECT_EQ(run({"report", "out"}).out, si.out);  // and back
}

TEST_F(SystemUnits, SizingDoesSoToo) {
    const std::string scene = shipped_scene("sizing/personnel");
    const json si = json::parse(run({"size", scene, "--json"}).out);
    const std::string us = run({"size", scene, "--units", "us"}).out;
    std::string tables;  // notes, warnings are prose
    std::istringstream lines(us);
    for (std::string line; std::getline(lines, line);)
        if (!line.starts_with("note ") && !line.starts_with("warning")) tables += line + "\n";
    expect_none(si_units_in(without(tables, prose_of(si))), us);
    EXPECT_NE(us.find("[ft]"), us.npos) << us;
    EXPECT_NE(us.find("[ft/s]"), us.npos);
    EXPECT_NE(us.find("[lb]"), us.npos);
    const json& limit = si["candidates"][0]["limits"][0];
    const auto [value, unit] =
        after(us, "\n  " + limit["name"].get<std::string>().substr(0, 0) + "descent rate");
    EXPECT_EQ(unit, "ft/s");
    EXPECT_NEAR(value * foot, limit["value"].get<double>(), four_digits * limit["value"].get<double>());
}

TEST_F(SystemUnits, OtherSystemsAreRefused) {
    const Ended ended = run({"rom", "scene.toml", "--units", "furlongs"});
    EXPECT_EQ(ended.code, 2);
    EXPECT_NE(ended.err.find("'--units furlongs' is not understood (si or us is wanted)"), std::string::npos)
        << ended.err;
}

}  // namespace
}  // namespace twinchute
