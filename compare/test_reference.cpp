#include "compare/test_reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "lib/scene/csv_table.hpp"
#include "lib/scene/scene_error.hpp"
#include "lib/scene/units.hpp"

namespace twinchute::compare {
namespace {

constexpr const char* shape =
    "columns 'time' and 'force', or one column a metric (`twinchute list metrics`) with one line of values";

constexpr std::array<CsvColumn, 2> history_columns{
    {{"time", "s", {-36000.0, 36000.0}}, {"force", "N", {-1e7, 1e7}}}};

std::vector<std::string_view> split(std::string_view text, char at) {
    std::vector<std::string_view> parts;
    for (std::size_t begin = 0;;) {
        const std::size_t end = std::min(text.find(at, begin), text.size());
        std::string_view part = text.substr(begin, end - begin);
        if (part.ends_with('\r')) part.remove_suffix(1);
        parts.push_back(part);
        if (end == text.size()) return parts;
        begin = end + 1;
    }
}

[[noreturn]] void refuse(const std::string& file, int line, std::string problem, std::string why,
                         std::string suggestion = shape) {
    throw SceneError({file, line, 1}, "", std::move(problem), std::move(why), std::move(suggestion));
}

/// Standard gravities are no unit of their own to the units database.
double value_of(std::string_view number, std::string_view unit, const MetricRow& row) {
    if (row.unit != "g") return to_si(fmt::format("{} {}", number, unit), row.unit.empty() ? "1" : row.unit);
    if (unit != "g") throw UnitError("the unit is not g", "it counts standard gravities", "write g");
    return to_si(number, "1");
}

TestReference of_metrics(const std::vector<std::string_view>& lines, const std::string& file) {
    if (lines.size() != 3)
        refuse(file, static_cast<int>(lines.size()), "a table of metrics has three lines",
               fmt::format("this one has {}", lines.size()), "names, units, values");
    const auto names = split(lines[0], ','), units = split(lines[1], ','), values = split(lines[2], ',');
    for (std::size_t k = 1; k <= 2; ++k)
        if (const std::size_t count = (k == 1 ? units : values).size(); count != names.size())
            refuse(file, static_cast<int>(k) + 1, "the line is of another length than the first one",
                   fmt::format("{} fields under {} names", count, names.size()), "one field a column");
    TestReference test{file, {}};
    for (std::size_t i = 0; i < names.size(); ++i) {
        const MetricRow* row = find_metric_row(names[i]);
        if (!row) refuse(file, 1, fmt::format("the column '{}' is unknown", names[i]), "it is no metric");
        if (!head_of_judgeable(names[i]).empty())
            refuse(file, 1, fmt::format("the column '{}' is that of one parachute", names[i]),
                   "a ladder knows metrics of all together");
        if (std::ranges::count(test.values, row, &TestValue::row) > 0)
            refuse(file, 1, fmt::format("the column '{}' is there twice", names[i]), "", "leave one out");
        try {
            test.values.push_back({row, value_of(values[i], units[i], *row)});
        } catch (const UnitError& error) {
            refuse(file, 3, fmt::format("{}: {}", names[i], error.problem()), error.why(),
                   error.suggestion());
        }
    }
    return test;
}

}  // namespace

TestReference read_test_reference(std::string_view text, const std::string& file) {
    std::vector<std::string_view> lines = split(text, '\n');
    if (lines.back().empty()) lines.pop_back();
    if (lines.empty()) refuse(file, 1, "the file is empty", "");
    if (split(lines.front(), ',').front() != "time") return of_metrics(lines, file);
    const CsvTable table = read_csv_table(text, file, history_columns);
    if (!table.has("force")) refuse(file, 1, "the column 'force' is missing", "a history is one of force");
    return {file, {{find_metric_row("peak_force"), std::ranges::max(table.at("force"))}}};
}

}  // namespace twinchute::compare
