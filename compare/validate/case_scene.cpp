#include "compare/validate/case_scene.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "lib/scene/data_files.hpp"
#include "lib/scene/nearest.hpp"
#include "lib/scene/read_scene.hpp"

namespace twinchute::compare {
namespace {

constexpr const char* types_file = "reference/parachute_types.csv";

/// Text of an error after its place.
std::string complaint(const SceneError& error) {
    const SourcePlace& at = error.place();
    const std::string text = error.what();
    std::string place = at.file;
    if (at.line > 0) place += fmt::format(":{}:{}", at.line, at.column);
    place += ": ";
    return text.starts_with(place) ? text.substr(place.size()) : text;
}

}  // namespace

CaseScene::CaseScene(const ValidationSuite& suite, const ValidationCase& one) : suite_(suite), case_(one) {
    if (!case_.canopy_type.empty()) {
        const auto types = file(types_file, "case.canopy_type");
        type_ =
            canopy_type_keys(read_reference_table(read_text_file(types), types.string()), case_.canopy_type);
    }
    lines_ = {std::nullopt};
    if (!case_.missing.empty() || !case_.shown_by.empty()) return;
    if (!case_.table.empty()) {
        const auto path = file(case_.table, "case.table");
        table_ = read_reference_table(read_text_file(path), path.string());
        const std::size_t equals = std::min(case_.only.find('='), case_.only.size());
        const std::string name = case_.only.substr(0, equals);
        double wanted = 0.0;
        if (!case_.only.empty()) {
            const std::string value = case_.only.substr(std::min(equals + 1, case_.only.size()));
            const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), wanted);
            if (error != std::errc{} || end != value.data() + value.size())
                throw SceneError(case_.place, "case.only", fmt::format("'{}' is not name=number", case_.only),
                                 "", "write e.g. only = \"eta=0.2\"");
            column(name, "case.only");
        }
        lines_.clear();
        for (std::size_t i = 0; i < table_.lines.size(); ++i)
            if (case_.only.empty() || table_.number(i, column(name, "case.only")) == wanted)
                lines_.emplace_back(i);
        if (lines_.empty())
            throw SceneError(case_.place, "case.only", fmt::format("no line has {}", case_.only), table_.file,
                             "correct the number");
    }
    if (!case_.recording.empty() && missing().empty()) {
        const auto path = file(case_.recording, "case.recording");
        recording_ = read_recording(read_text_file(path), path.string(), scene(lines_.front()));
    }
}

std::string CaseScene::missing() const {
    if (!case_.missing.empty()) return fmt::format("{}", fmt::join(case_.missing, ", "));
    if (!case_.canopy_type.empty() && !type_)
        return fmt::format("fill constant and C_D0 of '{}' are not in data/{}", case_.canopy_type,
                           types_file);
    return {};
}

int CaseScene::line_number(std::optional<std::size_t> line) const {
    return line ? table_.numbers[*line] : 0;
}

Scene CaseScene::scene(std::optional<std::size_t> line, const std::vector<std::string>& more) const {
    std::vector<std::string> overrides;
    if (type_) overrides = *type_;
    overrides.insert(overrides.end(), case_.set.begin(), case_.set.end());
    for (const GivenColumn& given : case_.given) {
        const auto value = line ? table_.number(*line, column(given.column, "case.given")) : std::nullopt;
        if (!value)
            throw SceneError(line ? SourcePlace{table_.file, line_number(line), 1} : case_.place,
                             given.column, "is no number", "", "the case takes it from a line of its table");
        overrides.push_back(fmt::format("{}={}", given.key, given.factor * std::pow(*value, given.power)));
    }
    overrides.insert(overrides.end(), more.begin(), more.end());
    try {
        Scene found =
            read_scene_text(case_.scene, suite_.file.string(), suite_.file.parent_path(), overrides);
        found.name = case_.name;
        return found;
    } catch (const SceneError& error) {
        refuse(error);
    }
}

Scene CaseScene::before_set(const std::vector<std::string>& more) const {
    std::vector<std::string> overrides;
    if (type_) overrides = *type_;
    overrides.insert(overrides.end(), more.begin(), more.end());
    try {
        return read_scene_text(case_.scene, suite_.file.string(), suite_.file.parent_path(), overrides);
    } catch (const SceneError& error) {
        refuse(error);
    }
}

std::vector<Scene> CaseScene::series(const std::vector<std::string>& more) const {
    std::vector<std::string> overrides = case_.set;
    overrides.insert(overrides.end(), more.begin(), more.end());
    try {
        return read_scenes_text(case_.scene, suite_.file.string(), suite_.file.parent_path(), overrides);
    } catch (const SceneError& error) {
        refuse(error);
    }
}

void CaseScene::refuse(const SceneError& error) const {
    const std::string& file = error.place().file;
    if (file != suite_.file.string() && file != "--set") throw error.within("case '" + case_.name + "'");
    // It stands in the text that the case was turned into; the reader knows the case.
    throw SceneError(case_.place, fmt::format("case '{}'", case_.name), complaint(error), "",
                     "correct its base, scene or set");
}

std::filesystem::path CaseScene::file(const std::string& name, const char* key) const {
    if (const auto found = find_table_file(name, suite_.file.parent_path())) return *found;
    throw SceneError(case_.place, key, fmt::format("there is no file '{}'", name),
                     "looked beside the suite and in the data", "check the path");
}

std::size_t CaseScene::column(const std::string& name, const char* key) const {
    if (const auto found = table_.column(name)) return *found;
    throw SceneError(case_.place, key, fmt::format("{} has no column '{}'", table_.file, name), "",
                     suggest(name, {table_.names.begin(), table_.names.end()}));
}

std::optional<double> CaseScene::expected(const ExpectedRow& row, std::optional<std::size_t> line) const {
    if (row.expected) return row.expected;
    if (!row.column.empty()) {
        const auto value = table_.number(*line, column(row.column, "case.row.column"));
        if (!value) return {};
        return row.factor * *value;
    }
    return quantity_value(row.quantity, recording_, scene(line), row.arguments);
}

}  // namespace twinchute::compare
