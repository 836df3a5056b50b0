// From a suite's TOML to a ValidationSuite. Every key is known or refused, every number has the unit of what
// it belongs to.
#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <type_traits>

#include "compare/validate/suite.hpp"
#include "compare/validate/suite_table.hpp"
#include "lib/record/metrics.hpp"
#include "lib/scene/data_files.hpp"
#include "lib/scene/keys.hpp"
#include "lib/scene/nearest.hpp"

namespace twinchute::compare {
namespace {

namespace fs = std::filesystem;

constexpr std::array evidences{Evidence::exact, Evidence::printed, Evidence::measured, Evidence::synthetic};

std::string toml_text(const toml::node& node) {
    std::ostringstream text;
    node.visit([&](const auto& value) {
        using Value = std::remove_cvref_t<decltype(value)>;
        if constexpr (std::is_same_v<Value, toml::table> || std::is_same_v<Value, toml::array>) {
            text << toml::toml_formatter(value);
        } else {
            text << toml::toml_formatter(toml::table{{"v", value}});
        }
    });
    std::string found = text.str();
    if (!node.is_table() && !node.is_array()) found.erase(0, found.find('=') + 2);
    return found;
}

/// Source of the scene: its own text, or the file it starts from.
std::string scene_text(SuiteTable& reader) {
    const std::string base = reader.text("base");
    const toml::table* inlined = reader.table("scene");
    if (inlined && !base.empty())
        reader.refuse("scene", "stands beside base", "one of them says which scene it is", "keep one");
    if (inlined) return toml_text(*inlined) + "\n";
    return base.empty() ? "" : "base = " + toml_text(toml::value<std::string>(base)) + "\n";
}

std::vector<std::string> overrides(SuiteTable& reader) {
    std::vector<std::string> found;
    const toml::table* set = reader.table("set");
    if (!set) return found;
    for (const auto& [key, node] : *set) {
        if (node.is_table() || node.is_array())
            reader.refuse("set", fmt::format("'{}' is not a plain value", std::string(key.str())), "",
                          "write \"payload.mass\" = \"80 kg\", one key after the other");
        found.push_back(fmt::format("{}={}", std::string(key.str()), toml_text(node)));
    }
    return found;
}

const Key& number_key(const SuiteTable& reader, std::string_view owner, std::string_view path) {
    const Key* key = find_key(scene_keys(), path);
    if (!key) key = find_successor(scene_keys(), path);
    if (!key || (key->kind != KeyKind::quantity && key->kind != KeyKind::quantity_or_word &&
                 key->kind != KeyKind::integer))
        reader.refuse(owner, fmt::format("'{}' is no number of a scene", path), "",
                      "`twinchute list keys` shows them");
    return *key;
}

const MetricRow& metric_named(const SuiteTable& reader, std::string_view key, const std::string& name) {
    if (const MetricRow* row = find_metric_row(name)) return *row;
    std::vector<std::string_view> names;
    for (const MetricRow& known : metric_rows())
        names.push_back(known.name);
    reader.refuse(key, fmt::format("'{}' is no metric", name), "", suggest(name, names));
}

TrendAsked read_trend(SuiteTable& reader) {
    using enum TrendAsked::Kind;
    constexpr std::array kinds{rises, falls, exponent, spread};
    TrendAsked asked;
    const std::string kind = reader.needed_text("trend", "how it goes over the cases");
    const auto known = std::ranges::find(kinds, kind, trend_name);
    if (known == kinds.end())
        reader.refuse("trend", fmt::format("'{}' is unknown", kind), "",
                      "write rises, falls, exponent or spread");
    asked.kind = *known;
    asked.y = reader.needed_text("y", "which metric");
    metric_named(reader, "y", asked.y);
    if (asked.kind != TrendAsked::Kind::spread) {
        asked.x = reader.needed_text("x", "with which metric");
        metric_named(reader, "x", asked.x);
    }
    asked.within = reader.text("within");
    if (!asked.within.empty() && asked.within != "group") metric_named(reader, "within", asked.within);
    asked.cases = reader.texts("cases");
    return asked;
}

/// Reads what a row compares: a quantity of one run, or a trend of a series. Returns its unit.
std::string_view read_quantity(SuiteTable& reader, ExpectedRow& row) {
    row.quantity = reader.needed_text("quantity", "what is compared");
    const std::string_view unit = quantity_unit(row.quantity);
    if (unit.empty()) {
        std::vector<std::string_view> names;
        for (const Quantity& known : quantities())
            names.push_back(known.name);
        for (const MetricRow& known : metric_rows())
            names.push_back(known.name);
        reader.refuse("quantity", fmt::format("'{}' is unknown", row.quantity), "",
                      suggest(row.quantity, names));
    }
    const Quantity* quantity = find_quantity(row.quantity);
    const auto argument = [&](const char* key, double& value, const char* of) {
        const auto given = reader.amount(key, of);
        const bool taken = quantity && std::ranges::count(words_of(quantity->takes), key) > 0;
        if (given && !taken)
            reader.refuse(key, fmt::format("'{}' does not depend on it", row.quantity), "", "leave it out");
        if (given) value = *given;
        if (!given && taken && std::string_view(key) != "window")
            reader.refuse(key, "is missing", fmt::format("'{}' depends on it", row.quantity), "add it");
    };
    argument("window", row.arguments.window, "s");
    argument("height", row.arguments.height, "m");
    argument("from", row.arguments.from, "m");
    argument("to", row.arguments.to, "m");
    if (!(row.arguments.window > 0.0)) reader.refuse("window", "is not positive", "", "give e.g. \"100 ms\"");

    return unit;
}

ExpectedRow read_row(SuiteTable& reader, const ValidationCase& owner) {
    ExpectedRow row;
    row.place = reader.place();
    if (owner.is_series) row.trend = read_trend(reader);
    const std::string_view unit = owner.is_series ? "1" : read_quantity(reader, row);
    row.fidelities = reader.texts("fidelities");
    for (const std::string& name : row.fidelities)
        if (std::ranges::find(owner.fidelities, name) == owner.fidelities.end())
            reader.refuse("fidelities", fmt::format("'{}' is none of the case's", name), "",
                          suggest(name, {owner.fidelities.begin(), owner.fidelities.end()}));
    row.expected = reader.amount("expected", unit);
    row.column = reader.text("column");
    if (const auto factor = reader.amount("factor", "1")) {
        if (row.column.empty())
            reader.refuse("factor", "is not used", "it is of the numbers of a column", "leave it out");
        row.factor = *factor;
    }
    row.tolerance = reader.tolerance("tolerance", unit);
    row.sigma = reader.tolerance("sigma", unit);
    row.judged = reader.flag("judged", true);
    row.group = reader.text("group");
    row.source = reader.text("source");
    row.grade = reader.text("grade");
    row.where = reader.text("where");
    row.note = reader.text("note");
    reader.end();

    const int ways = (row.expected ? 1 : 0) + (row.column.empty() ? 0 : 1);
    if (ways > 1) reader.refuse("column", "stands beside expected", "both say what is expected", "keep one");
    if (ways == 0 && owner.recording.empty())
        reader.refuse("expected", "is missing", "nothing to compare with",
                      "add expected, or column with a table, or a recording of the case");
    if (!row.column.empty() && owner.table.empty())
        reader.refuse("column", "needs a table of the case", "", "add table = \"reference/....csv\"");
    if (row.judged && !row.tolerance && !row.sigma && !owner.bracket && !owner.fit)
        reader.refuse("tolerance", "is missing", "how far off may it be?",
                      "add tolerance, the sigma of the measurement, or judged = false");
    return row;
}

std::vector<GivenColumn> read_given(SuiteTable& reader) {
    std::vector<GivenColumn> found;
    const toml::table* given = reader.table("given");
    if (!given) return found;
    SuiteTable columns(*given, reader.file(), reader.path_of("given"));
    for (const auto& [name, node] : *given) {
        const std::string column(name.str());
        const toml::table* table = columns.table(column);
        SuiteTable one(*table, reader.file(), columns.path_of(column));
        GivenColumn entry{column, one.needed_text("key", "which key of the scene it gives")};
        number_key(one, "key", entry.key);
        if (const auto factor = one.amount("factor", "1")) entry.factor = *factor;
        if (const auto power = one.amount("power", "1")) entry.power = *power;
        one.end();
        found.push_back(std::move(entry));
    }
    return found;
}

void read_uncertainties(SuiteTable& reader, ValidationCase& found) {
    if (const toml::table* uncertain = reader.table("uncertain")) {
        SuiteTable keys(*uncertain, reader.file(), reader.path_of("uncertain"));
        for (const auto& [name, node] : *uncertain) {
            const std::string key(name.str());
            found.uncertain.emplace_back(key, *keys.tolerance(key, number_key(keys, key, key).unit));
        }
    }
    if (const toml::table* bracket = reader.table("bracket")) {
        SuiteTable keys(*bracket, reader.file(), reader.path_of("bracket"));
        if (bracket->size() != 1) reader.refuse("bracket", "one key belongs here", "", "give one");
        const std::string key(bracket->begin()->first.str());
        number_key(keys, key, key);
        const Tolerance share = *keys.tolerance(key, "1");
        if (!(share.relative && share.value > 0.0 && share.value < 1.0))
            keys.refuse(key, "is not a share", "", "write e.g. \"20 %\"");
        found.bracket.emplace(key, share.value);
    }
    if (const toml::table* fit = reader.table("fit")) {
        SuiteTable keys(*fit, reader.file(), reader.path_of("fit"));
        const std::string key = keys.needed_text("key", "what is adjusted");
        const std::string_view unit = number_key(keys, "key", key).unit;
        keys.need("low", "where to look"), keys.need("high", "where to look");
        found.fit = {key, *keys.amount("low", unit), *keys.amount("high", unit)};
        keys.end();
        if (!(found.fit->low > 0.0 && found.fit->high > found.fit->low))
            reader.refuse("fit", "low and high are no interval above zero", "", "give 0 < low < high");
    }
}

void read_calibration(SuiteTable& reader, ValidationCase& found) {
    const toml::table* table = reader.table("calibrate");
    if (table == nullptr) return;
    SuiteTable keys(*table, reader.file(), reader.path_of("calibrate"));
    keys.need("to", "the drops that inputs are calibrated to");
    found.calibration = {keys.texts("to"), keys.texts("vary")};
    keys.end();
    if (found.calibration->to.empty()) keys.refuse("to", "names no test", "", "name one or more");
    if (found.fit || !found.table.empty() || found.is_series)
        reader.refuse("calibrate", "stands beside fit, a table or a series",
                      "inputs of one canopy are calibrated, and one drop is judged", "keep one of them");
    if (found.fidelities != std::vector<std::string>{"rom"})
        reader.refuse("calibrate", "goes with the fidelity rom alone",
                      "the reduced-order model is calibrated", "take fidelities out");
}

ValidationCase read_case(SuiteTable& reader) {
    ValidationCase found;
    found.place = reader.place();
    found.name = reader.needed_text("name", "results are listed by it");
    found.what = reader.text("what");
    found.scene = scene_text(reader);
    if (const std::string series = reader.text("series"); !series.empty()) {
        if (!found.scene.empty())
            reader.refuse("series", "stands beside base or scene", "one of them says what is run",
                          "keep one");
        found.scene = "base = " + toml_text(toml::value<std::string>(series)) + "\n";
        found.is_series = true;
    }
    found.set = overrides(reader);
    found.canopy_type = reader.text("canopy_type");
    found.fidelities = reader.texts("fidelities");
    if (found.fidelities.empty()) found.fidelities = {"rom"};
    found.seeds = reader.count("seeds", 0, 1000);
    found.table = reader.text("table");
    found.only = reader.text("only");
    found.given = read_given(reader);
    found.recording = reader.text("recording");
    found.missing = reader.texts("missing");
    found.shown_by = reader.text("shown_by");
    read_uncertainties(reader, found);
    read_calibration(reader, found);
    const std::string source = reader.text("source"), grade = reader.text("grade"),
                      where = reader.text("where");
    for (SuiteTable& row : reader.list("row"))
        found.rows.push_back(read_row(row, found));
    found.offsets = reader.texts("offsets");
    for (const std::string& name : found.offsets)
        if (std::ranges::find(found.rows, name, &ExpectedRow::quantity) == found.rows.end())
            reader.refuse("offsets", fmt::format("'{}' is no quantity of the case's rows", name), "",
                          "name quantities that have an expected value here");
    reader.end();
    for (ExpectedRow& row : found.rows) {
        if (row.source.empty()) row.source = source;
        if (row.grade.empty()) row.grade = grade;
        if (row.where.empty()) row.where = where;
        if (row.source.empty())
            throw SceneError(row.place, "case.row.source", "is missing",
                             "a value without a source is worth nothing", "add it to the row or to its case");
    }
    const bool runs = found.missing.empty() && found.shown_by.empty();
    if (runs && found.scene.empty())
        reader.refuse("base", "is missing", "which scene is it?", "add base, scene, or missing = [...]");
    if (found.rows.empty() && runs)
        reader.refuse("row", "is missing", "nothing to compare with", "add [[case.row]]");
    if (found.fit && !found.table.empty())
        reader.refuse("fit", "does not go with a table", "", "give the row its expected value");
    return found;
}

}  // namespace

ValidationSuite read_suite_text(std::string_view text, const fs::path& file) {
    toml::table root;
    try {
        root = toml::parse(text, file.string());
    } catch (const toml::parse_error& error) {
        const auto& begin = error.source().begin;
        throw SceneError({file.string(), static_cast<int>(begin.line), static_cast<int>(begin.column)}, "",
                         "not valid TOML", std::string(error.description()), "mend this line");
    }
    ValidationSuite suite;
    suite.file = file;
    SuiteTable reader(root, file.string(), "");
    if (reader.count("schema", 0, 1) != 1) reader.need("schema", "version of this format");
    suite.name = reader.needed_text("name", "suites are chosen by it");
    if (file_stem_of(suite.name) != suite.name)
        reader.refuse("name", fmt::format("'{}' is not fit for the name of a file", suite.name),
                      "letters, digits, '-', '_' and '.'",
                      fmt::format("write e.g. \"{}\"", file_stem_of(suite.name)));
    suite.title = reader.needed_text("title", "heading of its table");
    suite.about = reader.text("about");
    const std::string evidence = reader.needed_text("evidence", "what its expected values are");
    const auto found = std::ranges::find(evidences, evidence, evidence_name);
    if (found == evidences.end()) {
        std::vector<std::string_view> names;
        for (const Evidence known : evidences)
            names.push_back(evidence_name(known));
        reader.refuse("evidence", fmt::format("'{}' is unknown", evidence), "", suggest(evidence, names));
    }
    suite.evidence = *found;
    reader.need("case", "a suite has cases");
    for (SuiteTable& one : reader.list("case"))
        suite.cases.push_back(read_case(one));
    reader.end();
    return suite;
}

ValidationSuite read_suite(const fs::path& file) {
    return read_suite_text(read_text_file(file), file);
}

}  // namespace twinchute::compare
