// A family of runs of another model, as a table that the reduced-order model carries.
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "lib/cli/command.hpp"
#include "lib/scene/calibration.hpp"
#include "study/calibrate/calibration_files.hpp"

namespace twinchute::study {
namespace {

/// Its key below a parachute's, where a table may have factors on it.
std::optional<std::string_view> carried(const Scene& scene, const std::string& key) {
    for (const std::string_view one : calibrated_keys())
        for (const Parachute& p : scene.parachutes)
            if (key == fmt::format("parachute.{}", one) || key == fmt::format("parachute.{}.{}", p.name, one))
                return one;
    return {};
}

/// Parameters that the table has a column for.
std::vector<std::size_t> columns_of(Calibration& calibration, const Scene& scene) {
    std::vector<std::size_t> columns;
    std::string head;  // of the parachute that they are of
    for (std::size_t i = 0; i < calibration.parameters.size(); ++i) {
        const Parameter& p = calibration.parameters[i];
        if (p.unknown.kind != Unknown::Kind::key || p.held) continue;
        const auto key = carried(scene, p.unknown.name);
        if (!key) {
            calibration.notes.push_back(fmt::format(
                "{} is no input that a calibration can carry: the table leaves it out", p.label()));
            continue;
        }
        const std::string own = p.unknown.name.substr(0, p.unknown.name.size() - key->size());
        if (columns.empty()) head = own;
        if (own == head)
            columns.push_back(i);
        else
            calibration.notes.push_back(
                fmt::format("{} is of another parachute: a table is of one", p.label()));
    }
    return columns;
}

}  // namespace

bool is_of_records(const std::vector<DropTest>& tests) {
    return std::ranges::all_of(tests, &DropTest::is_record);
}

std::string calibration_table(Calibration& calibration, const SceneWith& scene_with,
                              const std::vector<DropTest>& tests) {
    const Scene scene = scene_with({});
    const std::vector<std::size_t> columns = columns_of(calibration, scene);
    std::string names = "run", units = "1", rows;
    for (const ConditionRow& row : condition_rows()) {
        names += fmt::format(",{}", row.column);
        units += fmt::format(",{}", row.unit);
    }
    for (const std::size_t i : columns) {
        names += fmt::format(",{}", *carried(scene, calibration.parameters[i].unknown.name));
        units += ",1";
    }
    int run = 0;
    for (std::size_t t = 0; t < tests.size(); ++t) {
        const auto& alone = calibration.alone[t];
        if (std::ranges::any_of(columns, [&](std::size_t i) { return !alone[i]; })) {
            calibration.notes.push_back(
                fmt::format("{} by itself does not see all inputs: the table leaves it out", tests[t].name));
            continue;
        }
        std::vector<std::string> conditions;
        for (const std::string& condition : tests[t].conditions)
            conditions.push_back("--to " + condition);
        const DropConditions at = drop_conditions(scene_with(conditions));
        rows += fmt::format("{},{},{},{}", ++run, at.payload_mass, at.airspeed, at.density);
        for (const std::size_t i : columns)
            rows += fmt::format(",{}", *alone[i] / calibration.parameters[i].start);
        rows += "\n";
    }
    if (columns.empty() || run == 0)
        throw UsageError(fmt::format(
            "{}: the records calibrate nothing that a table can carry ({}), vary {}", scene.file.string(),
            columns.empty() ? "none of the inputs" : "no run by itself sees them all",
            fmt::join(calibrated_keys(), ", ")));
    return names + "\n" + units + "\n" + rows;
}

}  // namespace twinchute::study
