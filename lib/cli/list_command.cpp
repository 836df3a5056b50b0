#include "lib/cli/list_command.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "lib/cli/scene_command.hpp"
#include "lib/cli/text.hpp"
#include "lib/math/vec.hpp"
#include "lib/models/added_mass.hpp"
#include "lib/models/atmosphere.hpp"
#include "lib/models/drag_area.hpp"
#include "lib/models/fill_time.hpp"
#include "lib/models/filling.hpp"
#include "lib/record/metrics.hpp"
#include "lib/record/record_json.hpp"
#include "lib/scene/canopy_types.hpp"
#include "lib/scene/data_files.hpp"
#include "lib/scene/keys.hpp"
#include "lib/scene/nearest.hpp"

namespace twinchute {
namespace {

Table keys_at(std::string_view path) {
    Table table;
    table.header = {"key",     "unit",       "default",   "range", "used by",
                    "meaning", "instead of", "only with", "source"};
    for (const Key* key : keys_below(path)) {
        table.rows.push_back({std::string(key->path), std::string(key->unit), default_text(*key),
                              range_text(*key), std::string(user_name(key->user)), std::string(key->meaning),
                              std::string(key->instead_of), std::string(key->only_with),
                              std::string(key->source)});
    }
    return table;
}

/// [columns] of the terminal that is written to, or what COLUMNS says of it; 0 where lines are not for
/// reading: a pipe or a file, in which one looks for a word and wants its whole line.
std::size_t columns_of_output() {
    if (const char* text = std::getenv("COLUMNS")) {
        std::size_t columns = 0;
        const std::string_view digits(text);
        std::from_chars(digits.data(), digits.data() + digits.size(), columns);
        if (columns >= 20) return columns;
    }
    winsize size{};
    if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0) return 0;
    return size.ws_col >= 20 ? size.ws_col : 80;  // a terminal that does not know its own
}

/// All keys, those of a table of the scene, or one key in full.
std::string keys_text(std::string_view path) {
    const std::vector<const Key*> keys = keys_below(path);
    const std::size_t columns = columns_of_output();
    if (keys.size() == 1 && keys.front()->path == path) return key_page(*keys.front(), columns);
    return columns > 0 ? keys_wrapped(keys, columns) : keys_table(keys);
}

/// The row that a path of a scene leads to: without numbers of list members. Throws UsageError.
std::string key_path(const std::string& given) {
    std::string path = row_path(scene_keys(), given);
    if (!keys_below(path).empty()) return path;
    if (const Key* successor = find_successor(scene_keys(), given)) return std::string(successor->path);
    std::vector<std::string_view> known;
    for (const Key* key : keys_below(""))
        known.push_back(key->path);
    throw UsageError(fmt::format("there is no key '{}', {}", given, suggest_key(given, known)));
}

template <typename Rows>
void add_laws(Table& table, std::string_view key, const Rows& rows) {
    for (const auto& row : rows) {
        table.rows.push_back({std::string(key), std::string(row.name), std::string(row.source)});
    }
}

Table laws() {
    Table table;
    table.header = {"key", "law", "source"};
    add_laws(table, "parachute.drag_area_law", drag_area_laws());
    add_laws(table, "parachute.fill_time.model", fill_time_models());
    add_laws(table, "parachute.filling.model", filling_models());
    add_laws(table, "aerodynamics.added_mass.model", added_mass_models());
    add_laws(table, "aerodynamics.line_ratio.model", line_ratio_models());
    add_laws(table, "aerodynamics.forebody_wake.model", forebody_wake_models());
    add_laws(table, "environment.atmosphere", atmosphere_models());
    return table;
}

/// A range for reading, "0.75-0.8 (A)".
std::string range_cell(const std::optional<TypeRange>& range, double unit = 1.0) {
    if (!range) return "-";
    const std::string high = range->low < range->high ? fmt::format("-{:g}", range->high / unit) : "";
    return fmt::format("{:g}{} ({})", range->low / unit, high, range->grade);
}

Table types() {
    Table table;
    table.header = {"type", "canopy", "C_D0", "C_x", "D_p/D0", "n", "j", "oscillation [deg]"};
    for (const std::string& name : canopy_type_names()) {
        const CanopyType type = read_canopy_type(name, "type", {}, {});
        table.rows.push_back({name, type.title, range_cell(type.drag_coefficient),
                              range_cell(type.opening_force_coefficient),
                              range_cell(type.projected_diameter_ratio), range_cell(type.fill_constant),
                              range_cell(type.growth_exponent), range_cell(type.oscillation, pi / 180.0)});
    }
    return table;
}

std::string types_text() {
    return aligned(types(), output_style()) +
           "\nIn brackets how far to rely on a value: A transcriptions of Knacke's tables agree, B one "
           "transcription, R a "
           "recollection,\nwhich is never a default. parachute.type takes the middle of a range; the files "
           "of "
           "parachutes/types/ name the sources.\n";
}

Table files_in(const char* folder) {
    Table table;
    table.header = {"name", "file"};
    for (const std::string& name : data_names(folder)) {
        const auto file = find_data_file(folder, name, {});
        table.rows.push_back({name, file ? file->string() : std::string{}});
    }
    return table;
}

/// An object a row, with the table's header as keys.
std::string table_json(const Table& table) {
    nlohmann::ordered_json json = nlohmann::ordered_json::array();
    for (const auto& row : table.rows) {
        nlohmann::ordered_json object;
        for (std::size_t i = 0; i < row.size(); ++i)
            object[table.header[i]] = row[i];
        json.push_back(std::move(object));
    }
    return json_text(json);
}

Table metrics() {
    Table table;
    table.header = {"metric", "unit", "record key", "default tolerance", "meaning"};
    for (const MetricRow& row : metric_rows())
        table.rows.push_back(
            {std::string(row.name), row.unit.empty() ? "1" : std::string(row.unit), std::string(row.key),
             row.tolerance ? tolerance_text(*row.tolerance, row.unit) : "-", std::string(row.title)});
    for (const MetricRow& row : history_rows())
        table.rows.push_back({std::string(row.name), "1", "-", "-",
                              std::string(row.title) + " over time: relative L2 norm of the difference"});
    return table;
}

struct Topic {
    std::string_view name;     ///< e.g. "laws"
    std::string_view summary;  ///< one line
    Table (*table)();
    std::string (*text)() = nullptr;  ///< for reading; null: the table, aligned
};

constexpr Topic topics[] = {
    {"keys", "what a scene or a material file may say", [] { return keys_at(""); },
     [] { return keys_text(""); }},
    {"laws", "rows of the model tables and the keys that choose them", laws},
    {"materials", "fabrics and cords by name", [] { return files_in("materials"); }},
    {"parachutes", "designs by name", [] { return files_in("parachutes"); }},
    {"types", "types of canopy and what handbooks say of them", types, types_text},
    {"scenes", "scenes to start from", [] { return files_in("scenes"); }},
    {"metrics", "what two fidelities are compared in, and the tolerances", metrics},
};

ExitCode run_list(const Arguments& arguments) {
    const bool as_json = arguments.has("json");
    const std::vector<std::string>& words = arguments.operands;
    const bool of_keys = !words.empty() && words[0] == "keys";
    if (words.size() > (of_keys ? 2 : 1))
        throw UsageError(
            fmt::format("'{}' is one argument too many (only `list keys` takes one more: a key or a "
                        "table of keys), e.g. twinchute list keys parachute",
                        words[of_keys ? 2 : 1]));
    Table table;
    if (words.size() == 2) {
        const std::string path = key_path(words[1]);
        print(as_json ? table_json(keys_at(path)) : keys_text(path));
        return ExitCode::done;
    }
    if (arguments.operand.empty()) {
        table.header = {"topic", "what it lists"};
        for (const Topic& topic : topics)
            table.rows.push_back({std::string(topic.name), std::string(topic.summary)});
    } else {
        const auto topic = std::ranges::find(topics, arguments.operand, &Topic::name);
        if (topic == std::end(topics)) {
            std::vector<std::string_view> known;
            for (const Topic& row : topics)
                known.push_back(row.name);
            throw UsageError(fmt::format("there is no list of '{}', {}", arguments.operand,
                                         suggest(arguments.operand, known)));
        }
        if (topic->text && !as_json) {
            print(topic->text());
            return ExitCode::done;
        }
        table = topic->table();
    }
    print(as_json ? table_json(table) : aligned(table, output_style()));
    return ExitCode::done;
}

}  // namespace

std::string keys_json() {
    return table_json(keys_at(""));
}

Command list_command() {
    Command command;
    command.name = "list";
    command.summary = "what there is: keys, laws, types, materials, scenes, metrics";
    command.operand = "[TOPIC [KEY]...]";
    command.example = "twinchute list keys parachute.deploy";
    command.options = {{"json", "", "print the table as JSON"}};
    for (const Topic& topic : topics)
        command.operand_words.emplace_back(topic.name);
    command.run = run_list;
    return command;
}

}  // namespace twinchute
