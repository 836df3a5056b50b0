#include "lib/scene/opening_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/math/vec.hpp"
#include "lib/record/metrics.hpp"
#include "lib/scene/csv_table.hpp"

namespace twinchute {
namespace {

constexpr CsvColumn fill_constant{"fill_constant", "1", {0.0, 200.0, true}};
constexpr std::array<CsvColumn, 2> by_froude{{{"froude_number", "1", {0.0, 1e7, true}}, fill_constant}};
constexpr std::array<CsvColumn, 2> by_mass{{{"mass_ratio", "1", {0.0, 1e7, true}}, fill_constant}};
constexpr std::array<CsvColumn, 2> growth{
    {{"fill_fraction", "1", {0.0, 100.0}, true}, {"drag_area_ratio", "1", {0.0, 5.0}}}};
constexpr double half_turn = pi * (1.0 + 1e-12);  // 180 deg, however it was rounded
constexpr std::array<CsvColumn, 2> by_attitude{
    {{"angle", "rad", {0.0, half_turn}}, {"drag_area", "m^2", {0.0, 1e4}}}};

constexpr std::array<CsvColumn, 2> by_mach_number{
    {{"mach_number", "1", {0.0, 100.0}}, {"drag_area_factor", "1", {0.0, 100.0, true}}}};

[[noreturn]] void refuse(const std::string& file, std::size_t row, std::string problem, std::string why,
                         std::string hint) {
    // Names and units stand in the two lines above.
    throw SceneError({file, static_cast<int>(row) + 3, 1}, "", std::move(problem), std::move(why),
                     std::move(hint));
}

void require_full(const std::string& file, const std::vector<double>& ratio, std::size_t row,
                  std::string_view where) {
    if (ratio[row] != 1.0)
        refuse(file, row, fmt::format("drag_area_ratio is {:g} {}", ratio[row], where),
               "the drag area is then the steady one", "divide by the steady drag area; write 1 there");
}

}  // namespace

DragAreaTable read_drag_area_table(std::string_view text, const std::string& file, const std::string& name) {
    const CsvTable table = read_csv_table(text, file, growth);
    if (!table.has("drag_area_ratio"))
        refuse_columns(file, "the column 'drag_area_ratio' is missing",
                       "the columns are fill_fraction and drag_area_ratio");
    const std::vector<double>&x = table.at("fill_fraction"), &ratio = table.at("drag_area_ratio");
    const std::vector<double> once = [&] {
        std::vector<double> points = x;
        points.erase(std::unique(points.begin(), points.end()), points.end());
        return points;
    }();
    if (once.size() < 3)
        refuse(file, x.size() - 1, fmt::format("{} points", once.size()), "a curve needs three",
               "add one in between");
    for (std::size_t i = 1; i < x.size(); ++i) {
        if (x[i] != x[i - 1]) continue;
        if (i == 1 || i + 1 == x.size())
            refuse(file, i, fmt::format("fill_fraction {:g} stands here twice", x[i]),
                   "twice is a kink, and there is none at either end", "keep one line");
        if (ratio[i] != ratio[i - 1])
            refuse(file, i, fmt::format("drag_area_ratio jumps from {:g} to {:g}", ratio[i - 1], ratio[i]),
                   "a point that stands here twice is a kink of the curve",
                   "give both lines the same ratio, or let it rise over a short while");
    }
    if (x.front() != 0.0)
        refuse(file, 0, fmt::format("fill_fraction begins at {:g}", x.front()),
               "0 is where the drag area begins to rise", "begin at 0");
    const auto full = std::ranges::find(x, 1.0);
    if (full == x.end())
        refuse(file, x.size() - 1, "there is no fill_fraction of 1",
               "that is where the drag area first is the steady one", "add a line for it");
    const auto at_full = static_cast<std::size_t>(full - x.begin());
    require_full(file, ratio, at_full, "at fill_fraction 1");
    require_full(file, ratio, x.size() - 1, "at the end");
    for (std::size_t i = 0; i < at_full; ++i)
        if (ratio[i] >= 1.0)
            refuse(file, i, fmt::format("drag_area_ratio is {:g} before fill_fraction 1", ratio[i]),
                   "full open is where it first reaches 1", "stretch fill_fraction, so that this is 1");
    return {name, x, ratio};
}

FillTable read_fill_table(std::string_view text, const std::string& file, const std::string& name) {
    const std::string_view names = text.substr(0, text.find('\n'));
    const bool mass = names.find("mass_ratio") != std::string_view::npos;
    const bool froude = names.find("froude_number") != std::string_view::npos;
    constexpr const char* hint = "the columns are froude_number or mass_ratio, and fill_constant";
    if (mass == froude)
        refuse_columns(
            file, mass ? "both froude_number and mass_ratio" : "neither froude_number nor mass_ratio", hint);
    const CsvTable table = mass ? read_csv_table(text, file, by_mass) : read_csv_table(text, file, by_froude);
    if (!table.has("fill_constant")) refuse_columns(file, "the column 'fill_constant' is missing", hint);
    FillTable read;
    read.file = name;
    read.by = mass ? FillTable::By::mass_ratio : FillTable::By::froude_number;
    read.at = table.at(mass ? "mass_ratio" : "froude_number");
    read.n = table.at("fill_constant");
    return read;
}

CalibrationTable read_calibration_table(std::string_view text, const std::string& file,
                                        const std::string& name) {
    constexpr KeyRange positive{0.0, 1e9, true}, factor{0.01, 100.0};
    std::vector<CsvColumn> known{{"run", "1", {1.0, 1e6}}};
    for (const ConditionRow& row : condition_rows())
        known.push_back({row.column, row.unit, positive});
    for (const std::string_view key : calibrated_keys())
        known.push_back({key, "1", factor});
    const CsvTable table = read_csv_table(text, file, known, 1);
    for (const ConditionRow& row : condition_rows())
        if (!table.has(row.column))
            refuse_columns(file, fmt::format("the column '{}' is missing", row.column),
                           "factors hold at the conditions of their run");
    std::vector<DropConditions> runs;
    for (std::size_t i = 0; i < table.at("run").size(); ++i)
        runs.push_back({table.at("payload_mass")[i], table.at("airspeed")[i], table.at("air_density")[i]});
    std::vector<CalibratedFactors> inputs;
    for (const std::string_view key : calibrated_keys())
        if (table.has(key)) inputs.push_back({std::string(key), table.at(key)});
    if (inputs.empty())
        refuse_columns(file, "there is no column of factors",
                       fmt::format("add one or more of {}", fmt::join(calibrated_keys(), ", ")));
    return {name, std::move(runs), std::move(inputs)};
}

AttitudeDrag read_attitude_drag(std::string_view text, const std::string& file, const std::string& name) {
    const CsvTable table = read_csv_table(text, file, by_attitude);
    if (!table.has("drag_area"))
        refuse_columns(file, "the column 'drag_area' is missing", "the columns are angle and drag_area");
    const std::vector<double>&angle = table.at("angle"), &area = table.at("drag_area");
    if (angle.front() != 0.0)
        refuse(file, 0, fmt::format("angle begins at {:g} deg", angle.front() * 180.0 / pi),
               "0 is a body that hangs straight in the air", "begin at 0");
    // A degree cannot be written exactly in radians.
    const auto is = [&](double end) { return std::abs(angle.back() - end) < 1e-9; };
    if (!is(pi) && !is(0.5 * pi))
        refuse(file, angle.size() - 1, fmt::format("angle ends at {:g} deg", angle.back() * 180.0 / pi),
               "a body may turn any way", "end at 180 deg, or at 90 deg where above and below are alike");
    return {name, angle, area};
}

MachDrag read_mach_drag(std::string_view text, const std::string& file, const std::string& name) {
    const CsvTable table = read_csv_table(text, file, by_mach_number);
    if (!table.has("drag_area_factor"))
        refuse_columns(file, "the column 'drag_area_factor' is missing",
                       "the columns are mach_number and drag_area_factor");
    return {name, table.at("mach_number"), table.at("drag_area_factor")};
}

std::pair<std::vector<double>, std::vector<double>> read_test_points(std::string_view text,
                                                                     const std::string& file,
                                                                     const std::string& x,
                                                                     const std::string& y) {
    const auto column = [](const std::string& name) {
        const MetricRow& metric = *find_metric_row(name);
        return CsvColumn{metric.name, metric.tolerance_unit()};
    };
    const std::array<CsvColumn, 2> known{column(x), column(y)};
    const CsvTable table = read_csv_table(text, file, known);
    if (!table.has(y))
        refuse_columns(file, fmt::format("the column '{}' is missing", y),
                       fmt::format("the columns are {} and {}", x, y));
    return {table.at(x), table.at(y)};
}

}  // namespace twinchute
