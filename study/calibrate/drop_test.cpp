#include "study/calibrate/drop_test.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <map>
#include <set>
#include <system_error>

#include "compare/histories.hpp"
#include "compare/validate/suite_table.hpp"
#include "lib/cli/command.hpp"
#include "lib/math/sha256.hpp"
#include "lib/record/read_record.hpp"
#include "lib/scene/data_files.hpp"
#include "lib/scene/keys.hpp"
#include "lib/scene/logged_table.hpp"
#include "lib/scene/nearest.hpp"
#include "lib/scene/scene_error.hpp"
#include "lib/scene/units.hpp"

namespace twinchute::study {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t largest_test_file = 64u << 20;  // [bytes]

constexpr std::array<HistoryKind, 8> kinds{{
    {"force", "force", "N", "Opening force", true},
    {"specific_force", "specific_force", "m/s^2", "Specific force, as an accelerometer reads it", true},
    {"acceleration", "acceleration", "m/s^2", "Acceleration over ground, by size", true},
    {"speed", "speed", "m/s", "Speed over ground", false},
    {"altitude", "altitude", "m", "Altitude above sea level", false},
    {"height", "altitude", "m", "Height above the ground of the scene", false},
    {"drag_area", "drag_area", "m^2", "Drag area", false},
    {"projected_area", "projected_area", "m^2", "Projected area", false},
}};

std::string known_columns() {
    std::string text;
    for (const HistoryKind& kind : kinds)
        text += (text.empty() ? "" : ", ") + std::string(kind.name);
    return text;
}

/// Histories in a CSV file; columns that are none are noted.
void read_histories(DropTest& test, std::string_view text, const std::string& file) {
    const LoggedTable table = read_logged_table(text, file);
    const std::vector<double> times = logged_times(table);
    for (const LoggedColumn& column : table.columns) {
        if (column.name == "time" || column.name == "t") continue;
        const HistoryKind* kind = find_history_kind(column.name);
        if (!kind) {
            test.notes.push_back(
                fmt::format("column '{}' of {} is left aside: no history of that name", column.name, file));
            continue;
        }
        const auto [time, value] = logged_history(table, times, column, kind->unit);
        MeasuredHistory history{kind, time, value, {}, {}};
        if (history.time.empty()) {
            test.notes.push_back(
                fmt::format("column '{}' of {} is left aside: it holds no number", column.name, file));
            continue;
        }
        test.histories.push_back(std::move(history));
    }
    if (test.histories.empty())
        throw SceneError({file, table.head_line, 1}, "", "there is no history beside the time",
                         "inputs are fitted to what was measured",
                         "the columns are time and any of " + known_columns());
    if (!(times.back() > 0.0))
        throw SceneError({file, table.lines.back(), 1}, "", "the history lies wholly before the release",
                         fmt::format("its last line is at {:g} s, time counts from release", times.back()),
                         "shift its clock");
}

/// Takes `sigma` and `bandwidth` of a history from its table.
void read_instrument(compare::SuiteTable& from, MeasuredHistory& history) {
    const auto sigma = from.tolerance("sigma", history.kind->unit);
    if (sigma && !(sigma->value > 0.0))
        from.refuse("sigma", "is not positive", "", "leave it out where it is unknown");
    if (sigma) history.sigma = sigma->relative ? sigma->value * history.largest() : sigma->value;
    history.bandwidth = from.amount("bandwidth", "Hz");
    if (history.bandwidth && !(*history.bandwidth > 0.0))
        from.refuse("bandwidth", "is not positive", "", "leave it out where nothing filters");
    from.end();
}

void read_scalar(compare::SuiteTable& from, DropTest& test, const MetricRow& row) {
    const std::string_view unit = row.tolerance_unit();
    from.need("value", "it is what was measured");
    from.need("sigma", "a single number says nothing of its noise");
    const double value = *from.amount("value", unit);
    const Tolerance sigma = *from.tolerance("sigma", unit);
    from.end();
    const double size = sigma.relative ? sigma.value * std::abs(value) : sigma.value;
    if (!(size > 0.0)) from.refuse("sigma", "is not positive", "", "give one standard uncertainty");
    test.scalars.push_back({&row, value, size});
}

/// A key of a test's own scene: "key=value", as --set takes it.
std::string condition_of(const compare::SuiteTable& from, const toml::key& key, const toml::node& node) {
    const std::string name(key.str());
    if (const auto text = node.value_exact<std::string>()) return fmt::format("{}='{}'", name, *text);
    if (const auto number = node.value<double>(); number && !node.is_boolean())
        return fmt::format("{}={}", name, *number);
    from.refuse(name, "a number or text belongs here", "", "write it as in a scene");
}

void read_priors(DropTest& test, const std::vector<compare::SuiteTable>& tables) {
    for (compare::SuiteTable one : tables) {
        Prior prior;
        prior.key = one.needed_text("key", "a prior is of an input");
        const Key* row = find_key(scene_keys(), prior.key);
        const std::string_view unit = row && !row->unit.empty() ? row->unit : "1";
        one.need("mean", "a prior is normal");
        one.need("sigma", "a prior is normal");
        prior.mean = *one.amount("mean", unit);
        const Tolerance sigma = *one.tolerance("sigma", unit);
        prior.sigma = sigma.relative ? sigma.value * std::abs(prior.mean) : sigma.value;
        if (!(prior.sigma > 0.0)) one.refuse("sigma", "is not positive", "", "leave the prior out");
        one.end();
        test.priors.push_back(std::move(prior));
    }
}

bool is_of_any(std::string_view key, std::initializer_list<std::string_view> tables) {
    return std::ranges::any_of(tables, [&](std::string_view table) { return key.starts_with(table); });
}

/// Inputs of a record that say how it was dropped, its defaults among them: the calibrated scene takes them
/// over. Throws UsageError where the scene has a wind or something of the payload that the drop had not.
std::vector<std::string> conditions_of(const RunRecord& record, const Scene& scene) {
    for (const Input& input : scene.inputs)
        if (input.origin == InputOrigin::given && is_of_any(input.key, {"payload.", "environment.wind."}) &&
            !record.find_input(input.key))
            throw UsageError(fmt::format(
                "the scene gives {}, which the record of '{}' has not (its drop was another one), "
                "calibrate a scene without it",
                input.key, record.scene.name));
    std::vector<std::string> conditions;
    for (const Input& input : record.inputs) {
        const bool drop = input.origin == InputOrigin::given
                              ? is_of_any(input.key, {"payload.", "release.", "environment."})
                              : is_of_any(input.key, {"payload.", "environment."});
        if (!drop) continue;
        const auto own = std::ranges::find(scene.inputs, input.key, &Input::key);
        if (own != scene.inputs.end() && own->value == input.value) continue;
        if (const auto* number = std::get_if<double>(&input.value))
            conditions.push_back(fmt::format("{}={}", input.key, *number));
        else
            conditions.push_back(fmt::format("{}='{}'", input.key, std::get<std::string>(input.value)));
    }
    return conditions;
}

constexpr int record_readings = 40;  // of each history

DropTest read_record_as_test(const fs::path& directory, const Scene& scene) {
    fs::path place = directory;
    std::error_code ignored;
    // A directory of `compare` holds both; the full model is what the other one is calibrated to.
    if (!fs::exists(place / "summary.json", ignored) && fs::exists(place / "full" / "summary.json", ignored))
        place /= "full";
    const RunRecord record = read_record(place);
    DropTest test;
    test.name = directory.string();
    test.is_record = true;
    test.clock_known = record.find_event("snatch") == nullptr;
    test.conditions = conditions_of(record, scene);
    test.sha256 = sha256_hex(read_text_file(place / "summary.json"));
    // What the table of the gap is judged by weighs as much as it does there: a tenth of its tolerance.
    for (const MetricRow& row : metric_rows()) {
        const auto value = record.metric(row.key);
        const bool is_answer =
            row.name == "peak_force" || row.name == "time_to_peak_force" || row.name == "descent_rate";
        if (is_answer && value && *value > 0.0) test.scalars.push_back({&row, *value, 2e-3 * *value});
    }
    const double from = compare::snatch_of(record);
    // The force knows when and how the canopy fills, the speed what it comes to.
    for (const char* name : {"force", "speed"}) {
        const HistoryKind* kind = find_history_kind(name);
        const auto curve = compare::curve_of(record, kind->channel);
        if (!curve)
            throw UsageError(
                fmt::format("'{}' has no history of the {} (inputs are fitted to it), run it again",
                            directory.string(), name));
        MeasuredHistory history{kind, {}, {}, {}, {}};
        // What is left over of a record is the models' gap, the same from reading to reading: many more would
        // only outvote the answers above.
        const double step = (curve->time.back() - from) / record_readings;
        for (std::size_t i = 0; i < curve->time.size(); ++i) {
            const bool is_next = history.time.empty() || curve->time[i] >= history.time.back() + step;
            if (curve->time[i] < from || !is_next) continue;
            history.time.push_back(curve->time[i]);
            history.value.push_back(curve->value[i]);
        }
        test.histories.push_back(std::move(history));
    }
    return test;
}

}  // namespace

const HistoryKind* find_history_kind(std::string_view name) {
    const auto found = std::ranges::find(kinds, name, &HistoryKind::name);
    return found == kinds.end() ? nullptr : &*found;
}

double MeasuredHistory::largest() const {
    double size = 0.0;
    for (const double v : value)
        size = std::max(size, std::abs(v));
    return size;
}

DropTest read_drop_test_csv(std::string_view text, const std::string& file) {
    DropTest test;
    test.name = file;
    test.sha256 = sha256_hex(text);
    read_histories(test, text, file);
    return test;
}

std::string text_of_test_file(const fs::path& file) {
    return read_text_file(file, largest_test_file);
}

DropTest read_drop_test_toml(std::string_view text, const std::string& file, const fs::path& directory,
                             const TextOfFile& text_of) {
    toml::table document;
    try {
        document = toml::parse(text, file);
    } catch (const toml::parse_error& error) {
        const auto& at = error.source().begin;
        throw SceneError({file, static_cast<int>(at.line), static_cast<int>(at.column)}, "", "is not TOML",
                         std::string(error.description()), "correct it");
    }
    compare::SuiteTable top(document, file, "");
    top.count("schema", 1, 1);
    DropTest test;
    test.name = file;
    test.sha256 = sha256_hex(text);
    if (const std::string name = top.text("file"); !name.empty()) {
        const fs::path path = directory / name;
        read_histories(test, text_of(path), path.string());
    }
    if (const std::string clock = top.text("clock"); !clock.empty()) {
        if (clock != "known" && clock != "fitted")
            top.refuse("clock", fmt::format("unknown word '{}'", clock), "",
                       suggest(clock, {"known", "fitted"}));
        test.clock_known = clock == "known";
    }
    if (const toml::table* set = top.table("set"))
        for (const auto& [key, node] : *set)
            test.conditions.push_back(condition_of(top, key, node));
    read_priors(test, top.find("prior") ? top.list("prior") : std::vector<compare::SuiteTable>{});
    for (MeasuredHistory& history : test.histories)
        if (const toml::table* table = top.table(history.kind->name)) {
            compare::SuiteTable one(*table, file, std::string(history.kind->name));
            read_instrument(one, history);
        }
    for (const MetricRow& row : metric_rows())
        if (const toml::table* table = top.table(row.name)) {
            compare::SuiteTable one(*table, file, std::string(row.name));
            read_scalar(one, test, row);
        }
    top.end();
    if (test.histories.empty() && test.scalars.empty())
        throw SceneError(
            {file, 1, 1}, "", "nothing was measured", "a test has a file with histories, or scalars",
            "add e.g. file = \"drop.csv\" or peak_force = { value = \"5 kN\", sigma = \"3 %\" }");
    return test;
}

std::vector<DropTest> read_drop_tests(const std::vector<TextFile>& files) {
    const auto is_toml = [](const TextFile& file) { return fs::path(file.name).extension() == ".toml"; };
    std::set<std::string> named;
    std::map<std::string, DropTest> tests;
    for (const TextFile& file : files) {
        if (std::ranges::count(files, file.name, &TextFile::name) > 1)
            throw SceneError({file.name, 1, 1}, "", "is there twice", "files are told apart by their names",
                             "rename one of them");
        if (!is_toml(file)) continue;
        const TextOfFile among = [&](const fs::path& path) {
            const auto found = std::ranges::find(files, path.string(), &TextFile::name);
            if (found == files.end())
                throw SceneError({file.name, 1, 1}, "file",
                                 fmt::format("'{}' is not among the files", path.string()),
                                 "nothing is looked for on disk", "give both files together");
            named.insert(found->name);
            return found->text;
        };
        tests.emplace(file.name, read_drop_test_toml(file.text, file.name, "", among));
    }
    std::vector<DropTest> all;
    for (const TextFile& file : files) {
        if (is_toml(file))
            all.push_back(tests.at(file.name));
        else if (!named.contains(file.name))
            all.push_back(read_drop_test_csv(file.text, file.name));
    }
    return all;
}

DropTest read_drop_test(const std::string& name, const Scene& scene) {
    std::error_code ignored;
    const fs::path path = name;
    if (fs::is_directory(path, ignored)) return read_record_as_test(path, scene);
    const std::string text = text_of_test_file(path);
    if (path.extension() == ".toml") return read_drop_test_toml(text, name, path.parent_path());
    return read_drop_test_csv(text, name);
}

}  // namespace twinchute::study
